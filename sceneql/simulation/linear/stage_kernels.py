# mypy: ignore-errors
"""Factor and solve the linear systems of implicit stages, (1 - a J) d = r, as stage.py has planned them.

The integers of a plan: [entries of y, kind, unknowns, values of the matrix; numbers of eliminated positions, of first
and of second coefficients, of tallies; then where these start: unknowns, positions (3 each), first (3), second (5),
diagonal, twins (the place of the transposed entry), the solver's own, pivots, tallies; floats of the factors; 1 while
the matrix is symmetric]. ``store``: values of the matrix, factors, scratch, and last a right side (unknowns,).
"""

from numba import types

from sceneql.kernels import lean, lean_inlined
from sceneql.simulation.linear import dense_kernels as dense
from sceneql.simulation.linear import fronts_kernels as fronts
from sceneql.simulation.linear import krylov_kernels as krylov
from sceneql.system_kernels import A, F, I

DENSE, FRONTS, KRYLOV = range(3)
SIZE, KIND, UNKNOWNS, VALUES, POSITIONS, FIRSTS, SECONDS, TALLIES = range(8)
CORE_AT, POSITIONS_AT, FIRSTS_AT, SECONDS_AT, DIAGONAL_AT, TWINS_AT, SOLVER_AT, PIVOTS_AT, TALLIES_AT = range(8, 17)
FACTORS, SYMMETRIC = 17, 18

ROUNDING = 1e-13
"""Of the largest value: a difference of two twins that is none."""

FACTOR_STAGE = types.boolean(I, F, A, A, A)
SOLVE_STAGE = types.boolean(I, F, A, A, A, A)


@lean_inlined
def assemble(plan, a, jacobian, scales, values):
    """The matrix that is left, its rows scaled."""
    for k in range(plan[VALUES]):
        values[k] = 0.0
    at = plan[FIRSTS_AT]
    for _ in range(plan[FIRSTS]):
        values[plan[at + 1]] -= scales[plan[at + 2]] * (a * jacobian[plan[at]])
        at += 3
    at = plan[SECONDS_AT]
    for _ in range(plan[SECONDS]):
        through = a * jacobian[plan[at + 1]]
        values[plan[at + 2]] -= scales[plan[at + 3]] * (a * jacobian[plan[at]] * through)
        at += 5
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
    factors = store[count:]
    own = plan[plan[SOLVER_AT] :]
    if plan[KIND] == DENSE:
        return dense.factor(store, plan[UNKNOWNS], plan[plan[PIVOTS_AT] :])
    symmetric = is_symmetric(store, plan[plan[TWINS_AT] : plan[TWINS_AT] + count])
    plan[SYMMETRIC] = 1 if symmetric else 0
    if plan[KIND] == FRONTS:
        return fronts.factor(own, store, factors, factors[plan[FACTORS] :], symmetric)
    krylov.factor(own, store, factors)
    return True


@lean(SOLVE_STAGE)
def solve_stage(plan, a, jacobian, scales, store, r):
    """Solve (1 - a J) d = r by the factors; d takes the place of r, in the size of y. False: no convergence."""
    m, count = plan[UNKNOWNS], plan[VALUES]
    factors = store[count:]
    work = factors[plan[FACTORS] :]
    b = store[store.size - m :]
    own = plan[plan[SOLVER_AT] :]
    core = plan[CORE_AT]
    for k in range(m):
        b[k] = r[plan[core + k]]
    at = plan[SECONDS_AT]
    for _ in range(plan[SECONDS]):
        b[plan[at + 3]] += a * jacobian[plan[at]] * r[plan[at + 4]]
        at += 5
    for k in range(m):
        b[k] *= scales[k]
    solved = True
    if plan[KIND] == DENSE:
        dense.solve(store, m, plan[plan[PIVOTS_AT] :], b)
    elif plan[KIND] == FRONTS:
        fronts.solve(own, factors, b, work, plan[SYMMETRIC] == 1)
    else:
        solved = krylov.solve(own, store, factors, b, work, plan[SYMMETRIC] == 1)
    for k in range(m):
        r[plan[core + k]] = b[k]
    at = plan[POSITIONS_AT]
    for _ in range(plan[POSITIONS]):
        r[plan[at]] += a * jacobian[plan[at + 2]] * r[plan[at + 1]]
        at += 3
    return solved
