# mypy: ignore-errors
"""The slopes of local contacts within a stage of Newton's method (hold_kernels)."""

from sceneql.kernels import lean, lean_inlined
from sceneql.simulation.contacts.impulse_kernels import HEAD, INVERSE, LAST, MASS, OBJECTS, PAIRS, POSITION
from sceneql.simulation.contacts.memory_kernels import (
    ALONG,
    LIST,
    PAIR,
    PULL,
    RESTING,
    STAGE,
    TIED,
    firmness,
)
from sceneql.simulation.contacts.shape_kernels import OBJECT, surface
from sceneql.system_kernels import TERM


@lean_inlined
def add_square(entries, at, factor, x, y, z):
    """Add factor times v v to the block, v = (x, y, z)."""
    entries[at] += factor * x * x
    entries[at + 1] += factor * x * y
    entries[at + 2] += factor * x * z
    entries[at + 3] += factor * y * x
    entries[at + 4] += factor * y * y
    entries[at + 5] += factor * y * z
    entries[at + 6] += factor * z * x
    entries[at + 7] += factor * z * y
    entries[at + 8] += factor * z * z


@lean(TERM, inner=True)
def holds(t, y, entries, floats, ints):
    """Of body k, the block by its own velocity from 9 k on: ties, as firm as `hold` has left them in the memory."""
    if floats[STAGE] <= 0.0:
        return
    firm = firmness(floats[STAGE], floats, ints)
    for i in range(int(floats[ints[LAST] + RESTING])):
        k = int(floats[ints[LAST] + LIST + i])
        if floats[ints[INVERSE] + k] == 0.0:
            continue
        at, mass = ints[POSITION] + 3 * k, floats[ints[MASS] + k]
        for j in range(ints[OBJECTS]):
            memory = ints[PAIRS] + PAIR * (k * ints[OBJECTS] + j)
            if floats[memory + TIED] == 0.0:
                continue
            body = HEAD + OBJECT * j
            _, nx, ny, nz = surface(floats, ints, body, y[at], y[at + 1], y[at + 2])
            # Across the slip, or both ways where the mass sticks.
            across = mass * floats[memory + PULL]
            add_square(entries, 9 * k, across - mass * firm, nx, ny, nz)
            add_square(
                entries, 9 * k, across, floats[memory + ALONG], floats[memory + ALONG + 1], floats[memory + ALONG + 2]
            )
            for c in range(0, 9, 4):
                entries[9 * k + c] -= across
