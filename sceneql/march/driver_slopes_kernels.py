# mypy: ignore-errors
"""The Jacobian and the potential energy of any island, whose kernels stand in its integers (island/layout.py)."""

from sceneql.compiled.kernels import lean
from sceneql.compiled.numba.lazy_kernels import brought
from sceneql.compiled.pointers_kernels import AT_RATE, energy_at, rate_at
from sceneql.island import layout
from sceneql.island.jacobian_kernels import gather
from sceneql.island.varying_kernels import values_at
from sceneql.system import channels
from sceneql.system.signatures_kernels import ENERGY, JACOBIAN


@lean(JACOBIAN)
def jacobian(functions, t, y, values, floats, ints):
    """The slopes of all terms, or the positive ones of those that have them, and their sums as values."""
    values_at(t, y, floats, ints)
    at = ints[layout.SLOPES_AT]
    end = ints[at + layout.VALUES] + ints[at + layout.ENTRIES]
    if ints[at + layout.BORDERED] != 0:
        rate_at(functions[AT_RATE])(t, y, values[end : end + y.size], floats, ints)
    for k in range(ints[at + layout.VALUES]):
        values[k] = 0.0
    for g in range(ints[at + layout.KERNELS]):
        kernel = ints[at + layout.KERNELS_AT] + layout.CALLS * g
        if floats[channels.KEEPS] != 0.0 and ints[kernel + 1] != 0:
            continue
        positive = floats[channels.POSITIVE] != 0.0 and ints[kernel + 1] != 0
        slopes = rate_at(brought(ints[kernel + 1]) if positive else ints[kernel])
        for b in range(ints[at + layout.HEAD + g], ints[at + layout.HEAD + g + 1], 4):
            for k in range(ints[b + 2], ints[b + 3]):
                values[k] = 0.0
            slopes(t, y, values[ints[b + 2] : ints[b + 3]], floats, ints[ints[b] : ints[b + 1]])
    gather(t, y, values, floats, ints)


@lean(ENERGY)
def energy(t, y, floats, ints):
    """The sum of the terms' energies, from values as they are."""
    total = 0.0
    for g in range(ints[layout.TERMS], ints[layout.EXACT]):
        place = ints[ints[layout.CALLS_AT] + layout.CALLS * g + 1]
        if place != 0:
            of_term = energy_at(brought(place))
            for b in range(ints[layout.GROUPS_AT + g], ints[layout.GROUPS_AT + g + 1]):
                total += of_term(t, y, floats, ints[ints[b] : ints[b + 1]])
    return total
