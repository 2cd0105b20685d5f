# mypy: ignore-errors
"""Roots of c - D along rays in float64, D the density of points with Wyvill's kernel: Newton's method in lanes."""

import numpy as np

from sceneql.compiled.kernels import inlined
from sceneql.compiled.lanes_kernels import BYTES, below, load, spread, store
from sceneql.field.enclose.extent_kernels import extent
from sceneql.field.packets.ray_rows import FOUND_HIGH, FOUND_LOW, FOUND_ROOT, FOUND_STATUS, SETTLED
from sceneql.field.tape.tape_ops import UNDECIDED

X, DX, ROOT, SPEED, DENSITY, SLOPE, BEND, BEGIN, END, SEARCH, BOX = 0, 3, 6, 7, 8, 9, 10, 11, 12, 13, 14
"""Rows of ``room``: points (3), directions (3), roots (t from the rays' own starts), squared directions, D there and
its first two derivatives along the ray, brackets of the roots (2), lengths of the searches, bounds; see ``polish``."""
HAIR = 1.0e-12
ABREAST = BYTES // 8
"""Rays in lanes."""
TOGETHER = 64
"""Rays that are polished together, with the parts that reach into the box about their roots."""
WIDER = 1.0 + 1.0e-9
"""Squares of distances above so many times that of a reach are out of it, whatever the rounding."""


@inlined
def outside(x, low, high):
    """How far a number is outside low..high."""
    below, above = low - x, x - high
    off = below if below > above else above
    return off if off > 0.0 else 0.0


@inlined
def list_near(parts, kept, room, start, stop, listed):
    """List those of ``kept`` parts that reach into the bounding box of points start..stop-1; returns their number."""
    low_x, high_x = extent(room[X, start:stop], stop - start)
    low_y, high_y = extent(room[X + 1, start:stop], stop - start)
    low_z, high_z = extent(room[X + 2, start:stop], stop - start)
    n = 0
    for k in range(kept):
        cx, cy, cz, reach = parts[k, 0], parts[k, 1], parts[k, 2], parts[k, 6]
        wx, wy, wz = outside(cx, low_x, high_x), outside(cy, low_y, high_y), outside(cz, low_z, high_z)
        listed[n] = k
        n += 0 if wx * wx + wy * wy + wz * wz > WIDER * reach * reach else 1
    return n


@inlined
def sum_up(parts, listed, kept, room, start, stop):
    """D of the listed parts and its first two derivatives along the ray at points start..stop-1."""
    for i in range(start, stop, ABREAST):
        x, y, z = load(room[X], i), load(room[X + 1], i), load(room[X + 2], i)
        dx, dy, dz = load(room[DX], i), load(room[DX + 1], i), load(room[DX + 2], i)
        density = slope = bend = spread(0.0)
        speed = dx * dx + dy * dy + dz * dz
        for m in range(kept):
            k = np.uint64(listed[m])
            weight, inverse = parts[k, 7], 1.0 / (parts[k, 6] * parts[k, 6])
            wx, wy, wz = x - parts[k, 0], y - parts[k, 1], z - parts[k, 2]
            u = 1.0 - inverse * (wx * wx + wy * wy + wz * wz)
            u = below(0.0, u, u, 0.0)
            along = wx * dx + wy * dy + wz * dz
            rise = (-6.0 * weight * inverse) * u
            density = density + weight * (u * u * u)
            slope = slope + rise * (u * along)
            bend = bend + rise * (u * speed + (-4.0 * inverse) * (along * along))
        store(room[SPEED], i, speed)
        store(room[DENSITY], i, density)
        store(room[SLOPE], i, slope)
        store(room[BEND], i, bend)


@inlined
def polish(parts, kept, threshold, rays, queue, count, room, listed, found):
    """A step of Chebyshev's method (cubic convergence) for the first ``count`` rays of the ``queue``, which are hits.
    ``listed`` is working memory. Into row BOX of ``room``: bounds, least and largest x, y and z, of the hit points and
    of those SETTLED of their searches behind."""
    roots, lows, highs, searches = room[ROOT], room[BEGIN], room[END], room[SEARCH]
    begins, ends = rays[6], rays[7]
    found_root, found_low, found_high = found[FOUND_ROOT], found[FOUND_LOW], found[FOUND_HIGH]
    for i in range(count):
        j = np.uint64(queue[i])
        roots[i], lows[i], highs[i] = found_root[j], found_low[j], found_high[j]
        t = begins[j] + roots[i]
        searches[i] = ends[j] - begins[j]
        for axis in range(3):
            room[X + axis, i] = rays[axis, j] + t * rays[3 + axis, j]
            room[DX + axis, i] = rays[3 + axis, j]
    for start in range(0, count, TOGETHER):
        stop = min(start + TOGETHER, count)
        sum_up(parts, listed, list_near(parts, kept, room, start, stop, listed), room, start, stop)
    x, y, z, dx, dy, dz = room[X], room[X + 1], room[X + 2], room[DX], room[DX + 1], room[DX + 2]
    speed, density, slope, bend = room[SPEED], room[DENSITY], room[SLOPE], room[BEND]
    for i in range(count):
        step = (threshold - density[i]) / slope[i]
        bent = 0.5 * step * step * bend[i] / slope[i]
        root = roots[i] + step - bent
        root = root if root > lows[i] else lows[i]
        root = root if root < highs[i] else highs[i]
        # The term of the second derivative is far larger than that of the third, and so bounds the error.
        settled = (abs(bent) <= SETTLED * searches[i]) & (root < searches[i])
        bend[i] = 1.0 if settled else 0.0
        step = root - roots[i]
        x[i], y[i], z[i] = x[i] + step * dx[i], y[i] + step * dy[i], z[i] + step * dz[i]
        roots[i] = root
        dx[i] = searches[i] * searches[i] * speed[i]
    outcomes = found[FOUND_STATUS]
    for i in range(count):
        j = np.uint64(queue[i])
        found_root[j] = roots[i]
        outcomes[j] = outcomes[j] if bend[i] > 0.0 else UNDECIDED
    box = room[BOX]
    if count > 0:
        for row in range(4):
            box[2 * row], box[2 * row + 1] = extent(room[X + row], count)
        late = SETTLED * np.sqrt(box[7])
        for row in range(3):
            low, high = box[2 * row], box[2 * row + 1]
            hair = late + HAIR * (abs(low) + abs(high))
            box[2 * row], box[2 * row + 1] = low - hair, high + hair
