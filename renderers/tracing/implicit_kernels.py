# mypy: ignore-errors
"""Rays against implicit objects: certified roots inside what an occupancy grid leaves of the object's box."""

import numpy as np
from numba import types

from renderers.tracing.scene_kernels import (
    CELLS,
    CELLS_AT,
    CROSSING,
    EMPTY,
    FULL,
    MIXED,
    SCENE,
    SCRATCH,
    TOLERANCE,
    WITHIN,
    part,
)
from renderers.tracing.solids_kernels import NONE, box_span, inverse
from sceneql.field.interval_kernels import box
from sceneql.field.isolation_kernels import exit_root, isolate, surface_root
from sceneql.field.tape_kernels import value
from sceneql.field.tape_ops import HIT, MISS, NOWHERE, UNDECIDED, WHOLE
from sceneql.kernels import kernel

RETRIES = 8
"""Undecided places passed on one ray before it counts as a miss."""
FARTHER = 10.0
"""By how much farther each of them is passed than the one before."""
BLOCK = 4
"""Cells along a side of the coarse blocks that are tried before their cells."""
PAD = 1e-7
"""By which a cell is enlarged, relative to its side, so that rounding in the walk does no harm."""


@part
def tape_of(scene, k, first=0):
    """Where the tape of the implicit object whose reals begin at k lies: begin and end of code, constants and parts.

    Its own are the ranges from the ``first`` on, those of others from PAINT and from WITHIN on.
    """
    n = scene.ints
    r = int(scene.reals[k + 6]) + first
    code, constants, parts = int(n[r]), int(n[r + 2]), int(n[r + 4])
    return code, code + 4 * n[r + 1], constants, constants + n[r + 3], parts, parts + 8 * n[r + 5]


@part
def cells_at(scene, k):
    """Place of the occupancy cells of the implicit object whose reals begin at k."""
    return scene.ints[int(scene.reals[k + 6]) + CELLS_AT]


@part
def is_sheet(scene, k):
    """Whether implicit object k is a sheet, not a solid."""
    return scene.ints[int(scene.reals[k + 6]) + WITHIN + 1] > 0


@part
def bounds(scene, scratch, k, first, i, j, l, side):
    """(low, high, status) of a tape of implicit object k in the cells (i..i+side, ...)."""
    b = scene.reals
    c0, c1, k0, k1, p0, p1 = tape_of(scene, k, first)
    code = scene.ints[c0:c1].reshape((c1 - c0) // 4, 4)
    constants = scene.reals[k0:k1]
    parts = scene.reals[p0:p1].reshape((p1 - p0) // 8, 8)
    h = ((b[k + 3] - b[k]) / CELLS, (b[k + 4] - b[k + 1]) / CELLS, (b[k + 5] - b[k + 2]) / CELLS)
    return box(
        code,
        constants,
        parts,
        scratch,
        b[k] + (i - PAD) * h[0],
        b[k] + (i + side + PAD) * h[0],
        b[k + 1] + (j - PAD) * h[1],
        b[k + 1] + (j + side + PAD) * h[1],
        b[k + 2] + (l - PAD) * h[2],
        b[k + 2] + (l + side + PAD) * h[2],
    )


@part
def region(scene, scratch, k, i, j, l, side):
    """What the cells (i..i+side, ...) of implicit object k are proved to be."""
    low, high, status = bounds(scene, scratch, k, 0, i, j, l, side)
    if status == NOWHERE or low > 0.0:
        return EMPTY
    if is_sheet(scene, k):
        return EMPTY if high < 0.0 or bounds(scene, scratch, k, WITHIN, i, j, l, side)[0] > 0.0 else MIXED
    return FULL if status == WHOLE and high < 0.0 else MIXED


@kernel(types.void(SCENE, SCRATCH, types.int64, types.int64), _nrt=False)
def occupy(scene, scratch, k, slab):
    """Fill a slab (BLOCK layers of cells along x) of implicit object k: coarse blocks first, then their cells."""
    base = cells_at(scene, k)
    for bj in range(0, CELLS, BLOCK):
        for bl in range(0, CELLS, BLOCK):
            coarse = region(scene, scratch, k, slab * BLOCK, bj, bl, BLOCK)
            for i in range(slab * BLOCK, slab * BLOCK + BLOCK):
                for j in range(bj, bj + BLOCK):
                    for l in range(bl, bl + BLOCK):
                        found = coarse
                        if coarse == MIXED:
                            found = region(scene, scratch, k, i, j, l, 1)
                        scene.ints[base + (i * CELLS + j) * CELLS + l] = found


@part
def step_to(d, low, cell, side, origin, inv):
    """t at which the ray leaves a cell along one axis."""
    return (low + (cell + (1 if d >= 0.0 else 0)) * side - origin) * inv


@part
def occupied(scene, k, ox, oy, oz, dx, dy, dz, start, stop):
    """(from, to, full): the first piece of [start, stop] that is not proved empty; from >= stop: none.

    It ends at the next empty cell, or behind a full one (``full``): there the ray is certainly inside.
    """
    b = scene.reals
    base = cells_at(scene, k)
    hx = (b[k + 3] - b[k]) / CELLS
    hy = (b[k + 4] - b[k + 1]) / CELLS
    hz = (b[k + 5] - b[k + 2]) / CELLS
    i = int(min(max((ox + start * dx - b[k]) / hx, 0.0), CELLS - 1.0))
    j = int(min(max((oy + start * dy - b[k + 1]) / hy, 0.0), CELLS - 1.0))
    l = int(min(max((oz + start * dz - b[k + 2]) / hz, 0.0), CELLS - 1.0))
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
        state = scene.ints[base + (i * CELLS + j) * CELLS + l]
        if state == EMPTY:
            if begin < NONE:
                return begin, t, False
        elif begin == NONE:
            begin = t
        leave = max(t, min(tx, min(ty, tz)))
        if state == FULL:
            return begin, min(leave, stop), True
        if tx <= ty and tx <= tz:
            i += 1 if dx >= 0.0 else -1
            tx += wx
            if i < 0 or i >= CELLS:
                break
        elif ty <= tz:
            j += 1 if dy >= 0.0 else -1
            ty += wy
            if j < 0 or j >= CELLS:
                break
        else:
            l += 1 if dz >= 0.0 else -1
            tz += wz
            if l < 0 or l >= CELLS:
                break
        t = leave
    return begin, stop, False


@part
def box_part(scene, k, ox, oy, oz, dx, dy, dz, near, far):
    """(from, to) of the ray inside the box of implicit object k."""
    b = scene.reals
    enter = near
    leave = far
    e, f = box_span(b[k], b[k + 3], ox, inverse(dx))
    enter = max(enter, e)
    leave = min(leave, f)
    e, f = box_span(b[k + 1], b[k + 4], oy, inverse(dy))
    enter = max(enter, e)
    leave = min(leave, f)
    e, f = box_span(b[k + 2], b[k + 5], oz, inverse(dz))
    return max(enter, e), min(leave, f)


@kernel(CROSSING.signature, _nrt=False)
def sheet(scene, scratch, k, ox, oy, oz, dx, dy, dz, near, far, anywhere):
    """Crossing of the sheet of implicit object k behind ``near``: its first root inside what it lies within."""
    c0, c1, k0, k1, p0, p1 = tape_of(scene, k)
    code = scene.ints[c0:c1].reshape((c1 - c0) // 4, 4)
    constants = scene.reals[k0:k1]
    parts = scene.reals[p0:p1].reshape((p1 - p0) // 8, 8)
    c0, c1, k0, k1, p0, p1 = tape_of(scene, k, WITHIN)
    code_within = scene.ints[c0:c1].reshape((c1 - c0) // 4, 4)
    constants_within = scene.reals[k0:k1]
    parts_within = scene.reals[p0:p1].reshape((p1 - p0) // 8, 8)
    b = scene.reals
    side = min(b[k + 3] - b[k], b[k + 4] - b[k + 1], b[k + 5] - b[k + 2]) / CELLS
    t, stop = box_part(scene, k, ox, oy, oz, dx, dy, dz, near, far)
    past = 0.1 * PAD * side / np.sqrt(dx * dx + dy * dy + dz * dz)
    tolerance = b[TOLERANCE]
    tries = 0
    while t < stop and tries < RETRIES:
        begin, end, _ = occupied(scene, k, ox, oy, oz, dx, dy, dz, t, stop)
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


@kernel(CROSSING.signature, _nrt=False)
def crossing(scene, scratch, k, ox, oy, oz, dx, dy, dz, near, far, anywhere):
    """Crossing of implicit object k behind ``near``; with ``anywhere`` of any place inside, not the first."""
    if is_sheet(scene, k):
        return sheet(scene, scratch, k, ox, oy, oz, dx, dy, dz, near, far, anywhere)
    c0, c1, k0, k1, p0, p1 = tape_of(scene, k)
    code = scene.ints[c0:c1].reshape((c1 - c0) // 4, 4)
    constants = scene.reals[k0:k1]
    parts = scene.reals[p0:p1].reshape((p1 - p0) // 8, 8)
    b = scene.reals
    side = min(b[k + 3] - b[k], b[k + 4] - b[k + 1], b[k + 5] - b[k + 2]) / CELLS
    enter, stop = box_part(scene, k, ox, oy, oz, dx, dy, dz, near, far)
    if not enter < stop:
        return NONE
    tolerance = b[TOLERANCE]
    t = enter
    tries = 0
    past = 0.1 * PAD * side / np.sqrt(dx * dx + dy * dy + dz * dz)  # into the next cell, within what its pad covers
    while t < stop and tries < RETRIES:
        begin, end, full = occupied(scene, k, ox, oy, oz, dx, dy, dz, t, stop)
        if not begin < stop:
            return NONE
        if full and anywhere:
            return begin
        end = max(end, begin + past)
        status, root = isolate(
            code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, begin, end, tolerance, 1.0, anywhere
        )
        if status == HIT:
            if anywhere or root - begin > tolerance * (end - begin) or begin > enter or enter > near:
                return root
            # The ray begins inside: the way out.
            status, root = exit_root(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, enter, stop, tolerance)
            return root if status == HIT else (stop if stop < far else NONE)
        if status == UNDECIDED:
            scratch[scratch.shape[0] - 1, 0] += 1.0
            t = root + 4.0 * tolerance * (end - begin) * FARTHER**tries
            tries += 1
        else:
            t = end + past
    return NONE
