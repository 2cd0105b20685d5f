# mypy: ignore-errors
"""The potential of the barrier between skins, and within a stage that of friction."""

import math

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean
from sceneql.contacts.barrier import pairs_layout as layout
from sceneql.contacts.barrier.barrier_kernels import barrier, friction_potential
from sceneql.contacts.barrier.pair_weights_kernels import listed, stencil
from sceneql.contacts.barrier.pairs_kernels import known
from sceneql.contacts.barrier.skin_forces_kernels import sliding
from sceneql.system.signatures_kernels import ENERGY


@lean(ENERGY, inner=True)
def energy(t, y, floats, ints):
    """The energy [J]; a stage y = base + a f feels friction as the slope of a times its potential in velocities."""
    if not known(y, floats, ints):
        return math.inf
    slip, friction = floats[ints[layout.NUMBERS] + layout.SLIP], floats[ints[layout.FRICTION]]
    a, total = floats[channels.STAGE], 0.0
    for edges in (False, True):
        for m in range(listed(floats, ints, edges)):
            found = stencil(floats, ints, m, edges)
            if found[0] < math.inf:
                total += found[9] * found[8] * found[10] * barrier(found[0] / found[8])
    if friction > 0.0 and a > 0.0:
        for m in range(int(floats[ints[layout.MEMORY] + layout.LAGGED])):
            at = ints[layout.LAG_AT] + layout.LAG * m
            u, v, w = sliding(y, floats, ints, at)
            speed = math.sqrt(u * u + v * v + w * w)
            total += a * friction * floats[at + layout.LOAD] * friction_potential(speed, slip)
    return total
