# mypy: ignore-errors
"""The energy of the barrier between skins, to be called by tests."""

from sceneql.compiled.kernels import kernel
from sceneql.contacts.barrier.skins_energy_kernels import energy
from sceneql.system.signatures_kernels import ENERGY


@kernel(ENERGY)
def between_skins(t, y, floats, ints):
    """[J]."""
    return energy(t, y, floats, ints)
