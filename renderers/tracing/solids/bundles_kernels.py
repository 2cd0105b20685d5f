# mypy: ignore-errors
"""Intersects listed rays, of every kind, with one implicit solid, in bundles of 256 (sceneql.field)."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.scene_kernels import ASKED, part
from renderers.tracing.solids.solids_kernels import box_span, inverse
from sceneql.compiled.kernels import lean
from sceneql.field.packets import ray_rows
from sceneql.field.packets.packet_roots_kernels import ARGUMENTS, GROUP, first_roots
from sceneql.field.tape.tape_ops import HIT, MISS

_rows = types.float64[:, ::1]
_lists, _spans = types.int64[:, ::1], types.float64[:, :, ::1]
RAYS = 256
"""Rays of a bundle."""
ROUNDED = 1.0e-12
"""Error of a clip, relative to its terms in the box: far more than its rounding."""
FINE = 1.0e-9
"""Distance to a root, relative to the searched piece of the ray, below which the ray begins inside."""


@part
def in_box(asked, row, box):
    """(from, to) of a listed ray inside a box (2, 3)."""
    enter, leave = 0.0, asked[row, layout.FAR]
    for axis in range(3):
        first, last = box_span(box[0, axis], box[1, axis], asked[row, axis], inverse(asked[row, 3 + axis]))
        enter, leave = max(enter, first), min(leave, last)
        if not enter < leave:
            break
    return enter, leave


@part
def cut(clip, ox, oy, oz, dx, dy, dz, slack):
    """(from, to) of a line where a quadric (10,) of field.clips is below ``slack``; the whole line if not convex."""
    a, b, c = clip[0], clip[1], clip[2]
    xy, yz, zx = clip[3], clip[4], clip[5]
    g2 = a * dx * dx + b * dy * dy + c * dz * dz + xy * dx * dy + yz * dy * dz + zx * dz * dx
    g1 = 2.0 * (a * ox * dx + b * oy * dy + c * oz * dz) + clip[6] * dx + clip[7] * dy + clip[8] * dz
    g1 += xy * (ox * dy + oy * dx) + yz * (oy * dz + oz * dy) + zx * (oz * dx + ox * dz)
    g0 = a * ox * ox + b * oy * oy + c * oz * oz + xy * ox * oy + yz * oy * oz + zx * oz * ox
    g0 += clip[6] * ox + clip[7] * oy + clip[8] * oz + clip[9] - slack
    if g2 > slack:
        square = g1 * g1 - 4.0 * g0 * g2
        square += 1.0e-13 * (g1 * g1 + abs(g0 * g2))
        if square < 0.0:
            return np.inf, -np.inf
        root = np.sqrt(square)
        return (-g1 - root) / (2.0 * g2), (-g1 + root) / (2.0 * g2)
    if g2 == 0.0 and abs(g1) > slack:
        return (-np.inf, -g0 / g1) if g1 > 0.0 else (-g0 / g1, np.inf)
    return -np.inf, np.inf


@part
def in_solid(asked, row, box, clips, sizes):
    """(from, to) of a listed ray in a box and ``clips`` (k, 10), whose values in the box are of ``sizes`` (k,)."""
    enter, leave = in_box(asked, row, box)
    if clips.shape[0] == 0 or not enter < leave:
        return enter, leave
    dx, dy, dz = asked[row, 3], asked[row, 4], asked[row, 5]
    x, y, z = asked[row, 0] + enter * dx, asked[row, 1] + enter * dy, asked[row, 2] + enter * dz
    reach = 0.0
    for axis in range(3):
        reach = max(reach, max(abs(box[0, axis]), abs(box[1, axis])))
    off = ROUNDED * (1.0 + 1.0e-2 * (abs(asked[row, 0]) + abs(asked[row, 1]) + abs(asked[row, 2]) + enter) / reach)
    first, last = 0.0, leave - enter
    for k in range(clips.shape[0]):
        low, high = cut(clips[k], x, y, z, dx, dy, dz, off * sizes[k])
        first, last = max(first, low), min(last, high)
    return enter + first, enter + last


@part
def place(rays, asked, chosen, spans, matrix, n):
    """Write n listed rays into a bundle, consecutive ones in columns of GROUP; returns the number with padding.

    They are transformed by ``matrix`` (3, 4) (x, y, z, 1). Rays that fill the last column have no length.
    """
    groups = (n + GROUP - 1) // GROUP
    for i in range(groups * GROUP):
        j = i % GROUP * groups + i // GROUP
        row = chosen[min(i, n - 1)]
        x, y, z, dx, dy, dz = asked[row, 0], asked[row, 1], asked[row, 2], asked[row, 3], asked[row, 4], asked[row, 5]
        for axis in range(3):
            a, b, c = matrix[axis, 0], matrix[axis, 1], matrix[axis, 2]
            rays[axis, j] = a * x + b * y + c * z + matrix[axis, 3]
            rays[3 + axis, j] = a * dx + b * dy + c * dz
        rays[6, j] = spans[0, i] if i < n else 0.0
        rays[7, j] = spans[1, i] if i < n else 0.0
    return groups * GROUP


@part
def answer(rays, found, j, anywhere):
    """The crossing of ray j, inf for a miss; NaN where the certified routine of single rays must decide."""
    if found[ray_rows.FOUND_STATUS, j] == MISS:
        return np.inf
    if found[ray_rows.FOUND_STATUS, j] != HIT:
        return np.nan
    t, t0, t1 = found[ray_rows.FOUND_ROOT, j], rays[6, j], rays[7, j]
    if anywhere:  # the blocker is proved to be between these
        low = t0 + found[ray_rows.FOUND_LOW, j]
        return min(max(t, low), max(t0 + found[ray_rows.FOUND_HIGH, j], low))
    # A ray that begins inside must leave first.
    return t if t0 > 0.0 or t > t0 + FINE * (t1 - t0) else np.nan


@lean(types.void(*ARGUMENTS, _rows, _rows, types.float64[::1], _rows, ASKED, types.int64, _lists, _spans))
def meet_asked(
    code, constants, singles, registers, point, status, lanes, ids, rays, asked_from, queue, found, parts, scratch,
    beams, doubles, points, short, near_singles, near_parts, plan, order, room, table, flat, other, box, clips,
    sizes, matrix, asked, column, chosen, spans,
):  # fmt: skip
    """Crossings of all rays of ``asked`` with {f < 0} in ``box`` (2, 3) and ``clips`` (k, 10), into a column of it.

    ``code`` and its data are f in the coordinates of ``place``; box and clips are in the world's. ``chosen`` (2, 1 +
    RAYS) and ``spans`` (2, 2, RAYS) are working memory: rows and spans of the waiting rays, by what they want, and in
    the last column of ``chosen`` their number.
    """
    rows = int(asked[0, layout.NEXT])
    chosen[layout.FIRST, RAYS] = chosen[layout.ANYWHERE, RAYS] = 0
    for row in range(1, rows + 2):
        # After the last ray the waiting ones are intersected, a whole bundle or not.
        want = int(asked[row, layout.WANT]) if row < rows else (layout.FIRST if row == rows else layout.ANYWHERE)
        if row < rows:
            asked[row, column] = np.inf
            if want == layout.NOTHING:
                continue
            enter, leave = in_solid(asked, row, box, clips, sizes)
            if not enter < leave:
                continue
        waiting, own = chosen[want], spans[want]
        n = waiting[RAYS]
        if row < rows:
            waiting[n], own[0, n], own[1, n] = row, enter, leave
            n += 1
            waiting[RAYS] = n
        if n == RAYS or (row >= rows and n > 0):
            count = place(rays, asked, waiting, own, matrix, n)
            first_roots(
                code, constants, singles, registers, point, status, lanes, ids, rays, asked_from, queue, count,
                want == layout.ANYWHERE, found, parts, scratch, beams, doubles, points, short, near_singles, near_parts,
                plan, order, room, table, flat, other,
            )  # fmt: skip
            groups = count // GROUP
            for i in range(n):
                lane = i % GROUP * groups + i // GROUP
                asked[waiting[i], column] = answer(rays, found, lane, want == layout.ANYWHERE)
            waiting[RAYS] = 0
