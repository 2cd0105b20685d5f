# mypy: ignore-errors
"""What direct sums and the tree have in common: the first of their integers, and the weights of the bodies."""

from sceneql.compiled.kernels import inlined
from sceneql.nbody.shared_masses_kernels import MODEL

CONSTANT, SIGN, SOFTENING, POINTS, WEIGHTS, ROOM = range(6)
"""Places in ints: offsets of the constant c (taken with SIGN) and of the softening; room for 3 ROOM places and for ROOM
weights. The bodies come last, as together.layout, then for every model offset and step of its weights."""
FLOOR = 1e-160
"""[m^2] added to squared distances, so that a body does not meet itself at infinity."""


@inlined
def weights(floats, ints, at, out):
    """Write the weights of all bodies to floats[out:]; 0 for what has no mass (not yet born, or dead)."""
    after = at + 2 + MODEL * ints[at + 1]
    for model in range(ints[at + 1]):
        row = at + 2 + MODEL * model
        weight_at, step = ints[after + 2 * model], ints[after + 2 * model + 1]
        for k in range(ints[row + 2]):
            alive = floats[ints[row + 4] + k] > 0.0
            floats[out + ints[row + 3] + k] = floats[weight_at + step * k] if alive else 0.0
