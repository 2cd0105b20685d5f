# mypy: ignore-errors
"""Intersects listed rays, of every kind, with one implicit solid, in bundles of 256 (sceneql.field)."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.scene_kernels import ASKED, part
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
def in_box(asked, first, n, box, lines, enter, leave):
    """Write (from, to) of n listed rays inside a box (2, 3), and their places and directions into ``lines``."""
    for i in range(n):
        row = asked[first + i]
        for k in range(6):
            lines[k, i] = row[k]
        enter[i], leave[i] = 0.0, row[layout.FAR]
    for axis in range(3):
        low, high, origins, ways = box[0, axis], box[1, axis], lines[axis], lines[3 + axis]
        for i in range(n):
            d = ways[i]
            per = 1.0 / d if abs(d) > 1e-300 else 1e300  # as solids_kernels.inverse
            one, two = (low - origins[i]) * per, (high - origins[i]) * per
            near, far = (one if one < two else two), (two if one < two else one)
            enter[i] = near if near > enter[i] else enter[i]
            leave[i] = far if far < leave[i] else leave[i]


@part
def cut(clip, size, off, n, lines, enter, first, last):
    """Narrow first..last, from ``enter`` on, to where n lines are in a quadric (10,) of field.clips, if convex."""
    a, b, c = clip[0], clip[1], clip[2]
    xy, yz, zx = clip[3], clip[4], clip[5]
    for i in range(n):
        dx, dy, dz = lines[3, i], lines[4, i], lines[5, i]
        ox, oy, oz = lines[0, i] + enter[i] * dx, lines[1, i] + enter[i] * dy, lines[2, i] + enter[i] * dz
        slack = off[i] * size
        g2 = a * dx * dx + b * dy * dy + c * dz * dz + xy * dx * dy + yz * dy * dz + zx * dz * dx
        g1 = 2.0 * (a * ox * dx + b * oy * dy + c * oz * dz) + clip[6] * dx + clip[7] * dy + clip[8] * dz
        g1 += xy * (ox * dy + oy * dx) + yz * (oy * dz + oz * dy) + zx * (oz * dx + ox * dz)
        g0 = a * ox * ox + b * oy * oy + c * oz * oz + xy * ox * oy + yz * oy * oz + zx * oz * ox
        g0 += clip[6] * ox + clip[7] * oy + clip[8] * oz + clip[9] - slack
        square = g1 * g1 - 4.0 * g0 * g2
        square += 1.0e-13 * (g1 * g1 + abs(g0 * g2))
        root = np.sqrt(square if square > 0.0 else 0.0)
        over = 2.0 * g2 if g2 > slack else 1.0
        low, high = (-g1 - root) / over, (-g1 + root) / over
        low, high = (np.inf if square < 0.0 else low), (-np.inf if square < 0.0 else high)
        slant = (g2 == 0.0) & (abs(g1) > slack)
        edge = -g0 / (g1 if slant else 1.0)
        low = low if g2 > slack else (edge if slant & (g1 < 0.0) else -np.inf)
        high = high if g2 > slack else (edge if slant & (g1 > 0.0) else np.inf)
        first[i] = low if low > first[i] else first[i]
        last[i] = high if high < last[i] else last[i]


@part
def in_solid(asked, start, n, box, clips, sizes, lines, enter, leave):
    """Write (from, to) of n listed rays in a box and ``clips`` (k, 10), whose values in the box are of ``sizes`` (k,).

    ``lines`` (9, n) is working memory.
    """
    in_box(asked, start, n, box, lines, enter, leave)
    if clips.shape[0] == 0:
        return
    reach = 0.0
    for axis in range(3):
        reach = max(reach, max(abs(box[0, axis]), abs(box[1, axis])))
    off, first, last = lines[6], lines[7], lines[8]
    for i in range(n):
        size = abs(lines[0, i]) + abs(lines[1, i]) + abs(lines[2, i]) + enter[i]
        off[i] = ROUNDED * (1.0 + 1.0e-2 * size / reach)
        first[i], last[i] = 0.0, leave[i] - enter[i]
    for k in range(clips.shape[0]):
        cut(clips[k], sizes[k], off, n, lines, enter, first, last)
    for i in range(n):
        leave[i] = enter[i] + last[i]
        enter[i] = enter[i] + first[i]


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


SOLID = (*ARGUMENTS, _rows, _rows, types.float64[::1], _rows, ASKED, types.int64, _lists, _spans)
"""Types of what ``meet_asked`` takes."""


@lean(types.void(*SOLID))
def meet_asked(
    code, constants, singles, registers, point, status, lanes, ids, rays, asked_from, queue, found, parts, scratch,
    beams, doubles, points, short, near_singles, near_parts, plan, order, room, table, flat, other, box, clips,
    sizes, matrix, asked, column, chosen, spans,
):  # fmt: skip
    """Crossings of all rays of ``asked`` with {f < 0} in ``box`` (2, 3) and ``clips`` (k, 10), into a column of it.

    ``code`` and its data are f in the coordinates of ``place``; box and clips are in the world's. ``chosen`` (2, 1 +
    RAYS) and ``spans`` (3, 2, RAYS) are working memory: rows and spans of the waiting rays, by what they want, and in
    the last column of ``chosen`` their number; the last spans are those of the listed rays at hand.
    """
    rows = int(asked[0, layout.NEXT])
    chosen[layout.FIRST, RAYS] = chosen[layout.ANYWHERE, RAYS] = 0
    enters, leaves = spans[2, 0], spans[2, 1]
    for row in range(1, rows + 2):
        # After the last ray the waiting ones are intersected, a whole bundle or not.
        want = int(asked[row, layout.WANT]) if row < rows else (layout.FIRST if row == rows else layout.ANYWHERE)
        at = (row - 1) % RAYS
        if row < rows:
            if at == 0:
                in_solid(asked, row, min(RAYS, rows - row), box, clips, sizes, room, enters, leaves)
            asked[row, column] = np.inf
            if want == layout.NOTHING or not enters[at] < leaves[at]:
                continue
        waiting, own = chosen[want], spans[want]
        n = waiting[RAYS]
        if row < rows:
            waiting[n], own[0, n], own[1, n] = row, enters[at], leaves[at]
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
