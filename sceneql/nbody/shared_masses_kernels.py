# mypy: ignore-errors
"""The masses of several models as one list: gathering their places, and indices for their forces."""

import math

from sceneql.compiled.kernels import inlined
from sceneql.nbody import layout


@inlined
def gather(y, floats, ints, at, out):
    """Write the places of all masses to floats[out:], all x, then all y, then all z; ints[at:]: layout.MASSES."""
    n = ints[at + layout.MASSES]
    for model in range(ints[at + layout.MODELS]):
        row = at + layout.ROWS + layout.MODEL * model
        position_at, first = ints[row + layout.POSITION_AT], ints[row + layout.FIRST]
        for k in range(ints[row + layout.COUNT]):
            for c in range(3):
                floats[out + c * n + first + k] = y[position_at + 3 * k + c]


@inlined
def leave_out_massless(floats, ints, at, out):
    """Set x of bodies without mass (not yet born, or dead) to NaN, which takes them out of the forces."""
    for model in range(ints[at + layout.MODELS]):
        row = at + layout.ROWS + layout.MODEL * model
        for k in range(ints[row + layout.COUNT]):
            if floats[ints[row + layout.MASS_AT] + k] == 0.0:
                floats[out + ints[row + layout.FIRST] + k] = math.nan


@inlined
def velocity_of(k, ints, at):
    """Offset in y of the velocity of mass k of all."""
    row = at + layout.ROWS
    while k >= ints[row + layout.FIRST] + ints[row + layout.COUNT]:
        row += layout.MODEL
    return ints[row + layout.VELOCITY_AT] + 3 * (k - ints[row + layout.FIRST])
