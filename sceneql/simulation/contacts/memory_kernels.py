# mypy: ignore-errors
"""What contacts remember in the floats: of their pairs, and in `local` mode of the step and of those that rest.

A pair is (body k, object j), numbered k * objects + j. Its memory in the floats: state, free normal acceleration, load
(normal force by mass), pull along the surface (force without friction by mass), direction of sliding (3), load at the
end of the step before (`local` mode; NaN where there was none).
"""

from numba import types

from sceneql.system_kernels import A, F, I, N

PRESS, LOAD, PULL, ALONG, EARLIER = 1, 2, 3, 4, 7
PAIR = 8
FREE, SLIDES, STICKS, CREEPS = 0.0, 1.0, 2.0, 3.0
"""CREEPS, in `local` mode: slides, but so slowly that friction is left to the end of the step (slide_kernels)."""

END, WHOLE, CUTS = range(3)
"""Memory of a contact in `local` mode: end and length of the step before it was cut, how often it was; then RESTING."""
RESTING, LIST = 3, 4
"""In `local` mode, the places in the contact's memory of the number of resting bodies, and of their
numbers: most bodies fly, and the others are found without looking at all."""

PATH = 13
"""Floats of a path (path_kernels)."""
ASKED = 1
"""floats[1]: above 0 the march only asks when the step, planned up to that time, should end; else it settles, and
sets it to HOLDS where bodies rest: then the rate at the next step's end must be known (march_kernels)."""
HOLDS = -1.0

ANSWER = types.void(F, F, A, A, A, A, A, A, I)
"""(start and end of the step, state at both, bodies found, room for a path and its mean acceleration, floats, ints)."""
KEEP = types.boolean(F, N, N, A, A, I)
"""(time, body, object, state, floats, ints): whether anything changed."""
SUPPORT = types.void(N, A, A, A, I)
"""(first body whose free pairs are looked at; -1: those that rest alone; state, rate, floats, ints)."""
