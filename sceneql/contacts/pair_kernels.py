# mypy: ignore-errors
"""Queries of a body and of a pair that every contact kernel needs, and signatures of the lazily compiled kernels."""

from numba import types

from sceneql.compiled.kernels import lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.impact_kernels import scale_of
from sceneql.contacts.shape_kernels import surface
from sceneql.system.signatures_kernels import A, F, I, N

NEAR = 1e-9
"""Distance, relative to the coordinates, within which a free pair's normal acceleration is computed."""
FIRM = 1e3
"""Strength of a tie within a stage, as a multiple of that of inertia and springs in the linear systems."""

ANSWER = types.void(F, F, A, A, A, A, A, A, I)
"""(start and end of the step, state at both, bodies found, room for a path and its mean acceleration, floats, ints)."""
BRAKE = types.void(F, N, N, F, A, A, A, I)
"""(time, body, object, length of the step, state at its start and end, floats, ints)."""
KEEP = types.boolean(F, N, N, A, A, I)
"""(time, body, object, state, floats, ints): whether anything changed."""
HOLD = types.void(A, A, A, I)
"""(state, rate, floats, ints)."""
LONGEST = 1.0
"""Step [s] up to which ties are stiffer than springs where contacts act between steps and solvers need slopes."""
FIRMEST = 1e6
"""Least rate [1/s] at which such a tie damps the remaining normal velocity."""

OF_BODY = types.void(N, A, A, A, I)
"""(body, state, rate, floats, ints)."""
OF_PAIR = types.void(N, N, F, F, F, A, A, A, I)
"""(body, memory of the pair, normal, state, rate, floats, ints)."""
BACK_OFF_IN_STAGES = types.void(F, F, A, A, A, I)
"""(start and end of the step, state at both, floats, ints)."""
SUPPORT = types.void(N, A, A, A, I)
"""(first body whose free pairs are included; -1: resting pairs alone; state, rate, floats, ints)."""


@lean_inlined
def body_of(ints, k, y):
    """Place [m] and velocity [m/s] of body k."""
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
    """Whether the only object is a plane that never moves: then resting costs little."""
    return ints[layout.OBJECTS] == 1 and ints[layout.HEAD + layout.FLAT] != 0


@lean_inlined
def firmness(a, floats, ints):
    """Rate [1/s] at which ties act in a stage of coefficient a [s]; the springs' squared frequency follows the list."""
    return FIRM * (1.0 + a * a * floats[ints[layout.LAST] + layout.LIST + ints[layout.BODIES]]) / a


@lean_inlined
def tightness(floats, ints):
    """The rate [1/s] at which a tie damps normal velocity where contacts act between steps and solvers need slopes.

    For steps up to LONGEST it is far above the effect of springs, which the slopes of ties leave out.
    """
    return max(FIRMEST, FIRM * LONGEST * floats[ints[layout.LAST] + layout.LIST + ints[layout.BODIES]])
