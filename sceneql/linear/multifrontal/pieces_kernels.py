# mypy: ignore-errors
"""Pieces of a plan (systems_kernels): the subtrees of fronts that threads share where operations are many."""

from sceneql.compiled.kernels import kernel
from sceneql.compiled.threads_kernels import TILE
from sceneql.linear.multifrontal import layout
from sceneql.linear.multifrontal.backward_kernels import backward
from sceneql.linear.multifrontal.forward_kernels import forward
from sceneql.linear.multifrontal.symmetric_kernels import factor_fronts


@kernel(TILE)
def piece(number, t, values, factors, work, plan):
    """Factor the fronts of a piece; its third integer is set where all pivots were regular."""
    at = plan[layout.PIECES_AT] + 3 * number
    plan[at + 2] = 1 if factor_fronts(plan, values, factors, work, plan[at], plan[at + 1]) else 0


@kernel(TILE)
def forward_piece(number, t, factors, x, carried, plan):
    """The first pass over a piece."""
    at = plan[layout.PIECES_AT] + 3 * number
    forward(plan, factors, x, carried, plan[at], plan[at + 1])


@kernel(TILE)
def backward_piece(number, t, factors, x, carried, plan):
    """The second pass over a piece."""
    at = plan[layout.PIECES_AT] + 3 * number
    backward(plan, factors, x, carried, plan[at], plan[at + 1])
