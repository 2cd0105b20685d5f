# mypy: ignore-errors
"""What contacts remember in the floats: of their pairs, and in `local` mode of the step and of those that rest.

A pair is (body k, object j), numbered k * objects + j. Its memory in the floats: state, free normal acceleration, load
(normal force by mass), pull along the surface (force without friction by mass), direction of sliding (3), load at the
end of the step before (`local` mode; NaN where there was none), and within stages (stage_contacts_kernels) the
evaluations since it was tied and last pressed (0: not tied), and how often it was let go.
"""

from numba import types

from sceneql.compiled.kernels import lean_inlined
from sceneql.contacts.impulse_kernels import BODIES, LAST
from sceneql.system.signatures_kernels import A, F, I, N

PRESS, LOAD, PULL, ALONG, EARLIER = 1, 2, 3, 4, 7
TIED, LET_GO = 8, 9
SLACK = 8
"""Where ties last whole steps (channels.BETWEEN), in TIED's place: by how much the pull along the surface could have
been larger at the end of the step before [m/s^2], NaN where nothing stuck."""
PAIR = 10
FREE, SLIDES, STICKS, CREEPS = 0.0, 1.0, 2.0, 3.0
"""CREEPS, in `local` mode: slides, but so slowly that friction is left to the end of the step (slide_kernels)."""

END, WHOLE, CUTS = range(3)
"""Memory of a contact in `local` mode: end and length of the step before it was cut, how often it was; then RESTING."""
RESTING, LIST = 3, 4
"""In `local` mode, the places in the contact's memory of the number of resting bodies, and of their
numbers: most bodies fly, and the others are found without looking at all."""


FIRM = 1e3
"""How much more than inertia and springs a tie holds within a stage, as the linear systems see it."""

PATH = 13
"""Floats of a path (body_path_kernels)."""

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
    return FIRM * (1.0 + a * a * floats[ints[LAST] + LIST + ints[BODIES]]) / a


@lean_inlined
def tightness(floats, ints):
    """The rate [1/s] at which a tie takes away normal velocity where slopes are asked for between steps.

    For steps up to LONGEST it is far above what springs could do against it, which slopes leave out.
    """
    return max(FIRMEST, FIRM * LONGEST * floats[ints[LAST] + LIST + ints[BODIES]])
