# mypy: ignore-errors
"""A symmetric matrix factored and a system with it solved in one walk of the fronts, for matrices larger than a cache.

For the plan see systems_kernels. A group of fronts is factored, and the first pass of the solution taken over it while
its factors are in the cache; the second pass may follow. The least pivot is found on the same walk.
"""

import numpy as np
from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.linear.multifrontal import layout
from sceneql.linear.multifrontal.forward_kernels import forward
from sceneql.linear.multifrontal.solve_kernels import solve_down, solve_symmetric, solve_up
from sceneql.linear.multifrontal.symmetric_kernels import factor_fronts, factor_symmetric
from sceneql.system.signatures_kernels import A, F, I

GROUP = 64
"""Fronts that are walked together: of fewer the code in turn costs more than what the caches keep saves."""

FACTOR_UP = F(I, A, A, A, A, A)
SOLVE_AGAIN = types.void(I, A, A, A, types.boolean)


@lean_inlined
def most_of_inverse(plan, factors, diagonal, begin, end):
    """The largest part diagonal / pivot of the fronts begin..end; infinite where a pivot is not above 0."""
    most, order = 1.0, plan[2]
    for s in range(begin, end):
        t = layout.HEAD + layout.FIELDS * s
        first, width, height, panel = plan[t], plan[t + 1], plan[t + 2], plan[t + 5]
        for k in range(width):
            inverse = factors[panel + k * (height + 1)]
            most = max(most, inverse * diagonal[plan[order + first + k]] if inverse > 0.0 else np.inf)
    return most


@lean(FACTOR_UP, inner=True)
def factor_up(plan, values, factors, work, diagonal, b):
    """Factor, and take the first pass of the solution for b, which stays: the least part of its diagonal that a pivot
    is, 0 where one is not above 0, -1 where one is 0 or not finite. ``work``: twice the plan's."""
    n, half, most, done = plan[0], work.size // 2, 1.0, 0
    x, carried = work[half : half + n], work[half + n :]
    if plan[layout.PIECES] > 0:
        if not factor_symmetric(plan, values, factors, work):
            return -1.0
        solve_up(plan, factors, b, x, carried)
        return 1.0 / most_of_inverse(plan, factors, diagonal, 0, plan[1])
    for k in range(n):
        x[k] = b[plan[plan[2] + k]]
    while done < plan[1]:
        end = min(done + GROUP, plan[1])
        if not factor_fronts(plan, values, factors, work, done, end):
            return -1.0
        most = max(most, most_of_inverse(plan, factors, diagonal, done, end))
        forward(plan, factors, x, carried, done, end)
        done = end
    return 1.0 / most


@lean(SOLVE_AGAIN, inner=True)
def solve_after(plan, factors, b, work, begun):
    """Solve for b, in place: by the second pass alone where `factor_up` took the first for it just now."""
    own = work[work.size // 2 :]
    if begun:
        solve_down(plan, factors, b, own[: plan[0]], own[plan[0] :])
    else:
        solve_symmetric(plan, factors, b, own)
