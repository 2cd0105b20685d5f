# mypy: ignore-errors
"""The potential of a barrier between a skin and objects, and within a stage that of friction."""

import math

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean
from sceneql.contacts.barrier import objects_layout as layout
from sceneql.contacts.barrier.barrier_kernels import barrier, friction_potential
from sceneql.contacts.barrier.objects_kernels import distance, place, sliding
from sceneql.system.signatures_kernels import ENERGY


@lean(ENERGY, inner=True)
def energy(t, y, floats, ints):
    """The energy [J]; a stage y = base + a f feels friction as the slope of a times its potential in velocities."""
    numbers, objects = ints[layout.NUMBERS], ints[layout.OBJECTS]
    stiffness, gap = floats[numbers + layout.STIFFNESS], floats[numbers + layout.GAP]
    friction, slip, total = floats[ints[layout.FRICTION]], floats[numbers + layout.SLIP], 0.0
    a = floats[channels.STAGE]
    for p in range(ints[layout.NODES] + ints[layout.EDGES]):
        px, py, pz = place(y, floats, ints, p)
        for j in range(objects):
            d = distance(floats, ints, p, j, px, py, pz, gap)[0]
            if d < gap:
                total += floats[ints[layout.AREAS] + p] * stiffness * gap * barrier(d / gap)
            if friction > 0.0 and a > 0.0:
                at = ints[layout.LAGGED] + layout.LOADS + layout.LAG * (objects * p + j)
                if floats[at] > 0.0:
                    u, v, w = sliding(y, floats, ints, p, j, floats[at + 1], floats[at + 2], floats[at + 3])
                    speed = math.sqrt(u * u + v * v + w * w)
                    total += a * friction * floats[at] * friction_potential(speed, slip)
    return total
