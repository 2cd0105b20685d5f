# mypy: ignore-errors
"""What contact kernels ask of a body and of a pair, before what rests or meets is compiled."""

from sceneql.compiled.kernels import lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.impulse_kernels import scale_of
from sceneql.contacts.shape_kernels import surface

NEAR = 1e-9
"""Distance, as a part of the coordinates, within which a free pair's normal acceleration is worth knowing."""


@lean_inlined
def body_of(ints, k, y):
    """Place of body k, its velocity, and its reach's offset parts."""
    at = ints[layout.POSITION] + 3 * k
    to = ints[layout.VELOCITY] + 3 * k
    return y[at], y[at + 1], y[at + 2], y[to], y[to + 1], y[to + 2]


@lean_inlined
def away(k, j, y, floats, ints):
    """Whether a pair is too far apart for its normal acceleration to matter."""
    px, py, pz, _, _, _ = body_of(ints, k, y)
    gap = surface(floats, ints, layout.HEAD + layout.OBJECT * j, px, py, pz)[0]
    gap = gap - floats[ints[layout.RADIUS] + k] - floats[ints[layout.THICKNESS]]
    return gap > NEAR * scale_of(px, py, pz)


@lean_inlined
def is_flat(ints):
    """Whether a plane that never moves is all that the bodies can meet: then resting costs little."""
    return ints[layout.OBJECTS] == 1 and ints[layout.HEAD + layout.FLAT] != 0
