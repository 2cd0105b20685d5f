# mypy: ignore-errors
"""Whether bodies start inside the objects that they may touch."""

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.contacts import layout
from sceneql.contacts.impact_kernels import scale_of
from sceneql.contacts.shape_kernels import clear, surface
from sceneql.system.signatures_kernels import A, F, I, N


@lean(types.Tuple((F, N, N))(A, A, I))
def deepest(y, floats, ints):
    """(depth of its center [m], body, object) of the body that is deepest inside an object; depth 0 for none."""
    depth, body, other = 0.0, -1, -1
    for k in range(ints[layout.BODIES]):
        if floats[ints[layout.INVERSE] + k] == 0.0:
            continue
        at = ints[layout.POSITION] + 3 * k
        x, y_, z = y[at], y[at + 1], y[at + 2]
        for j in range(ints[layout.OBJECTS]):
            if clear(floats, ints, layout.HEAD + layout.OBJECT * j, x, y_, z, 0.0):
                continue
            d = surface(floats, ints, layout.HEAD + layout.OBJECT * j, x, y_, z)[0]
            if -d > max(depth, 1e-9 * scale_of(x, y_, z)):
                depth, body, other = -d, k, j
    return depth, body, other
