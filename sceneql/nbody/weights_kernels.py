# mypy: ignore-errors
"""The weights of the bodies, for direct sums and the tree."""

from sceneql.compiled.kernels import inlined
from sceneql.nbody import layout

FLOOR = 1e-160
"""[m^2] added to squared distances, so that a body's force on itself is finite."""


@inlined
def weights(floats, ints, at, out):
    """Write the weights of all bodies to floats[out:]; 0 for bodies without mass (not yet born, or dead)."""
    after = at + layout.ROWS + layout.MODEL * ints[at + layout.MODELS]
    for model in range(ints[at + layout.MODELS]):
        row = at + layout.ROWS + layout.MODEL * model
        weight_at, step = ints[after + 2 * model], ints[after + 2 * model + 1]
        for k in range(ints[row + layout.COUNT]):
            alive = floats[ints[row + layout.MASS_AT] + k] > 0.0
            floats[out + ints[row + layout.FIRST] + k] = floats[weight_at + step * k] if alive else 0.0
