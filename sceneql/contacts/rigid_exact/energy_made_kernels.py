# mypy: ignore-errors
"""Whether a step of exact contacts has made energy, as steps do that are too long for what rolls round its rim."""

import math

from numba import types

from sceneql.bodies.rigid.tie_rows_kernels import AT_MASS, AT_V, AT_W, MOVER, POSITION, ROTATION, times_inertia
from sceneql.compiled.kernels import lean
from sceneql.contacts.rigid_exact.contact_kernels import dot, three
from sceneql.contacts.rigid_exact.exact_rows_kernels import (
    BEGUN,
    DRIVES,
    KEPT,
    MEMORY,
    MEMORY_AT,
    MOVERS,
    MOVERS_AT,
    TIE_ROWS,
    WORKS_AT,
    energy,
    look,
    mover_at,
    pull_at,
)
from sceneql.system.signatures_kernels import A, F, I

ENERGY, POWER, ROOM = MEMORY, MEMORY + 1, 2
"""Behind the memory: kinetic energy and what contacts have taken [J], and a bound of the power of all other forces
[W], at the start of the step."""
LITTLE, ROUNDING = 1e-3, 1e-12
"""Part of the kinetic energy that is an error of a step, and no more; of the sums, that is rounding."""


@lean(types.UniTuple(F, 3)(A, A, I))
def accounts(y, floats, ints):
    """Kinetic energy, what contacts have taken, and a bound of the power of the other forces, of what is looked at."""
    kinetic = taken = power = 0.0
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
        taken += y[work]
        (x, y1, z), (u, v, w) = three(floats, pull), three(floats, mover + AT_V)
        power += math.sqrt((x * x + y1 * y1 + z * z) * (u * u + v * v + w * w)) / floats[mover + AT_MASS]
        if ints[at + ROTATION] >= 0:
            # (What turns the axes of a free body has no power.)
            power += abs(dot(*times_inertia(floats, mover, *three(floats, pull + 3)), *three(floats, mover + AT_W)))
    return kinetic, taken, power


@lean(types.void(A, A, I))
def begin_account(y, floats, ints):
    """Keep what a step begins with; of what is looked at."""
    kinetic, taken, floats[ints[MEMORY_AT] + POWER] = accounts(y, floats, ints)
    floats[ints[MEMORY_AT] + ENERGY] = kinetic + taken


@lean(types.boolean(F, A, A, I))
def made_energy(t, y, floats, ints):
    """Whether bodies on contacts have more energy than all other forces can have given them since the step began.

    Those of ties are not known here: where there are any, no.
    """
    memory = ints[MEMORY_AT]
    if ints[TIE_ROWS] > 0 or ints[DRIVES] > 0 or floats[memory + KEPT] == 0.0:
        return False
    look(t, y, floats, ints)
    kinetic, taken, power = accounts(y, floats, ints)
    h, before = t - floats[memory + BEGUN], floats[memory + ENERGY]
    given = 2.0 * h * (power + floats[memory + POWER]) + LITTLE * kinetic + ROUNDING * (abs(taken) + abs(before))
    return kinetic + taken - before > given
