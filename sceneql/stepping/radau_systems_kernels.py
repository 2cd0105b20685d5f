# mypy: ignore-errors
"""The interface of radau's linear solvers: three kernels, called by their numbers in the plan.

The systems are (REAL/h - J) x = b and (ALPHA/h + i BETA/h - J)(x + i y) = b + i c.

    factor(plan, h, values, rows, store) -> False where one is singular
    solve(plan, h, values, rows, store, weights, r) -> False where it does not converge; solutions in the place of r
    filter(plan, h, values, rows, store, r) -> the same for the real system alone

``plan``: the solver's own integers, which it may change; ``values`` (room of the pattern): the Jacobian; ``rows``: the
solver's factors of rows, if it has any; ``store``: its memory; ``weights`` (n,): 1/(allowed error of an entry); ``r``
(3n,): b of the real system, b and c of the complex one; (n,) for `filter`.
"""

from numba import types

from sceneql.compiled.numbered_kernels import kernel_at
from sceneql.system.signatures_kernels import A, F, I

FACTOR_STAGES = types.boolean(I, F, A, A, A)
SOLVE_STAGES = types.boolean(I, F, A, A, A, A, A)
FILTER = types.boolean(I, F, A, A, A, A)

factor_at, solve_at, filter_at = map(kernel_at, (FACTOR_STAGES, SOLVE_STAGES, FILTER))

REAL = 3.0 + 3.0 ** (2.0 / 3.0) - 3.0 ** (1.0 / 3.0)
ALPHA = 3.0 + 0.5 * (3.0 ** (1.0 / 3.0) - 3.0 ** (2.0 / 3.0))
BETA = 0.5 * (3.0 ** (5.0 / 6.0) + 3.0 ** (7.0 / 6.0))
"""Eigenvalues of the inverse of the method's matrix A: REAL, ALPHA +- i BETA."""
