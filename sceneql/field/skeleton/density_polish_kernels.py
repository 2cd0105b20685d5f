# mypy: ignore-errors
"""Roots of c - D along rays in float64, D the density of points with Wyvill's kernel: Newton's method in lanes."""

import numpy as np

from sceneql.compiled.kernels import inlined
from sceneql.field.enclose.extent_kernels import extent
from sceneql.field.packets.ray_rows import FOUND_HIGH, FOUND_LOW, FOUND_ROOT, FOUND_STATUS, SETTLED
from sceneql.field.tape.tape_ops import UNDECIDED

X, DX, ROOT, SPEED, DENSITY, SLOPE, BEND, BEGIN, END, SEARCH, BOX = 0, 3, 6, 7, 8, 9, 10, 11, 12, 13, 14
"""Rows of ``room``: points (3), directions (3), roots (t from the rays' own starts), squared directions, D there and
its first two derivatives along the ray, brackets of the roots (2), lengths of the searches, bounds; see ``polish``."""
HAIR = 1.0e-12


@inlined
def sum_up(parts, kept, room, n):
    """D and its first two derivatives along the ray at n points."""
    x, y, z, dx, dy, dz = room[X], room[X + 1], room[X + 2], room[DX], room[DX + 1], room[DX + 2]
    speed, density, slope, bend = room[SPEED], room[DENSITY], room[SLOPE], room[BEND]
    for i in range(n):
        density[i] = slope[i] = bend[i] = 0.0
        speed[i] = dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i]
    for k in range(kept):
        cx, cy, cz, weight = parts[k, 0], parts[k, 1], parts[k, 2], parts[k, 7]
        inverse = 1.0 / (parts[k, 6] * parts[k, 6])
        steep = -6.0 * weight * inverse
        twist = -4.0 * inverse
        for i in range(n):
            wx, wy, wz = x[i] - cx, y[i] - cy, z[i] - cz
            u = 1.0 - inverse * (wx * wx + wy * wy + wz * wz)
            u = u if u > 0.0 else 0.0
            along = wx * dx[i] + wy * dy[i] + wz * dz[i]
            rise = steep * u
            density[i] += weight * (u * u * u)
            slope[i] += rise * (u * along)
            bend[i] += rise * (u * speed[i] + twist * (along * along))


@inlined
def polish(parts, kept, threshold, rays, queue, count, room, found):
    """A step of Chebyshev's method (cubic convergence) for the first ``count`` rays of the ``queue``, which are hits.
    Into row BOX of ``room``: bounds, least and largest x, y and z, of the hit points and of those SETTLED of their
    searches behind."""
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
    sum_up(parts, kept, room, count)
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
