# mypy: ignore-errors
"""Contacts in `local` mode: every body has its impacts within the step, and flies on for the rest of it.

This file finds the bodies that may touch a surface. Impacts are in respond_kernels and rest in resting_kernels and
support_kernels, which are compiled when the first body comes near enough.
"""

import numpy as np
from numba import types

import sceneql.system.channels as channels
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts import layout
from sceneql.contacts.body_path_kernels import MEAN
from sceneql.contacts.impact_kernels import MOST_CUTS
from sceneql.contacts.pair_kernels import ANSWER, BACK_OFF_IN_STAGES, HOLD, SUPPORT
from sceneql.contacts.shape_kernels import near_at
from sceneql.system.signatures_kernels import BACK_OFF, TERM, A, F, I

cut = lazy("sceneql.contacts.respond_kernels:cut", ANSWER)
back_off_found = lazy("sceneql.contacts.respond_kernels:back_off_found", ANSWER)
support = lazy("sceneql.contacts.support_kernels:support", SUPPORT)
hold = lazy("sceneql.contacts.stage_contacts_kernels:hold", HOLD)
back_off_in_stages = lazy("sceneql.contacts.back_off_in_stages_kernels:back_off_in_stages", BACK_OFF_IN_STAGES)

LAZY_FIRST = (
    "sceneql.contacts.resting_kernels",
    "sceneql.contacts.slide_kernels",
    "sceneql.contacts.support_kernels",
    "sceneql.contacts.search_kernels",
)
"""Lazily compiled modules with which a background process begins (driver.lazy_first)."""


@lean(types.void(F, A, A, A, A, I), inner=True)
def find_near(h, y0, y1, found, floats, ints):
    """Set found[k], 0 before, to 1 for bodies that rest or may touch a surface in the step; cheap for all others."""
    n = ints[layout.BODIES]
    at, to = ints[layout.POSITION], ints[layout.VELOCITY]
    x0, v0, x1, v1 = y0[at : at + 3 * n], y0[to : to + 3 * n], y1[at : at + 3 * n], y1[to : to + 3 * n]
    radii = floats[ints[layout.RADIUS] : ints[layout.RADIUS] + n]
    for j in range(ints[layout.OBJECTS]):
        place = layout.HEAD + layout.OBJECT * j
        if ints[place + layout.MOVING] != 0:
            for k in range(n):
                found[k] = 1.0
        else:
            near = near_at(ints[place + layout.NEAR])
            near(floats, ints, place, h, x0, v0, x1, v1, radii, floats[ints[layout.THICKNESS]], found)
    memory = ints[layout.LAST]
    for i in range(int(floats[memory + layout.RESTING])):
        found[int(floats[memory + layout.LIST + i])] = 1.0
    for k in range(n):
        if floats[ints[layout.INVERSE] + k] == 0.0:
            found[k] = 0.0
            for j in range(ints[layout.OBJECTS]):
                floats[ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)] = layout.FREE


@lean_inlined
def may_be_cut(t0, t1, floats, ints):
    """Whether the step may be cut once more; records the step where it is a new one."""
    memory = ints[layout.LAST]
    if t1 > floats[memory + layout.END]:
        floats[memory + layout.END], floats[memory + layout.WHOLE], floats[memory + layout.CUTS] = t1, t1 - t0, 0.0
    return floats[memory + layout.CUTS] < MOST_CUTS


@lean_inlined
def some(found):
    """Whether any body was found."""
    for k in range(found.size):
        if found[k] != 0.0:
            return True
    return False


@kernel(BACK_OFF, inner=True)
def back_off(t0, t1, y0, rate0, y1, floats, ints):
    """Resolve impacts of the step from t0 to t1 in y1; while STEP_END is above 0, only lower it to cut the step."""
    asked = floats[channels.STEP_END] > 0.0
    if floats[channels.STAGE] == channels.OUTSIDE:
        if not asked:
            back_off_in_stages(t0, t1, y0, y1, floats, ints)
        return
    if asked and not may_be_cut(t0, t1, floats, ints):
        return
    found = np.zeros(ints[layout.BODIES])
    find_near(t1 - t0, y0, y1, found, floats, ints)
    if some(found):
        path = np.empty(layout.PATH)
        mean = np.empty(MEAN)
        if asked:
            cut(t0, t1, y0, y1, found, path, mean, floats, ints)
        else:
            back_off_found(t0, t1, y0, y1, found, path, mean, floats, ints)
    elif not asked:
        floats[ints[layout.LAST] + layout.RESTING] = 0.0


@lean(TERM, inner=True)
def constrain(t, y, rate, floats, ints):
    """Add normal and friction forces to the accelerations of bodies that rest; free pairs cost nothing."""
    if floats[ints[layout.LAST] + layout.RESTING] > 0.0:
        if floats[channels.STAGE] > 0.0:
            hold(y, rate, floats, ints)
        else:
            support(-1, y, rate, floats, ints)
