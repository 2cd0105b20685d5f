# mypy: ignore-errors
"""Roots of c - D along rays in float64, D the density of points with Wyvill's kernel: Newton's method in lanes."""

from sceneql.field.hunt_kernels import FOUND_HIGH, FOUND_LOW, FOUND_ROOT, FOUND_STATUS, SETTLED
from sceneql.field.tape_ops import UNDECIDED
from sceneql.kernels import inlined

X, DX, ROOT, DENSITY, SLOPE = 0, 3, 6, 7, 8
"""Rows of ``room``: places, directions, places along the rays from their own starts, D and its slope there."""


@inlined
def sum_up(parts, kept, room, n):
    """D and its slope at n places."""
    x, y, z, dx, dy, dz = room[X], room[X + 1], room[X + 2], room[DX], room[DX + 1], room[DX + 2]
    density, slope = room[DENSITY], room[SLOPE]
    for i in range(n):
        density[i] = slope[i] = 0.0
    for k in range(kept):
        cx, cy, cz, weight = parts[k, 0], parts[k, 1], parts[k, 2], parts[k, 7]
        inverse = 1.0 / (parts[k, 6] * parts[k, 6])
        steep = -6.0 * weight * inverse
        for i in range(n):
            wx, wy, wz = x[i] - cx, y[i] - cy, z[i] - cz
            u = 1.0 - inverse * (wx * wx + wy * wy + wz * wz)
            u = u if u > 0.0 else 0.0
            square = u * u
            density[i] += weight * (square * u)
            slope[i] += steep * (square * (wx * dx[i] + wy * dy[i] + wz * dz[i]))


@inlined
def polish(parts, kept, threshold, rays, queue, count, room, found):
    """Two of Newton's steps for the first ``count`` rays of the ``queue``, which are hits."""
    for i in range(count):
        j = queue[i]
        root = found[FOUND_ROOT, j]
        t = rays[6, j] + root
        room[ROOT, i] = root
        for axis in range(3):
            room[X + axis, i] = rays[axis, j] + t * rays[3 + axis, j]
            room[DX + axis, i] = rays[3 + axis, j]
    for turn in range(2):
        sum_up(parts, kept, room, count)
        for i in range(count):
            j = queue[i]
            old = room[ROOT, i]
            step = (threshold - room[DENSITY, i]) / room[SLOPE, i]
            root = min(max(old + step, found[FOUND_LOW, j]), found[FOUND_HIGH, j])
            room[ROOT, i] = root
            for axis in range(3):
                room[X + axis, i] += (root - old) * room[DX + axis, i]
            if turn == 1:
                search = rays[7, j] - rays[6, j]
                if not (abs(step) <= SETTLED * search and rays[6, j] + root < rays[7, j]):
                    found[FOUND_STATUS, j] = UNDECIDED
                found[FOUND_ROOT, j] = root
