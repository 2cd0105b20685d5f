# mypy: ignore-errors
"""Ties that break."""

import math

import sceneql.system.channels as channels
from sceneql.bodies.rigid.drive_kernels import REST_AT, STIFFNESS_AT, WORK_AT, motion
from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_FORCE, AT_J, AT_PUSH, ROW
from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import AFTER_STEP

SCRATCH_AT, ROWS, HOLDS_AT, LIMIT_AT, EFFORT_AT, MOTION_AT = range(6)
"""Integers of a tie: what its rows write, their number, whether it holds, the force that breaks it; then, where it
leaves one motion, an offset that is not read here and those of drive_kernels."""

LIMIT, LAST, TRIED, NUMBERS = range(4)
"""Floats of a tie, at LIMIT_AT: the force that breaks it [N]; that at the end of the last step, -1 before the first;
how many steps in a row were too long."""
NEAR, MOST_TRIED = 1e-9, 40
"""Part of the limit by which the force may be above it as the tie goes; steps after which it goes all the same, for
forces that jump."""


@lean(AFTER_STEP, inner=True)
def part(t0, t1, y0, rate0, y1, floats, ints):
    """Lets a tie go whose force was above the limit when the rate was last evaluated; its spring's energy is lost.

    Where the step may be taken back, and the force was below the limit at its start, it is asked to end where the force
    reaches this, as a straight line between its ends tells.
    """
    if floats[ints[HOLDS_AT]] == 0.0:
        return False
    x = y = z = 0.0
    for k in range(ints[ROWS]):
        to = ints[SCRATCH_AT] + ROW * k
        force = floats[to + AT_FORCE] + floats[to + AT_PUSH]
        x += force * floats[to + AT_J]
        y += force * floats[to + AT_J + 1]
        z += force * floats[to + AT_J + 2]
    own = floats[ints[LIMIT_AT] : ints[LIMIT_AT] + NUMBERS]
    force, most = math.sqrt(x * x + y * y + z * z), own[LIMIT]
    if not force > most:
        own[LAST], own[TRIED] = force, 0.0
        return False
    if floats[channels.EARLIER] > 0.0 and force > (1.0 + NEAR) * most and own[TRIED] < MOST_TRIED:
        own[TRIED] += 1.0
        part = ((1.0 + 0.5 * NEAR) * most - own[LAST]) / (force - own[LAST]) if 0.0 <= own[LAST] < most else 0.1
        floats[channels.EARLIER] = min(floats[channels.EARLIER], max(0.1, min(part, 0.9)))
        return False
    if ints.size > MOTION_AT:
        way = ints[MOTION_AT:]
        far, _ = motion(y1, floats, way)
        y1[way[WORK_AT]] += 0.5 * floats[way[STIFFNESS_AT]] * (far - floats[way[REST_AT]]) ** 2
    floats[ints[HOLDS_AT]] = 0.0
    return True
