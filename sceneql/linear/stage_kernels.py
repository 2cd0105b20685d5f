# mypy: ignore-errors
"""Factor and solve the linear systems of implicit stages, (1 - a J) d = r, as stage.py has planned them.

The integers of a plan: [entries of y, unknowns, values of the matrix; numbers of eliminated positions and of tallies;
then where these start: unknowns, positions (3 each), for each block of the matrix its parts (4: the unit of its row,
places in the Jacobian of a first coefficient and of a second one, and the first position that one goes through; -1:
none), diagonal, twins (the place of the transposed block), the solver's own, tallies; floats of the factors; 1 while
the matrix is symmetric; the numbers of the solver's kernels; unknowns of a unit (1, or 3 of a mass: blocks are square,
row by row); tiles of blocks, the numbers of threads_kernels.threads, the addresses of the tiles' kernels; the number of
the kernel that counts negative eigenvalues (-1: none); numbers and places of the entries of inertia that is a matrix,
and of the values that are held (elimination.Inertia); of the unknowns, how many of the last border the system
(system.Slopes.border), number and place of what their rows hold of rates (4: place among the values, row, entry of y,
place in the Jacobian); 1 where factors are kept for later matrices (kept_factors_kernels), and 1 where for an a that
differs by rounding]. ``scales``: factors of the rows, 1 for those of such inertia; then Inertia.numbers. ``store``:
values of the matrix, factors, scratch, where factors are kept four vectors of unknowns, two numbers a tile, and last a
right side (unknowns,).
"""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.threads_kernels import TILE, over_threads
from sceneql.linear.solver_kernels import factor_at, negatives_at, solve_at
from sceneql.system.signatures_kernels import A, F, I

SIZE, UNKNOWNS, VALUES, POSITIONS, TALLIES = range(5)
CORE_AT, POSITIONS_AT, PARTS_AT, DIAGONAL_AT, TWINS_AT, SOLVER_AT, TALLIES_AT = range(5, 12)
FACTORS, SYMMETRIC, FACTOR, SOLVE, UNIT = range(12, 17)
TILES, ENTRY, THREADS, ASSEMBLE, COMPARE, NEGATIVES, INERTIA, HELD, INERTIA_AT, HELD_AT = range(17, 27)
BORDER, BORDERS, BORDERS_AT, KEEPS, ROUNDED, HEAD = range(27, 33)

ROUNDING = 1e-13
"""Differences of transposed values up to this part of the largest value count as rounding."""

FACTOR_STAGE = types.boolean(I, F, A, A, A)
SOLVE_STAGE = types.boolean(I, F, A, A, A, A)


@lean(TILE)
def assemble_tile(number, a, jacobian, values, scales, plan):
    """Assemble a tile of the reduced matrix, its rows scaled."""
    unit = plan[UNIT]
    square = unit * unit
    blocks, tiles = plan[VALUES] // square, plan[TILES]
    for block in range(blocks * number // tiles, blocks * (number + 1) // tiles):
        at = plan[PARTS_AT] + 4 * block
        row, direct, through = unit * plan[at], plan[at + 1], plan[at + 2]
        ones = plan[POSITIONS_AT] + 3 * plan[at + 3] + 2
        k = square * block
        for i in range(unit):
            scale = -scales[row + i]
            for j in range(unit):
                value = a * jacobian[direct + unit * i + j] if direct >= 0 else 0.0
                if through >= 0:
                    value += a * jacobian[through + unit * i + j] * (a * jacobian[plan[ones + 3 * j]])
                values[k] = scale * value
                k += 1


@lean_inlined
def add_inertia(plan, scales, values):
    """Add inertia, of masses and of matrices."""
    unit, at, m = plan[UNIT], plan[DIAGONAL_AT], plan[UNKNOWNS]
    for k in range(plan[HELD_AT], plan[HELD_AT] + plan[HELD]):
        values[plan[k]] = 0.0
    for k in range(m - plan[BORDER]):
        if scales[m + k] < 0.0:
            inside = k % unit
            values[(plan[at + k // unit] * unit + inside) * unit + inside] += scales[k]
    for k in range(plan[INERTIA]):
        values[plan[plan[INERTIA_AT] + 3 * k]] += scales[2 * m + k]


@lean_inlined
def by_inertia(plan, scales, r, b):
    """The residuals in b, multiplied by inertia that is a matrix: other rows are left."""
    m, core = plan[UNKNOWNS], plan[CORE_AT]
    for k in range(m):
        if scales[m + k] >= 0.0:
            b[k] = 0.0
    for k in range(plan[INERTIA]):
        at = plan[INERTIA_AT] + 3 * k
        b[plan[at + 1]] += scales[2 * m + k] * r[plan[core + plan[at + 2]]]


@lean_inlined
def along(plan, scales, p, q):
    """Scalar product of the unknowns' entries of p and q, by the inertia."""
    m, core = plan[UNKNOWNS], plan[CORE_AT]
    total = 0.0
    for k in range(m - plan[BORDER]):
        if plan[INERTIA] == 0 or scales[m + k] < 0.0:
            total += scales[k] * p[plan[core + k]] * q[plan[core + k]]
    for k in range(plan[INERTIA]):
        at = plan[INERTIA_AT] + 3 * k
        total += scales[2 * m + k] * p[plan[core + plan[at + 1]]] * q[plan[core + plan[at + 2]]]
    return total


@lean_inlined
def assemble(plan, a, jacobian, scales, values):
    """Assemble the reduced matrix, its rows scaled."""
    if plan[TILES] == 1:
        assemble_tile(0, a, jacobian, values, scales, plan)
    else:
        over_threads(plan[ENTRY], plan[THREADS], plan[ASSEMBLE], plan[TILES], a, jacobian, values, scales, plan)
    for at in range(plan[BORDERS_AT], plan[BORDERS_AT] + 4 * plan[BORDERS], 4):
        values[plan[at]] += jacobian[plan[at + 3]]
    unit, at = plan[UNIT], plan[DIAGONAL_AT]
    if plan[INERTIA] > 0:
        add_inertia(plan, scales, values)
        return
    for k in range(plan[UNKNOWNS] - plan[BORDER]):
        inside = k % unit
        values[(plan[at + k // unit] * unit + inside) * unit + inside] += scales[k]


@lean(TILE)
def compare_tile(number, t, values, found, scales, plan):
    """The largest value of a tile, and the largest difference of a value from its transposed one."""
    unit = plan[UNIT]
    square = unit * unit
    blocks, tiles = plan[VALUES] // square, plan[TILES]
    largest = apart = 0.0
    for block in range(blocks * number // tiles, blocks * (number + 1) // tiles):
        k, twin = square * block, square * plan[plan[TWINS_AT] + block]
        if k <= twin:
            for i in range(unit):
                for j in range(unit):
                    largest = max(largest, abs(values[k + unit * i + j]))
                    apart = max(apart, abs(values[k + unit * i + j] - values[twin + unit * j + i]))
    found[2 * number], found[2 * number + 1] = largest, apart


@lean_inlined
def is_symmetric(plan, values, found):
    """Whether the matrix is symmetric, but for rounding."""
    tiles = plan[TILES]
    if tiles == 1:
        compare_tile(0, 0.0, values, found, values, plan)
    else:
        over_threads(plan[ENTRY], plan[THREADS], plan[COMPARE], tiles, 0.0, values, found, values, plan)
    largest = apart = 0.0
    for k in range(tiles):
        largest, apart = max(largest, found[2 * k]), max(apart, found[2 * k + 1])
    return apart <= ROUNDING * largest


@lean(FACTOR_STAGE)
def assemble_stage(plan, a, jacobian, scales, store):
    """Assemble the matrix at a [s], a method's coefficient times its step; whether it is symmetric."""
    assemble(plan, a, jacobian, scales, store)
    symmetric = is_symmetric(plan, store, store[store.size - plan[UNKNOWNS] - 2 * plan[TILES] :])
    plan[SYMMETRIC] = 1 if symmetric else 0
    return symmetric


@lean(FACTOR_STAGE)
def factor_stage(plan, a, jacobian, scales, store):
    """Factor the matrix at a [s]; False where it is singular or not finite."""
    symmetric = assemble_stage(plan, a, jacobian, scales, store)
    factors = store[plan[VALUES] :]
    return factor_at(plan[FACTOR])(plan[plan[SOLVER_AT] :], store, factors, factors[plan[FACTORS] :], symmetric)


@lean_inlined
def indefinite(plan, store):
    """Whether the factored matrix has a negative eigenvalue, as far as its solver can tell."""
    if plan[SYMMETRIC] != 1 or plan[NEGATIVES] < 0:
        return False
    factors = store[plan[VALUES] :]
    return negatives_at(plan[NEGATIVES])(plan[plan[SOLVER_AT] :], store, factors, factors[plan[FACTORS] :]) > 0


@lean_inlined
def through_positions(plan, a, jacobian, r, b):
    """Add the residuals of the eliminated positions' rows to the other rows."""
    unit, positions = plan[UNIT], plan[POSITIONS_AT]
    moved = False
    for k in range(plan[POSITIONS]):
        moved = moved or r[plan[positions + 3 * k]] != 0.0
    if not moved:
        return
    for at in range(plan[PARTS_AT], plan[PARTS_AT] + 4 * (plan[VALUES] // (unit * unit)), 4):
        place = plan[at + 2]
        if place >= 0:
            for i in range(unit):
                total = 0.0
                for j in range(unit):
                    total += jacobian[place + unit * i + j] * r[plan[positions + 3 * (plan[at + 3] + j)]]
                b[unit * plan[at] + i] += a * total


@lean_inlined
def right_side(plan, a, jacobian, scales, r, b):
    """The right side b of the reduced system, its rows scaled."""
    m = plan[UNKNOWNS]
    own_entries = m - plan[BORDER]
    core = plan[CORE_AT]
    for k in range(own_entries):
        b[k] = r[plan[core + k]]
    for k in range(own_entries, m):
        b[k] = 0.0
    for at in range(plan[BORDERS_AT], plan[BORDERS_AT] + 4 * plan[BORDERS], 4):
        b[plan[at + 1]] += jacobian[plan[at + 3]] * r[plan[at + 2]]
    if plan[INERTIA] > 0:
        by_inertia(plan, scales, r, b)
    through_positions(plan, a, jacobian, r, b)
    for k in range(m if plan[INERTIA] > 0 else 0):
        if scales[m + k] == 0.0:
            b[k] = r[plan[core + k]]
    for k in range(m):
        b[k] *= scales[k]


@lean_inlined
def solution(plan, a, jacobian, b, r):
    """All entries d, in the place of r, by the reduced system's solution b."""
    core, positions = plan[CORE_AT], plan[POSITIONS_AT]
    for k in range(plan[UNKNOWNS] - plan[BORDER]):
        r[plan[core + k]] = b[k]
    for at in range(positions, positions + 3 * plan[POSITIONS], 3):
        r[plan[at]] += a * jacobian[plan[at + 2]] * r[plan[at + 1]]


@lean(SOLVE_STAGE)
def solve_stage(plan, a, jacobian, scales, store, r):
    """Solve (1 - a J) d = r by the factors; d takes the place of r, in the size of y. False: no convergence."""
    factors = store[plan[VALUES] :]
    b = store[store.size - plan[UNKNOWNS] :]
    right_side(plan, a, jacobian, scales, r, b)
    own, work = plan[plan[SOLVER_AT] :], factors[plan[FACTORS] :]
    solved = solve_at(plan[SOLVE])(own, store, factors, b, work, plan[SYMMETRIC] == 1)
    solution(plan, a, jacobian, b, r)
    return solved
