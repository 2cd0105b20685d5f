# mypy: ignore-errors
"""The masses of several models as one: their places gathered, forces handed back."""

import math

from sceneql.compiled.kernels import inlined

MODEL = 5


@inlined
def gather(y, floats, ints, at, out):
    """Write the places of all masses to floats[out:], all x, then all y, then all z; ints[at:] as `together.layout`."""
    n = ints[at]
    for model in range(ints[at + 1]):
        row = at + 2 + MODEL * model
        position_at, first = ints[row], ints[row + 3]
        for k in range(ints[row + 2]):
            for c in range(3):
                floats[out + c * n + first + k] = y[position_at + 3 * k + c]


@inlined
def leave_out_massless(floats, ints, at, out):
    """Put what has no mass (not yet born, or dead) nowhere: its x becomes NaN."""
    for model in range(ints[at + 1]):
        row = at + 2 + MODEL * model
        for k in range(ints[row + 2]):
            if floats[ints[row + 4] + k] == 0.0:
                floats[out + ints[row + 3] + k] = math.nan


@inlined
def velocity_of(k, ints, at):
    """Offset in y of the velocity of mass k of all."""
    row = at + 2
    while k >= ints[row + 3] + ints[row + 2]:
        row += MODEL
    return ints[row + 1] + 3 * (k - ints[row + 3])
