# mypy: ignore-errors
"""Factor and solve the linear systems of implicit stages, (1 - a J) d = r, as stage.py has planned them.

The integers of a plan: [entries of y, unknowns, values of the matrix; numbers of eliminated positions and of tallies;
then where these start: unknowns, positions (3 each), for each value of the matrix its parts (4: the unknown of its
row, places in the Jacobian of a first coefficient and of a second one, and which position that one goes through; -1:
none), diagonal, twins (the place of the transposed entry), the solver's own, tallies; floats of the factors; 1 while
the matrix is symmetric; the numbers of the solver's kernels]. ``store``: values of the matrix, factors, scratch, and
last a right side (unknowns,).
"""

from numba import types

from sceneql.kernels import lean, lean_inlined
from sceneql.simulation.linear.solver_kernels import factor_at, solve_at
from sceneql.system_kernels import A, F, I

SIZE, UNKNOWNS, VALUES, POSITIONS, TALLIES = range(5)
CORE_AT, POSITIONS_AT, PARTS_AT, DIAGONAL_AT, TWINS_AT, SOLVER_AT, TALLIES_AT = range(5, 12)
FACTORS, SYMMETRIC, FACTOR, SOLVE, HEAD = range(12, 17)

ROUNDING = 1e-13
"""Of the largest value: a difference of two twins that is none."""

FACTOR_STAGE = types.boolean(I, F, A, A, A)
SOLVE_STAGE = types.boolean(I, F, A, A, A, A)


@lean_inlined
def assemble(plan, a, jacobian, scales, values):
    """The matrix that is left, its rows scaled."""
    at, positions = plan[PARTS_AT], plan[POSITIONS_AT]
    for k in range(plan[VALUES]):
        value = 0.0
        if plan[at + 1] >= 0:
            value = a * jacobian[plan[at + 1]]
        if plan[at + 2] >= 0:
            value += a * jacobian[plan[at + 2]] * (a * jacobian[plan[positions + 3 * plan[at + 3] + 2]])
        values[k] = -scales[plan[at]] * value
        at += 4
    at = plan[DIAGONAL_AT]
    for k in range(plan[UNKNOWNS]):
        values[plan[at + k]] += scales[k]


@lean_inlined
def is_symmetric(values, twins):
    """Whether every value is that of its twin, but for rounding."""
    largest = 0.0
    apart = 0.0
    for k in range(twins.size):
        largest = max(largest, abs(values[k]))
        apart = max(apart, abs(values[k] - values[twins[k]]))
    return apart <= ROUNDING * largest


@lean(FACTOR_STAGE)
def factor_stage(plan, a, jacobian, scales, store):
    """Factor the matrix at a [s], a method's coefficient times its step; False where it is singular or not finite."""
    count = plan[VALUES]
    assemble(plan, a, jacobian, scales, store)
    symmetric = is_symmetric(store, plan[plan[TWINS_AT] : plan[TWINS_AT] + count])
    plan[SYMMETRIC] = 1 if symmetric else 0
    factors = store[count:]
    return factor_at(plan[FACTOR])(plan[plan[SOLVER_AT] :], store, factors, factors[plan[FACTORS] :], symmetric)


@lean(SOLVE_STAGE)
def solve_stage(plan, a, jacobian, scales, store, r):
    """Solve (1 - a J) d = r by the factors; d takes the place of r, in the size of y. False: no convergence."""
    m = plan[UNKNOWNS]
    factors = store[plan[VALUES] :]
    b = store[store.size - m :]
    core, positions = plan[CORE_AT], plan[POSITIONS_AT]
    for k in range(m):
        b[k] = r[plan[core + k]]
    moved = False
    for k in range(plan[POSITIONS]):
        moved = moved or r[plan[positions + 3 * k]] != 0.0
    if moved:
        for at in range(plan[PARTS_AT], plan[PARTS_AT] + 4 * plan[VALUES], 4):
            if plan[at + 2] >= 0:
                b[plan[at]] += a * jacobian[plan[at + 2]] * r[plan[positions + 3 * plan[at + 3]]]
    for k in range(m):
        b[k] *= scales[k]
    own, work = plan[plan[SOLVER_AT] :], factors[plan[FACTORS] :]
    solved = solve_at(plan[SOLVE])(own, store, factors, b, work, plan[SYMMETRIC] == 1)
    for k in range(m):
        r[plan[core + k]] = b[k]
    for at in range(positions, positions + 3 * plan[POSITIONS], 3):
        r[plan[at]] += a * jacobian[plan[at + 2]] * r[plan[at + 1]]
    return solved
