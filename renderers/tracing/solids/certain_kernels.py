# mypy: ignore-errors
"""Implicit objects by certified intervals alone, without occupancy cells or enclosures: a slow reference."""

from renderers.tracing import layout
from renderers.tracing.scene_kernels import CROSSING
from renderers.tracing.solids.ranges_kernels import box_part, is_sheet, tape_of
from renderers.tracing.solids.solids_kernels import NONE
from sceneql.compiled.kernels import kernel
from sceneql.field.roots.bracket_kernels import along
from sceneql.field.roots.certified_kernels import certify
from sceneql.field.tape.tape_ops import HIT, UNDECIDED

ROOTS = 1000
"""Roots of a sheet passed on one ray before the region that bounds the sheet."""


@kernel(CROSSING.signature, _nrt=False, inner=True)
def certain(scene, scratch, k, ox, oy, oz, dx, dy, dz, near, far, anywhere):
    """First crossing of a ray from outside with implicit object k, solid or sheet; none where undecided."""
    code, constants, parts = tape_of(scene, k)
    code_within, constants_within, parts_within = tape_of(scene, k, layout.WITHIN)
    thin = is_sheet(scene, k)
    start, stop = box_part(scene, k, ox, oy, oz, dx, dy, dz, near, far)
    finest = scene.reals[layout.TOLERANCE] * (stop - start)
    for _ in range(ROOTS):
        if not start < stop:
            return NONE
        status, t = certify(
            code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, start, stop, finest, 1.0, anywhere, thin
        )
        if status == UNDECIDED:
            scratch[scratch.shape[0] - 1, 0] += 1.0
        if status != HIT:
            return NONE
        if not thin or along(code_within, constants_within, parts_within, scratch, ox, oy, oz, dx, dy, dz, t) < 0.0:
            return t
        start = t + 4.0 * finest
    return NONE
