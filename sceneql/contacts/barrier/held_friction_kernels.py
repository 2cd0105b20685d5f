# mypy: ignore-errors
"""Friction where an explicit method steps: what stays so through implicit ones is compiled apart."""

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.system.signatures_kernels import AFTER_STEP

objects = lazy("sceneql.contacts.barrier.objects_friction_kernels:rub", AFTER_STEP)
skins = lazy("sceneql.contacts.barrier.skins_friction_kernels:rub", AFTER_STEP)


@lean(AFTER_STEP, inner=True)
def rub_objects(t0, t1, y0, rate0, y1, floats, ints):
    """Friction on objects; nothing where a solver has slopes of the friction that is a force."""
    if floats[channels.STAGE] != channels.NO_SLOPES:
        return False
    return objects(t0, t1, y0, rate0, y1, floats, ints)


@lean(AFTER_STEP, inner=True)
def rub_skins(t0, t1, y0, rate0, y1, floats, ints):
    """Friction between skins likewise."""
    if floats[channels.STAGE] != channels.NO_SLOPES:
        return False
    return skins(t0, t1, y0, rate0, y1, floats, ints)
