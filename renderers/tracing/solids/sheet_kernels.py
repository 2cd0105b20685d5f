# mypy: ignore-errors
"""Rays against implicit sheets: certified roots with or without a change of sign."""

import numpy as np

from renderers.tracing import layout
from renderers.tracing.scene_kernels import CROSSING
from renderers.tracing.solids.implicit_kernels import FARTHER, RETRIES, occupied
from renderers.tracing.solids.occupancy_kernels import PAD
from renderers.tracing.solids.ranges_kernels import box_part, tape_of
from renderers.tracing.solids.solids_kernels import NONE
from sceneql.compiled.kernels import kernel
from sceneql.field.roots.sheet_roots_kernels import surface_root
from sceneql.field.tape.tape_kernels import value
from sceneql.field.tape.tape_ops import HIT, MISS, UNDECIDED


@kernel(CROSSING.signature, _nrt=False, inner=True)
def crossing(scene, scratch, k, ox, oy, oz, dx, dy, dz, near, far, anywhere):
    """Crossing of the sheet of implicit object k behind ``near``: its first root inside the region that bounds it."""
    code, constants, parts = tape_of(scene, k)
    code_within, constants_within, parts_within = tape_of(scene, k, layout.WITHIN)
    b = scene.reals
    side = min(b[k + 3] - b[k], b[k + 4] - b[k + 1], b[k + 5] - b[k + 2]) / layout.CELLS
    t, stop = box_part(scene, k, ox, oy, oz, dx, dy, dz, near, far)
    past = 0.1 * PAD * side / np.sqrt(dx * dx + dy * dy + dz * dz)
    tolerance = b[layout.TOLERANCE]
    tries = 0
    while t < stop and tries < RETRIES:
        begin, end, _ = occupied(scene, scratch, k, ox, oy, oz, dx, dy, dz, t, stop)
        if not begin < stop:
            return NONE
        end = max(end, begin + past)
        status, root = surface_root(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, begin, end, tolerance)
        if status == HIT:
            x, y, z = ox + root * dx, oy + root * dy, oz + root * dz
            if value(code_within, constants_within, parts_within, scratch, x, y, z) < 0.0:
                return root
        elif status == UNDECIDED:
            scratch[scratch.shape[0] - 1, 0] += 1.0
            root += tolerance * (end - begin) * FARTHER**tries
            tries += 1
        t = end + past if status == MISS else root + past
    return NONE
