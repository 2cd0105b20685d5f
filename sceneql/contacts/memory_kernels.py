# mypy: ignore-errors
"""How firm ties are, and the types of the kernels of contacts that are compiled late."""

from numba import types

from sceneql.compiled.kernels import lean_inlined
from sceneql.contacts import layout
from sceneql.system.signatures_kernels import A, F, I, N

FIRM = 1e3
"""How much more than inertia and springs a tie holds within a stage, as the linear systems see it."""

ANSWER = types.void(F, F, A, A, A, A, A, A, I)
"""(start and end of the step, state at both, bodies found, room for a path and its mean acceleration, floats, ints)."""
BRAKE = types.void(F, N, N, F, A, A, A, I)
"""(time, body, object, length of the step, state at its start and end, floats, ints)."""
KEEP = types.boolean(F, N, N, A, A, I)
"""(time, body, object, state, floats, ints): whether anything changed."""
HOLD = types.void(A, A, A, I)
"""(state, rate, floats, ints)."""
LONGEST = 1.0
"""Step [s] up to which ties are firmer than springs where slopes are asked for between steps."""
FIRMEST = 1e6
"""Least rate [1/s] at which a tie takes away what normal velocity is left, where slopes are asked for between steps."""

OF_BODY = types.void(N, A, A, A, I)
"""(body, state, rate, floats, ints)."""
OF_PAIR = types.void(N, N, F, F, F, A, A, A, I)
"""(body, memory of the pair, normal, state, rate, floats, ints)."""
BACK_OFF_IN_STAGES = types.void(F, F, A, A, A, I)
"""(start and end of the step, state at both, floats, ints)."""
SUPPORT = types.void(N, A, A, A, I)
"""(first body whose free pairs are looked at; -1: those that rest alone; state, rate, floats, ints)."""


@lean_inlined
def firmness(a, floats, ints):
    """How firm ties are in a stage of coefficient a [1/s]; the square of the springs' frequency follows the list."""
    return FIRM * (1.0 + a * a * floats[ints[layout.LAST] + layout.LIST + ints[layout.BODIES]]) / a


@lean_inlined
def tightness(floats, ints):
    """The rate [1/s] at which a tie takes away normal velocity where slopes are asked for between steps.

    For steps up to LONGEST it is far above what springs could do against it, which slopes leave out.
    """
    return max(FIRMEST, FIRM * LONGEST * floats[ints[layout.LAST] + layout.LIST + ints[layout.BODIES]])
