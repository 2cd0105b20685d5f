# mypy: ignore-errors
"""Whether a step of exact contacts has made or lost energy, as one too long for a rim about to lie flat does."""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import (
    AT_MASS,
    AT_V,
    AT_W,
    AT_X,
    MOVER,
    POSITION,
    ROTATION,
    put,
    times_inertia,
)
from sceneql.compiled.kernels import lean, lean_inlined
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
from sceneql.system import channels
from sceneql.system.signatures_kernels import A, F, I

ENERGY, POWER, MOST_POWER, LOSES, LOST, PULLS = range(MEMORY, MEMORY + 6)
ROOM, EACH = PULLS - MEMORY, 3
"""Behind the memory: kinetic energy and what all forces have taken [J], the power of the torques of all but contacts
and a bound of the power of all of these [W], at the start of the step; what those among them take that count it [W],
now and at the start; then the acceleration of each mover by all but contacts [m/s^2]."""
LITTLE, MORE, ROUNDING = 1e-5, 1e-3, 1e-12
"""Part of the kinetic energy that is an error of a step, and no more, of what is round, whose forces may grow without
bound, by fixed steps, and of what is not or of steps that a tolerance chooses; of the sums, that is rounding."""
CLOSED = 4e-6
"""Way that bodies may be shifted as gaps are closed, or fall too far from rest in a step, in parts of their size."""


@lean_inlined
def first_of(ints, m):
    """Whether a mover is the first of those that count their losses where it does, as bodies of one model do."""
    for other in range(m):
        if ints[ints[WORKS_AT] + other] == ints[ints[WORKS_AT] + m]:
            return False
    return True


@lean(types.void(A, A, I))
def keep_losses(rate, floats, ints):
    """Keep what all forces but contacts take of the movers, as drag does, before contacts add what they take."""
    lost = 0.0
    for m in range(ints[MOVERS]):
        work = ints[ints[WORKS_AT] + m]
        lost += rate[work] if work >= 0 and first_of(ints, m) else 0.0
    floats[ints[MEMORY_AT] + LOSES] = lost


@lean(types.UniTuple(F, 6)(A, A, I))
def accounts(y, floats, ints):
    """Of what is looked at: kinetic energy, what all forces have taken, the work of the other forces since the step
    began, the power of their torques, the error of that work, and a bound of the power of all of these [J, W]."""
    kinetic = taken = given = power = error = most = 0.0
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
        taken += y[work] if first_of(ints, m) else 0.0
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
        (x, y1, z), (u, v, w) = three(floats, pull), three(floats, mover + AT_V)
        most += math.sqrt((x * x + y1 * y1 + z * z) * (u * u + v * v + w * w)) / floats[mover + AT_MASS]
        if ints[at + ROTATION] >= 0:
            # (What turns the axes of a free body has no power.)
            turns = dot(*times_inertia(floats, mover, *three(floats, pull + 3)), *three(floats, mover + AT_W))
            power += turns
            most += abs(turns)
    return kinetic, taken, given, power, error, most


@lean(types.void(A, A, I))
def begin_account(y, floats, ints):
    """Keep what a step begins with; of what is looked at."""
    memory = ints[MEMORY_AT]
    kinetic, taken, _, floats[memory + POWER], _, floats[memory + MOST_POWER] = accounts(y, floats, ints)
    floats[memory + ENERGY], floats[memory + LOST] = kinetic + taken, floats[memory + LOSES]
    for m in range(ints[MOVERS]):
        put(floats, memory + PULLS + EACH * m, *three(floats, pull_at(ints, m)))


@lean(types.boolean(F, A, A, I))
def made_energy(t, y, floats, ints):
    """Whether bodies on contacts have more energy than all other forces can have given them since the step began.

    By fixed steps also whether they have another than these have given, where a tolerance chooses the steps it holds
    the energy. Those of ties are not known here: where there are any, no.
    """
    memory = ints[MEMORY_AT]
    if ints[TIE_ROWS] > 0 or ints[DRIVES] > 0 or floats[memory + KEPT] == 0.0:
        return False
    look(t, y, floats, ints)
    h, before = t - floats[memory + BEGUN], floats[memory + ENERGY]
    kinetic, taken, given, power, error, most = accounts(y, floats, ints)
    rounding = ROUNDING * (abs(taken) + abs(before))
    if floats[channels.FIXED] == 0.0:
        given = 2.0 * h * (most + floats[memory + MOST_POWER]) + MORE * kinetic + rounding
        return kinetic + taken - before > given
    # What other forces take is in what all have taken, and in their work.
    power, earlier = power + floats[memory + LOSES], floats[memory + POWER] + floats[memory + LOST]
    turned, change = 0.5 * h * (power + earlier), h * abs(power - earlier)
    curved = False
    for k in range(ints[BODIES]):
        curved = curved or is_curved(ints, ints[SHAPES_AT] + SHAPE * k)
    allowed = (LITTLE if curved else MORE) * kinetic + error + change + rounding
    return abs(kinetic + taken - before - given - turned) > allowed
