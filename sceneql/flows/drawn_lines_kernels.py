# mypy: ignore-errors
"""Lines along a velocity, followed piece by piece; none comes near to an earlier one."""

import math

import numpy as np
from numba import types

from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.system.signatures_kernels import A, F, I, N

BACK = 4
"""Steps after which a line may have come back to its start."""
CLOSED = 0.6
"""Distance from its start, in steps, at which it has."""
OUT = 1e-6
"""Relative overshoot of a line's last step beyond the box, where the line then ends."""
LOW, HIGH, SPACING, SLOWEST, STEP, SIDE, CORNER, NUMBERS = 0, 3, 6, 9, 10, 11, 12, 15
"""Where in the numbers stand: corners of the box that lines stay in (3 each) [m], sides of a cell (3) [m], the speed
that counts as rest [m/s], the length of a step [m]; side [m] and low corner (3) of the boxes that hold pieces of one
line each. How many there are."""
AXES, SHAPE, BOXES, MOST, LEAST, COUNTS = 0, 1, 4, 7, 8, 9
"""Where in the counts stand: axes; nodes of the velocities along x, y and z (3); boxes along each (3); most steps of a
line in each direction, and least pieces of a line that is drawn. How many there are."""


@lean_inlined
def between(at, low, spacing, last):
    """(first, part): the node before a coordinate ``at``, one of 0..last - 1, and how far on it is, in nodes."""
    place = (at - low) / spacing + 0.5
    first = min(max(math.floor(place), 0.0), max(last - 1.0, 0.0))
    return int(first), min(max(place - first, 0.0), 1.0) if last > 0.0 else 0.0


@lean(types.void(A, A, A, A, I))
def along(values, point, way, numbers, counts):
    """Write the unit vector along the velocity at a point (3,) to ``way`` (3,): 0 at rest, and outside of the box."""
    axes = counts[AXES]
    for c in range(3):
        way[c] = 0.0
    for c in range(axes):
        if not numbers[LOW + c] <= point[c] <= numbers[HIGH + c]:
            return
    nx, ny, nz = counts[SHAPE], counts[SHAPE + 1], counts[SHAPE + 2]
    i, x = between(point[0], numbers[LOW], numbers[SPACING], nx - 1.0)
    j, y = between(point[1], numbers[LOW + 1], numbers[SPACING + 1], ny - 1.0)
    k, z = between(point[2], numbers[LOW + 2], numbers[SPACING + 2], nz - 1.0)
    node = i + nx * (j + ny * k)
    square = 0.0
    for c in range(axes):
        own = values[c * nx * ny * nz :]
        total = 0.0
        for corner in range(8 if nz > 1 else 4):
            dx, dy, dz = corner & 1, corner >> 1 & 1, corner >> 2
            weight = (x if dx else 1.0 - x) * (y if dy else 1.0 - y) * (z if dz else 1.0 - z)
            total += weight * own[node + dx + nx * (dy + ny * dz)]
        way[c] = total
        square += total * total
    speed = math.sqrt(square)
    for c in range(axes):
        way[c] = way[c] / speed if speed > numbers[SLOWEST] else 0.0


@lean(N(A, A, I))
def box_of(point, numbers, counts):
    """The number of the box that a point (3,) stands in; of one outside, of the nearest."""
    found = 0
    for c in range(counts[AXES]):
        here = math.floor((point[c] - numbers[CORNER + c]) / numbers[SIDE])
        found = found * counts[BOXES + c] + min(max(here, 0), counts[BOXES + c] - 1)
    return found


@lean(N(A, A, A, F, A, A, I))
def go_on(values, at, to, sign, room, numbers, counts):
    """Write the point (3,) a step from ``at``, by the midpoint rule, to ``to``; 1, or 0 where the line has ended.

    ``room`` (6,) is working memory.
    """
    middle, way = room[:3], room[3:]
    step = sign * numbers[STEP]
    along(values, at, way, numbers, counts)
    for c in range(3):
        middle[c] = at[c] + 0.5 * step * way[c]
    along(values, middle, way, numbers, counts)
    part, moved = 1.0, 0.0
    for c in range(counts[AXES]):
        change = step * way[c]
        moved += abs(change)
        if change != 0.0:
            wall = numbers[HIGH + c] if change > 0.0 else numbers[LOW + c]
            part = min(part, (wall - at[c]) / change * (1.0 + OUT))
    for c in range(3):
        to[c] = at[c] + part * step * way[c]
    return 1 if moved * part != 0.0 else 0


@kernel(N(A, A, A, I, A))
def follow(values, starts, numbers, counts, found):
    """Write the ends (k, 2, 3) of the pieces of lines from ``starts`` (n, 3) to ``found``; how many there are.

    ``values``: the components of the velocity at nodes (axes, nz, ny, nx). Lines that have fewer pieces than the least
    are left out.
    """
    whole = 1
    for c in range(counts[AXES]):
        whole *= counts[BOXES + c]
    taken, mine = np.zeros(whole, dtype=np.bool_), np.zeros(2 * counts[MOST] + 2, dtype=np.int64)
    room, at, to = np.empty(6), np.empty(3), np.empty(3)
    total = 0
    for k in range(starts.size // 3):
        start = starts[3 * k : 3 * k + 3]
        if taken[box_of(start, numbers, counts)]:
            continue
        first, own = total, 0
        for way in range(2):
            at[:] = start
            for n in range(1, counts[MOST] + 1):
                if go_on(values, at, to, 1.0 - 2.0 * way, room, numbers, counts) == 0:
                    break
                box = box_of(to, numbers, counts)
                if taken[box]:
                    break
                away = 0.0
                for c in range(3):
                    found[6 * total + c], found[6 * total + 3 + c] = at[c], to[c]
                    away += (to[c] - start[c]) ** 2
                mine[own] = box
                own += 1
                total += 1
                at[:] = to
                if n >= BACK and math.sqrt(away) < CLOSED * numbers[STEP]:
                    break
        if own < counts[LEAST]:
            total = first
            continue
        for j in range(own):
            taken[mine[j]] = True
    return total
