# mypy: ignore-errors
"""Pairs of masses as spheres: layout, cell lists of neighbors, and the impulse of an impact.

ints: number of masses; offsets in the floats of restitution, friction and tally, of the places, the sorted places,
numbers and starts of the cell lists, table of cells (neighbors.table); number of objects; offset in the ints of the
tied pairs (0: none); offset in the floats of the end of the last step, the masses' accelerations without contacts
then, and the impulses of their contacts (sphere_warm_kernels; local mode); BODY integers for each mass: offsets in y
of position, velocity and work, in the floats of mass, inverse mass and radius; the objects (shape_kernels). Tied
pairs, which do not collide, are n + 1 starts, one for each mass and the end, and then for each mass its partners of
larger number.
"""

import math

from numba import types

from sceneql.bodies.neighbors_kernels import cell_of, sort_by_cell
from sceneql.compiled.kernels import inlined, kernel
from sceneql.contacts.impact_kernels import scale_of
from sceneql.system.signatures_kernels import A, F, I, N

COUNT, RESTITUTION, FRICTION, TALLY, POINTS, SORTED, ORDER, START, SIZE, P, Q, OBJECTS, TIED, FREE, HEAD = range(15)
X, V, WORK, MASS, INVERSE, RADIUS, BODY = range(7)

FOUR = types.UniTuple(F, 4)
ROWS = types.float64[:, ::1]
PAIR_ROWS = types.int64[:, ::1]
MEET = types.void(F, F, I, I, A, A, A, A, I)
"""(end of the step, its length, the pairs: starts and other masses, state and rate at the start, state at the end,
floats, ints)."""
REST = types.void(F, I, I, ROWS, A, A, A, I)
"""(length of the step, the pairs, mean accelerations (n, 3), state at its start and end, floats, ints)."""
TOUCHING = 1e-9
"""Distance, relative to the radii, below which two masses touch."""
SLACK = 1e-4
"""The same for masses that are not elastic, which rest: what corrections of places leave must not part them."""
MOST_WARM = 4
"""Contacts for each mass, on average, whose impulses are kept for the next step."""

PAIRS, INSTANT, PAIR = SORTED, 7, 4
"""In `exact` mode floats[ints[POINTS] + INSTANT k:] has the last accepted instant of mass k (NaN before the first), its
place and velocity then; floats[ints[PAIRS] + PAIR p:] the memory of pair p, in the order of `pair_of`."""
RESTS, LOAD, PRESS, PULL = range(PAIR)
"""Memory of a pair: 1 where it rests, the force [N] that keeps it apart and that of friction across it, and where it is
close to touching the acceleration [m/s^2] of its distance."""


@inlined
def of(ints, k, what):
    """An integer of mass k."""
    return ints[HEAD + BODY * k + what]


@inlined
def radii(i, j, floats, ints):
    """Sum of the radii of two masses."""
    return floats[of(ints, i, RADIUS)] + floats[of(ints, j, RADIUS)]


@inlined
def tied(i, j, ints):
    """Whether mass i and mass j of larger number are tied, so that they do not meet."""
    found = False
    if ints[TIED] > 0:
        for at in range(ints[ints[TIED] + i], ints[ints[TIED] + i + 1]):
            found = found or ints[at] == j
    return found


@inlined
def pair_of(pair, ints):
    """The masses of a pair: (0, 1), (0, 2), ... (1, 2), ..."""
    i = 0
    while pair >= ints[COUNT] - 1 - i:
        pair -= ints[COUNT] - 1 - i
        i += 1
    return i, i + 1 + pair


@inlined
def distance(i, j, y, ints):
    """Distance [m] between the centers of two masses."""
    square = 0.0
    for c in range(3):
        square += (y[of(ints, i, X) + c] - y[of(ints, j, X) + c]) ** 2
    return math.sqrt(square)


@inlined
def extent(i, y, ints):
    """Size of a mass's coordinates [m], at least 1."""
    at = of(ints, i, X)
    return scale_of(y[at], y[at + 1], y[at + 2])


@kernel(FOUR(N, N, A, A, A, I), inner=True)
def impulse(i, j, r, v, floats, ints):
    """Impulse [N s] on mass i, its negative on j, at r = x_i - x_j with relative velocity v; the speed of approach.

    Newton's restitution along r; across it Coulomb friction, which never reverses the slip.
    """
    length = math.sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2])
    nx, ny, nz = r[0] / length, r[1] / length, r[2] / length
    vn = v[0] * nx + v[1] * ny + v[2] * nz
    tx, ty, tz = v[0] - vn * nx, v[1] - vn * ny, v[2] - vn * nz
    slip = math.sqrt(tx * tx + ty * ty + tz * tz)
    reduced = 1.0 / (floats[of(ints, i, INVERSE)] + floats[of(ints, j, INVERSE)])
    normal = -(1.0 + floats[ints[RESTITUTION]]) * vn * reduced
    part = min(reduced, floats[ints[FRICTION]] * normal / slip) if slip > 0.0 else 0.0
    return normal * nx - part * tx, normal * ny - part * ty, normal * nz - part * tz, -vn


@inlined
def rests_below(i, j, h, pull, floats, ints):
    """Speed of approach [m/s], that gained in two steps, below which two masses rest; elastic ones never rest."""
    if floats[ints[RESTITUTION]] >= 1.0:
        return 1e-12
    a, b = 0.0, 0.0
    for c in range(3):
        a += pull[i, c] ** 2
        b += pull[j, c] ** 2
    return 2.0 * h * math.sqrt(max(a, b)) + 1e-12


@inlined
def approach(i, j, y, ints):
    """Speed [m/s] at which two masses approach each other."""
    along, square = 0.0, 0.0
    for c in range(3):
        r = y[of(ints, i, X) + c] - y[of(ints, j, X) + c]
        along -= (y[of(ints, i, V) + c] - y[of(ints, j, V) + c]) * r
        square += r * r
    return along / math.sqrt(square)


@inlined
def sort_cells(edge, floats, ints):
    """Sort the places of all masses (floats[ints[POINTS]:], all x, all y, all z) into cubic cells, ``edge`` [m]."""
    lists = (ints[SIZE], ints[P], ints[Q], ints[SORTED], ints[ORDER], ints[START])
    sort_by_cell(floats, ints[COUNT], ints[POINTS], edge, *lists)


@kernel(N(N, F, I, A, I), inner=True)
def neighbors(k, edge, found, floats, ints):
    """Write masses of larger number in the cells around mass k to ``found``, as many as fit; their number."""
    n, points = ints[COUNT], ints[POINTS]
    i = cell_of(floats[points + k], edge)
    j = cell_of(floats[points + n + k], edge)
    l = cell_of(floats[points + 2 * n + k], edge)
    count = 0
    for row in range(27):
        di, dj, dl = row % 3 - 1, (row // 3) % 3 - 1, row // 9 - 1
        place = (i + di + ints[P] * (j + dj) + ints[Q] * (l + dl)) & (ints[SIZE] - 1)
        for one in range(int(floats[ints[START] + place]), int(floats[ints[START] + place + 1])):
            other = int(floats[ints[ORDER] + one])
            if other > k and count < found.size:
                found[count] = other
                count += 1
    return count
