# mypy: ignore-errors
"""Rays against implicit objects: certified roots in the occupancy cells of the box that are not proved empty."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.scene_kernels import CROSSING, SCRATCH, part
from renderers.tracing.solids.occupancy_kernels import PAD, occupy
from renderers.tracing.solids.ranges_kernels import box_part, cells_at, plan_at, tape_of
from renderers.tracing.solids.solids_kernels import NONE, inverse
from sceneql.compiled.kernels import kernel
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.field.roots.isolation_kernels import exit_root, isolate
from sceneql.field.tape.plans import NO_FORM
from sceneql.field.tape.tape_ops import HIT, UNDECIDED

_f = types.float64
RAY_ROOT = types.Tuple((types.int64, _f))(
    types.int32[:, ::1], _f[::1], _f[:, ::1], SCRATCH, types.int32[::1], *[_f] * 9, types.boolean
)
polynomial_root = lazy("sceneql.field.roots.ray_polynomial_kernels:polynomial_root", RAY_ROOT)

RETRIES = 8
"""Undecided places passed on one ray before it counts as a miss."""
FARTHER = 10.0
"""Factor by which the step past an undecided place grows from one to the next."""


@part
def step_to(d, low, cell, side, origin, inv):
    """t at which the ray leaves a cell along one axis."""
    return (low + (cell + (1 if d >= 0.0 else 0)) * side - origin) * inv


@part
def occupied(scene, scratch, k, ox, oy, oz, dx, dy, dz, start, stop):
    """(from, to, full): the first piece of [start, stop] in cells not proved empty; from >= stop: none.

    It ends at the next empty cell, or behind a full one (``full``): there the ray is certainly inside.
    """
    b = scene.reals
    base = cells_at(scene, k)
    hx = (b[k + 3] - b[k]) / layout.CELLS
    hy = (b[k + 4] - b[k + 1]) / layout.CELLS
    hz = (b[k + 5] - b[k + 2]) / layout.CELLS
    i = int(min(max((ox + start * dx - b[k]) / hx, 0.0), layout.CELLS - 1.0))
    j = int(min(max((oy + start * dy - b[k + 1]) / hy, 0.0), layout.CELLS - 1.0))
    l = int(min(max((oz + start * dz - b[k + 2]) / hz, 0.0), layout.CELLS - 1.0))
    ix = inverse(dx)
    iy = inverse(dy)
    iz = inverse(dz)
    tx = step_to(dx, b[k], i, hx, ox, ix)
    ty = step_to(dy, b[k + 1], j, hy, oy, iy)
    tz = step_to(dz, b[k + 2], l, hz, oz, iz)
    wx = hx * abs(ix)
    wy = hy * abs(iy)
    wz = hz * abs(iz)
    begin = NONE
    t = start
    while t < stop:
        state = int(scene.ints[base + (i * layout.CELLS + j) * layout.CELLS + l])
        if state == layout.UNKNOWN:
            state = occupy(scene, scratch, k, i, j, l)
        if state == layout.EMPTY:
            if begin < NONE:
                return begin, t, False
        elif begin == NONE:
            begin = t
        leave = max(t, min(tx, min(ty, tz)))
        if state == layout.FULL:
            return begin, min(leave, stop), True
        if tx <= ty and tx <= tz:
            i += 1 if dx >= 0.0 else -1
            tx += wx
            if i < 0 or i >= layout.CELLS:
                break
        elif ty <= tz:
            j += 1 if dy >= 0.0 else -1
            ty += wy
            if j < 0 or j >= layout.CELLS:
                break
        else:
            l += 1 if dz >= 0.0 else -1
            tz += wz
            if l < 0 or l >= layout.CELLS:
                break
        t = leave
    return begin, stop, False


@kernel(CROSSING.signature, _nrt=False, inner=True)
def crossing(scene, scratch, k, ox, oy, oz, dx, dy, dz, near, far, anywhere):
    """Crossing of implicit object k behind ``near``; with ``anywhere`` of any place inside, not the first."""
    b, last_row = scene.reals, scratch.shape[0] - 1
    own_row = last_row - 1 - int(b[k + layout.OF_SHAPE])
    side = min(b[k + 3] - b[k], b[k + 4] - b[k + 1], b[k + 5] - b[k + 2]) / layout.CELLS
    enter, stop = box_part(scene, k, ox, oy, oz, dx, dy, dz, near, far)
    if not enter < stop:
        return NONE
    tolerance = b[layout.TOLERANCE]
    t = enter
    tries = 0
    past = 0.1 * PAD * side / np.sqrt(dx * dx + dy * dy + dz * dz)  # a step into the next cell, within its pad
    while t < stop and tries < RETRIES:
        begin, end, full = occupied(scene, scratch, k, ox, oy, oz, dx, dy, dz, t, stop)
        if not begin < stop:
            return NONE
        if full and anywhere:
            return begin
        code, constants, parts = tape_of(scene, k)
        end = max(end, begin + past)
        first, last = plan_at(scene, k)
        plan = scene.ints[first:last]
        formed = plan[0] != NO_FORM
        status, root = UNDECIDED, begin
        if formed:
            status, root = polynomial_root(
                code, constants, parts, scratch, plan, ox, oy, oz, dx, dy, dz, begin, stop, 1.0, anywhere
            )
        if status == UNDECIDED:
            if scratch[own_row, layout.LOST] >= layout.MOST_LOST:
                scratch[own_row, layout.LOST] += 1.0
                scratch[last_row, 0] += 1.0
                return NONE
            status, root = isolate(
                code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, begin, end, tolerance, 1.0, anywhere
            )
        else:
            end = stop
        if status == HIT:
            if anywhere or root - begin > tolerance * (end - begin) or begin > enter or enter > near:
                return root
            # A ray that begins inside is searched for the way out.
            status = UNDECIDED
            if formed:
                status, root = polynomial_root(
                    code, constants, parts, scratch, plan, ox, oy, oz, dx, dy, dz, enter, stop, -1.0, False
                )
            if status == UNDECIDED:
                status, root = exit_root(
                    code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, enter, stop, tolerance
                )
            return root if status == HIT else (stop if stop < far else NONE)
        if status == UNDECIDED:
            scratch[last_row, 0] += 1.0
            t = root + 4.0 * tolerance * (end - begin) * FARTHER**tries
            tries += 1
            if tries == RETRIES:
                scratch[own_row, layout.LOST] += 1.0
        else:
            t = end + past
    return NONE
