# mypy: ignore-errors
"""Sparse factorization on a planned pattern by the multifrontal method, and solutions with the factors.

The integers of a plan: [unknowns, fronts, where these start: order, rows, maps, entries, pivots; floats of the
updates; where the pieces start, how many; the numbers of threads_kernels.threads, the address of the kernel that
factors a piece; unknowns of a unit, whose blocks make up the matrix; the addresses of the kernels that solve in a
piece; numbers and addresses of the same of single_precision_kernels (-1: not worth it), whether the factors are in
single precision, how many next ones are not to be, whether solutions are to be refined, the bits of what the matrix was
multiplied by; where the starts of the rows of blocks and their columns start], then a table with FIELDS a front: first
unknown, number eliminated, rows of the front, then where its rows, its map into the parent, its factors and its entries
(blocks: first value, its place in the front) start, its last child and the child of its parent before it (-1: none),
where its update stands in the work, and where its entries below the diagonal start; last a row that ends them. A map is
in runs: where each ends in the update, and its first place in the parent. A piece: its first front, the one after its
last, and whether it was factored. A front keeps U (width x rows, the reciprocals of the pivots on its diagonal) and,
where the matrix is not symmetric, L below it ((rows - width) x width). Symmetric: A = U^T D^-1 U. Pivots are sought in
the same block of rows alone.
"""

import numpy as np

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.linear.multifrontal import layout
from sceneql.linear.multifrontal.entries_kernels import FACTOR_GENERAL, SOLVE_GENERAL, factor_single_at, solve_single_at
from sceneql.linear.multifrontal.solve_kernels import solve_symmetric
from sceneql.linear.multifrontal.symmetric_kernels import factor_symmetric
from sceneql.linear.solver_kernels import FACTOR_SYSTEM, NEGATIVES, SOLVE_SYSTEM

RESTS = 7
"""Factorizations in double precision after one in single precision was too inaccurate."""

factor_general = lazy("sceneql.linear.multifrontal.general_kernels:factor_general", FACTOR_GENERAL)
solve_general = lazy("sceneql.linear.multifrontal.general_kernels:solve_general", SOLVE_GENERAL)


@lean(FACTOR_SYSTEM)
def factor_system(plan, values, factors, work, symmetric):
    """Factor the matrix of ``values``, in the order of the pattern planned; False where a pivot is 0 or not finite.

    ``factors`` and ``work`` of the plan's sizes; ``symmetric`` says that the values are, so that half is computed.
    """
    if symmetric:
        plan[layout.IN_SINGLE] = 0
        if plan[layout.SINGLE_FACTOR] >= 0 and plan[layout.RESTING] == 0:
            if factor_single_at(plan[layout.SINGLE_FACTOR])(plan, values, factors, work):
                plan[layout.IN_SINGLE] = layout.NEW
                return True
            plan[layout.RESTING] = RESTS + 1
        plan[layout.RESTING] = max(0, plan[layout.RESTING] - 1)
        return factor_symmetric(plan, values, factors, work)
    return factor_general(plan, values, factors, work)


@lean(SOLVE_SYSTEM)
def solve_system(plan, values, factors, b, work, symmetric):
    """Solve by the factors of ``factor_system``; the solution takes the place of b."""
    if symmetric:
        if plan[layout.IN_SINGLE] > 0:
            if solve_single_at(plan[layout.SINGLE_SOLVE])(plan, values, factors, b, work):
                return True
            plan[layout.IN_SINGLE], plan[layout.RESTING] = 0, RESTS
            if not factor_symmetric(plan, values, factors, work):
                return False
        solve_symmetric(plan, factors, b, work)
        return True
    solve_general(plan, factors, b, work)
    return True


@lean_inlined
def count(plan, factors):
    """Negative reciprocals of pivots, on the diagonals of the fronts."""
    found = 0
    for s in range(plan[1]):
        t = layout.HEAD + layout.FIELDS * s
        width, height, panel = plan[t + 1], plan[t + 2], plan[t + 5]
        for k in range(width):
            if factors[panel + k * height + k] < 0.0:
                found += 1
    return found


@lean(NEGATIVES)
def negatives(plan, values, factors, work):
    """As many as negative pivots of the factors."""
    if plan[layout.IN_SINGLE] > 0:
        return count(plan, factors.view(np.float32))
    return count(plan, factors)
