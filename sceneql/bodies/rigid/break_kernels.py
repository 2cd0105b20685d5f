# mypy: ignore-errors
"""Ties that break."""

import math

from sceneql.bodies.rigid.drive_kernels import REST_AT, STIFFNESS_AT, WORK_AT, motion
from sceneql.bodies.rigid.tie_rows_kernels import AT_FORCE, AT_J, AT_PUSH, ROW
from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import AFTER_STEP

SCRATCH_AT, ROWS, HOLDS_AT, LIMIT_AT, EFFORT_AT, MOTION_AT = range(6)
"""Integers of a tie: what its rows write, their number, whether it holds, the force that breaks it; then, where it
leaves one motion, an offset that is not read here and those of drive_kernels."""


@lean(AFTER_STEP, inner=True)
def part(t0, t1, y0, rate0, y1, floats, ints):
    """Lets a tie go whose force was above the limit when the rate was last evaluated; its spring's energy is lost."""
    if floats[ints[HOLDS_AT]] == 0.0:
        return False
    x = y = z = 0.0
    for k in range(ints[ROWS]):
        to = ints[SCRATCH_AT] + ROW * k
        force = floats[to + AT_FORCE] + floats[to + AT_PUSH]
        x += force * floats[to + AT_J]
        y += force * floats[to + AT_J + 1]
        z += force * floats[to + AT_J + 2]
    if not math.sqrt(x * x + y * y + z * z) > floats[ints[LIMIT_AT]]:
        return False
    if ints.size > MOTION_AT:
        own = ints[MOTION_AT:]
        far, _ = motion(y1, floats, own)
        y1[own[WORK_AT]] += 0.5 * floats[own[STIFFNESS_AT]] * (far - floats[own[REST_AT]]) ** 2
    floats[ints[HOLDS_AT]] = 0.0
    return True
