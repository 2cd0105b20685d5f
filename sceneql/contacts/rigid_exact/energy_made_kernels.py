# mypy: ignore-errors
"""Whether a step of exact contacts has made or lost energy, as one too long for a rim about to lie flat does."""

import math

from numba import types

from sceneql.bodies.rigid.tie_rows_kernels import (
    AT_MASS,
    AT_W,
    AT_X,
    MOVER,
    POSITION,
    ROTATION,
    put,
    times_inertia,
)
from sceneql.compiled.kernels import lean
from sceneql.contacts.distance.convex import SHAPE
from sceneql.contacts.distance.core_kernels import FLOATS, REACH
from sceneql.contacts.rigid_exact.contact_kernels import dot, three
from sceneql.contacts.rigid_exact.curved_find_kernels import is_curved
from sceneql.contacts.rigid_exact.exact_rows_kernels import (
    BEGUN,
    BEGUN_AT,
    BODIES,
    DRIVES,
    KEPT,
    MEMORY,
    MEMORY_AT,
    MOVERS,
    MOVERS_AT,
    PLACE,
    SHAPES,
    SHAPES_AT,
    TIE_ROWS,
    WORKS_AT,
    energy,
    look,
    mover_at,
    pull_at,
)
from sceneql.system.signatures_kernels import A, F, I

ENERGY, POWER, PULLS, ROOM, EACH = MEMORY, MEMORY + 1, MEMORY + 2, 2, 3
"""Behind the memory: kinetic energy and what contacts have taken [J], the power of the torques of all other forces [W],
at the start of the step; then the acceleration of each mover by these [m/s^2]."""
LITTLE, MORE, ROUNDING = 1e-5, 1e-3, 1e-12
"""Part of the kinetic energy that is an error of a step, and no more, of what is round, whose forces may grow without
bound, and of what is not; of the sums, that is rounding."""
CLOSED = 4e-6
"""Way that bodies may be shifted as gaps are closed, or fall too far from rest in a step, in parts of their size."""


@lean(types.UniTuple(F, 5)(A, A, I))
def accounts(y, floats, ints):
    """Of what is looked at: kinetic energy, what contacts have taken, the work of the other forces since the step
    began, the power of their torques, and the error of that work [J, W]."""
    kinetic = taken = given = power = error = 0.0
    for m in range(ints[MOVERS]):
        at, mover, pull, work = (
            ints[MOVERS_AT] + MOVER * m,
            mover_at(ints, m),
            pull_at(ints, m),
            ints[ints[WORKS_AT] + m],
        )
        if work < 0 or ints[at + POSITION] < 0 or floats[mover + AT_MASS] == 0.0:
            continue
        kinetic += energy(y, floats, ints, m)
        counted = False  # (bodies of one model share what contacts have taken)
        for other in range(m):
            counted = counted or ints[ints[WORKS_AT] + other] == work
        taken += 0.0 if counted else y[work]
        before, begun = ints[MEMORY_AT] + PULLS + EACH * m, ints[BEGUN_AT] + PLACE * m
        way = square = size = 0.0
        for c in range(3):
            mean = 0.5 * (floats[before + c] + floats[pull + c])
            way += mean * (floats[mover + AT_X + c] - floats[begun + c] if m < ints[SHAPES] else 0.0)
            square += mean * mean
            size += abs(floats[mover + AT_X + c])
        given += way / floats[mover + AT_MASS]
        shape = ints[SHAPES_AT] + SHAPE * m
        reach = floats[ints[shape + FLOATS] + REACH] if m < ints[SHAPES] else size
        error += math.sqrt(square) * (CLOSED * reach + ROUNDING * size) / floats[mover + AT_MASS]
        if ints[at + ROTATION] >= 0:
            # (What turns the axes of a free body has no power.)
            power += dot(*times_inertia(floats, mover, *three(floats, pull + 3)), *three(floats, mover + AT_W))
    return kinetic, taken, given, power, error


@lean(types.void(A, A, I))
def begin_account(y, floats, ints):
    """Keep what a step begins with; of what is looked at."""
    memory = ints[MEMORY_AT]
    kinetic, taken, _, floats[memory + POWER], _ = accounts(y, floats, ints)
    floats[memory + ENERGY] = kinetic + taken
    for m in range(ints[MOVERS]):
        put(floats, memory + PULLS + EACH * m, *three(floats, pull_at(ints, m)))


@lean(types.boolean(F, A, A, I))
def made_energy(t, y, floats, ints):
    """Whether bodies on contacts have another energy than all other forces can have given them since the step began.

    Those of ties are not known here: where there are any, no.
    """
    memory = ints[MEMORY_AT]
    if ints[TIE_ROWS] > 0 or ints[DRIVES] > 0 or floats[memory + KEPT] == 0.0:
        return False
    look(t, y, floats, ints)
    h, before = t - floats[memory + BEGUN], floats[memory + ENERGY]
    kinetic, taken, given, power, error = accounts(y, floats, ints)
    turned, earlier = 0.5 * h * (power + floats[memory + POWER]), h * abs(power - floats[memory + POWER])
    curved = False
    for k in range(ints[BODIES]):
        curved = curved or is_curved(ints, ints[SHAPES_AT] + SHAPE * k)
    allowed = (LITTLE if curved else MORE) * kinetic + error + earlier + ROUNDING * (abs(taken) + abs(before))
    made = kinetic + taken - before - given - turned
    return made > allowed or (curved and made < -allowed)
