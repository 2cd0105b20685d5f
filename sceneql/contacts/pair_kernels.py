# mypy: ignore-errors
"""What contact kernels ask of a body and of a pair, before what rests or meets is compiled; the types of that."""

from numba import types

from sceneql.compiled.kernels import lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.impulse_kernels import scale_of
from sceneql.contacts.shape_kernels import surface
from sceneql.system.signatures_kernels import A, F, I, N

NEAR = 1e-9
"""Distance, as a part of the coordinates, within which a free pair's normal acceleration is worth knowing."""
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
def body_of(ints, k, y):
    """Place of body k, its velocity, and its reach's offset parts."""
    at = ints[layout.POSITION] + 3 * k
    to = ints[layout.VELOCITY] + 3 * k
    return y[at], y[at + 1], y[at + 2], y[to], y[to + 1], y[to + 2]


@lean_inlined
def away(k, j, y, floats, ints):
    """Whether a pair is too far apart for its normal acceleration to matter."""
    px, py, pz, _, _, _ = body_of(ints, k, y)
    gap = surface(floats, ints, layout.HEAD + layout.OBJECT * j, px, py, pz)[0]
    gap = gap - floats[ints[layout.RADIUS] + k] - floats[ints[layout.THICKNESS]]
    return gap > NEAR * scale_of(px, py, pz)


@lean_inlined
def is_flat(ints):
    """Whether a plane that never moves is all that the bodies can meet: then resting costs little."""
    return ints[layout.OBJECTS] == 1 and ints[layout.HEAD + layout.FLAT] != 0


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
