# mypy: ignore-errors
"""Linear systems of implicit stages by the factors of an earlier matrix, and conjugate gradients (Hestenes & Stiefel
1952, J. Res. NBS 49, 409).

From one update of Newton's method to the next the stiffness of friction changes by a factor of some two where the slip
shrinks, and little else: with the earlier factors as preconditioner a few iterations bring what updates need, each of
which takes a twentieth of a factorization of a solid.
"""

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.linear.multifrontal import layout
from sceneql.linear.multifrontal.single_precision_kernels import subtract_product
from sceneql.linear.solver_kernels import solve_at
from sceneql.linear.stage_kernels import (
    FACTORS,
    SOLVE,
    SOLVE_STAGE,
    SOLVER_AT,
    SYMMETRIC,
    TILES,
    UNKNOWNS,
    VALUES,
    right_side,
    solution,
)

MOST = 8
"""Largest number of iterations."""
SOON, SLOWLY = 3, 0.5
"""Iterations after which the norm must have fallen to a part of the first: else a factorization costs less."""
ENOUGH = 5e-2
"""Part of the right side's norm, by the factors, to which a residual is brought down."""


@lean_inlined
def dot(x, y):
    """The scalar product."""
    total = 0.0
    for k in range(x.size):
        total += x[k] * y[k]
    return total


@lean(SOLVE_STAGE)
def solve_by_kept(plan, a, jacobian, scales, store, r):
    """Solve as stage_kernels.solve_stage does, for the matrix that is assembled; False, r unchanged, where its factors
    are too far from it, or it is not positive on the way."""
    m, factors = plan[UNKNOWNS], store[plan[VALUES] :]
    own, work, solve = plan[plan[SOLVER_AT] :], factors[plan[FACTORS] :], solve_at(plan[SOLVE])
    room = store[store.size - 5 * m - 2 * plan[TILES] : store.size - m - 2 * plan[TILES]]
    x, left, way, product = room[:m], room[m : 2 * m], room[2 * m : 3 * m], room[3 * m :]
    near = store[store.size - m :]
    if plan[SYMMETRIC] != 1 or own[layout.IN_SINGLE] in (layout.NEW, layout.WEAK):
        return False  # poor factors are refined by the matrix that they are not of
    right_side(plan, a, jacobian, scales, r, near)
    for k in range(m):
        left[k], x[k] = near[k], 0.0
    first = size = 0.0
    for turn in range(MOST + 1):
        if turn > 0:
            for k in range(m):
                near[k] = left[k]
        if not solve(own, store, factors, near, work, True):
            return False
        before, size = size, dot(left, near)
        if turn == 0:
            first = size
        if not size >= 0.0 or (turn == SOON and size > SLOWLY * SLOWLY * first):
            return False
        if size <= ENOUGH * ENOUGH * first:
            for k in range(m):
                near[k] = x[k]
            solution(plan, a, jacobian, near, r)
            return True
        back = size / before if turn > 0 else 0.0
        for k in range(m):
            way[k] = near[k] + back * way[k] if turn > 0 else near[k]
        for k in range(m):
            product[k] = 0.0
        subtract_product(own, store, way, product)
        bend = -dot(way, product)
        if not bend > 0.0:
            return False
        part = size / bend
        for k in range(m):
            x[k] += part * way[k]
            left[k] += part * product[k]
    return False
