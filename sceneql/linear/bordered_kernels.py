# mypy: ignore-errors
"""Systems of many symmetric unknowns and a few others, as elastic solids beside rigid bodies: block elimination.

    (E B; C D) (x; z) = (b; c):  W = E^-1 B,  S = D - C W,  S z = c - C E^-1 b,  x = E^-1 b - W z

E, of the many, is factored by another solver, mostly as a symmetric matrix; S, of the few, by a dense one with
pivoting (Golub & Van Loan, Matrix Computations, 2013, 3.2.6).

The integers of a plan: [the numbers of MANY and FEW; values of E; the numbers of the kernels that factor E and solve;
1 while E is symmetric; floats of its factors, and of its scratch; then where these start: the places of the many and of
the few among the unknowns, the values of E among all, the place of the transposed value of each, pivots; numbers and
places of entries of B, C and D (3: place among all values, row and column); the solver's own]. ``factors``: those of E,
then its values, W column by column, S.
"""

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.linear.dense_kernels import factor, solve
from sceneql.linear.solver_kernels import FACTOR_SYSTEM, SOLVE_SYSTEM, factor_at, solve_at
from sceneql.linear.stage_kernels import ROUNDING

MANY, FEW, VALUES, FACTOR, SOLVE, SYMMETRIC, FACTORS, WORK = range(8)
MANY_AT, FEW_AT, VALUES_AT, TWINS_AT, PIVOTS_AT = range(8, 13)
BESIDE, BESIDE_AT, BELOW, BELOW_AT, CORNER, CORNER_AT, OWN_AT, HEAD = range(13, 21)


@lean_inlined
def is_symmetric(plan, values):
    """Whether the values of E are symmetric, but for rounding."""
    largest = apart = 0.0
    for k in range(plan[VALUES]):
        value = values[k]
        largest = max(largest, abs(value))
        apart = max(apart, abs(value - values[plan[plan[TWINS_AT] + k]]))
    return apart <= ROUNDING * largest


@lean(FACTOR_SYSTEM)
def factor_system(plan, values, factors, work, symmetric):
    """Factor E and S; False where one is singular or not finite."""
    many, few = plan[MANY], plan[FEW]
    own, inner = plan[plan[OWN_AT] :], factors[plan[FACTORS] :]
    for k in range(plan[VALUES]):
        inner[k] = values[plan[plan[VALUES_AT] + k]]
    plan[SYMMETRIC] = 1 if is_symmetric(plan, inner) else 0
    if not factor_at(plan[FACTOR])(own, inner, factors, work, plan[SYMMETRIC] == 1):
        return False
    beside = inner[plan[VALUES] : plan[VALUES] + many * few]
    corner = inner[plan[VALUES] + many * few :]
    for k in range(many * few):
        beside[k] = 0.0
    for k in range(few * few):
        corner[k] = 0.0
    for at in range(plan[BESIDE_AT], plan[BESIDE_AT] + 3 * plan[BESIDE], 3):
        beside[plan[at + 2] * many + plan[at + 1]] = values[plan[at]]
    for j in range(few):
        column = beside[j * many : (j + 1) * many]
        touched = False
        for k in range(many):
            touched = touched or column[k] != 0.0
        if touched and not solve_at(plan[SOLVE])(own, inner, factors, column, work, plan[SYMMETRIC] == 1):
            return False
    for at in range(plan[CORNER_AT], plan[CORNER_AT] + 3 * plan[CORNER], 3):
        corner[plan[at + 1] * few + plan[at + 2]] = values[plan[at]]
    for at in range(plan[BELOW_AT], plan[BELOW_AT] + 3 * plan[BELOW], 3):
        value, row = values[plan[at]], plan[at + 1] * few
        if value != 0.0:
            for j in range(few):
                corner[row + j] -= value * beside[j * many + plan[at + 2]]
    return factor(corner, few, plan[plan[PIVOTS_AT] :])


@lean(SOLVE_SYSTEM)
def solve_system(plan, values, factors, b, work, symmetric):
    """Solve by the factors of ``factor_system``; the solution takes the place of b."""
    many, few = plan[MANY], plan[FEW]
    own, inner, room = plan[plan[OWN_AT] :], factors[plan[FACTORS] :], work[plan[WORK] :]
    x, z = room[:many], room[many : many + few]
    beside, corner = inner[plan[VALUES] :], inner[plan[VALUES] + many * few :]
    for k in range(many):
        x[k] = b[plan[plan[MANY_AT] + k]]
    for k in range(few):
        z[k] = b[plan[plan[FEW_AT] + k]]
    if not solve_at(plan[SOLVE])(own, inner, factors, x, work, plan[SYMMETRIC] == 1):
        return False
    for at in range(plan[BELOW_AT], plan[BELOW_AT] + 3 * plan[BELOW], 3):
        z[plan[at + 1]] -= values[plan[at]] * x[plan[at + 2]]
    solve(corner, few, plan[plan[PIVOTS_AT] :], z)
    for j in range(few):
        if z[j] != 0.0:
            for k in range(many):
                x[k] -= beside[j * many + k] * z[j]
    for k in range(many):
        b[plan[plan[MANY_AT] + k]] = x[k]
    for k in range(few):
        b[plan[plan[FEW_AT] + k]] = z[k]
    return True
