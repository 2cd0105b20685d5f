# mypy: ignore-errors
"""Solutions with the factors of symmetric matrices, front by front, on several threads.

For the plan see systems_kernels; A = U^T D^-1 U, with the reciprocals of D on U's diagonal. The updates
of a front to the unknowns above it pass from child to parent, as in the factorization, so that subtrees are
independent and results do not depend on the threads. Four rows of U at a time are read once, as fast as
memory gives them.
"""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.threads_kernels import over_threads
from sceneql.linear.multifrontal import layout
from sceneql.linear.multifrontal.backward_kernels import backward
from sceneql.linear.multifrontal.forward_kernels import forward
from sceneql.system.signatures_kernels import A, I

WORTH_THREADS = 500_000
"""Numbers of the factors from which on threads share the fronts."""

SOLVE = types.void(I, A, A, A)


@lean_inlined
def solve_up(plan, factors, b, x, carried):
    """The first pass of `solve_symmetric`, to x (n,) in the order of elimination."""
    fronts, order, pieces = plan[1], plan[2], plan[layout.PIECES]
    entry = plan[layout.ENTRY] if plan[layout.HEAD + layout.FIELDS * fronts + 5] >= WORTH_THREADS else 0
    for k in range(x.size):
        x[k] = b[plan[order + k]]
    if pieces > 0:
        over_threads(entry, plan[layout.THREADS], plan[layout.FORWARD], pieces, 0.0, factors, x, carried, plan)
    done = 0
    for at in range(plan[layout.PIECES_AT], plan[layout.PIECES_AT] + 3 * pieces, 3):
        forward(plan, factors, x, carried, done, plan[at])
        done = plan[at + 1]
    forward(plan, factors, x, carried, done, fronts)


@lean_inlined
def solve_down(plan, factors, b, x, carried):
    """The second pass of `solve_symmetric`, from what the first left."""
    last, order, pieces = plan[1], plan[2], plan[layout.PIECES]
    entry = plan[layout.ENTRY] if plan[layout.HEAD + layout.FIELDS * last + 5] >= WORTH_THREADS else 0
    for at in range(plan[layout.PIECES_AT] + 3 * (pieces - 1), plan[layout.PIECES_AT] - 3, -3):
        backward(plan, factors, x, carried, plan[at + 1], last)
        last = plan[at]
    backward(plan, factors, x, carried, 0, last)
    if pieces > 0:
        over_threads(entry, plan[layout.THREADS], plan[layout.BACKWARD], pieces, 0.0, factors, x, carried, plan)
    for k in range(x.size):
        b[plan[order + k]] = x[k]


@lean(SOLVE, inner=True)
def solve_symmetric(plan, factors, b, work):
    """Solve as systems_kernels.solve_system does."""
    x, carried = work[: plan[0]], work[plan[0] :]
    solve_up(plan, factors, b, x, carried)
    solve_down(plan, factors, b, x, carried)
