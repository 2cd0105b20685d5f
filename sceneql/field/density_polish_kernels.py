# mypy: ignore-errors
"""Roots of c - D along rays in float64, D the density of points with Wyvill's kernel: Newton's method in lanes."""

import numpy as np

from sceneql.field.ray_rows import FOUND_HIGH, FOUND_LOW, FOUND_ROOT, FOUND_STATUS, SETTLED
from sceneql.field.tape_ops import UNDECIDED
from sceneql.kernels import inlined

X, DX, ROOT, SPEED, DENSITY, SLOPE, BEND = 0, 3, 6, 7, 8, 9, 10
"""Rows of ``room``: places, directions, places along the rays from their own starts, squares of the directions, D there
and its first two derivatives."""


@inlined
def sum_up(parts, kept, room, n):
    """D and its first two derivatives at n places."""
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
    """A step of Chebyshev's method, whose error falls with the third power, for the first ``count`` rays of the
    ``queue``, which are hits."""
    for i in range(count):
        j = np.uint64(queue[i])
        t = rays[6, j] + found[FOUND_ROOT, j]
        for axis in range(3):
            room[X + axis, i] = rays[axis, j] + t * rays[3 + axis, j]
            room[DX + axis, i] = rays[3 + axis, j]
    sum_up(parts, kept, room, count)
    for i in range(count):
        j = np.uint64(queue[i])
        first = found[FOUND_ROOT, j]
        step = (threshold - room[DENSITY, i]) / room[SLOPE, i]
        bent = 0.5 * step * step * room[BEND, i] / room[SLOPE, i]
        root = min(max(first + step - bent, found[FOUND_LOW, j]), found[FOUND_HIGH, j])
        search = rays[7, j] - rays[6, j]
        # What the second derivative gives is far more than what the third would.
        if not (abs(bent) <= SETTLED * search and rays[6, j] + root < rays[7, j]):
            found[FOUND_STATUS, j] = UNDECIDED
        found[FOUND_ROOT, j] = root
