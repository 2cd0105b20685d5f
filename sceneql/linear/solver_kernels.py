# mypy: ignore-errors
"""How linear solvers are called: factor the values of a matrix, then solve, both by their numbers in a plan.

    factor(plan, values, factors, work, symmetric) -> False where the matrix is singular or not finite
    solve(plan, values, factors, b, work, symmetric) -> False where it does not converge; the solution in b's place
    negatives(plan, values, factors, work) -> number of negative eigenvalues of symmetric values that are factored

``plan``: the solver's own integers, which it may change; ``symmetric``: the values are.
"""

from numba import types

from sceneql.compiled.numbered_kernels import kernel_at
from sceneql.system.signatures_kernels import A, I

FACTOR_SYSTEM = types.boolean(I, A, A, A, types.boolean)
SOLVE_SYSTEM = types.boolean(I, A, A, A, A, types.boolean)

PRECONDITION = types.void(I, A, A, A)
"""Preconditioner of an iteration, (plan, factors, b, x): x approximates the solution of A x = b."""

NEGATIVES = types.int64(I, A, A, A)

factor_at, solve_at, precondition_at = map(kernel_at, (FACTOR_SYSTEM, SOLVE_SYSTEM, PRECONDITION))
negatives_at = kernel_at(NEGATIVES)
