# mypy: ignore-errors
"""Which bodies may touch a surface, for shapes without a kernel `near`, and which start inside: by `clear`."""

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.contacts import layout
from sceneql.contacts.impact_kernels import scale_of
from sceneql.contacts.shape_kernels import NEAR_TYPE, clear, clear_at, surface
from sceneql.system.signatures_kernels import A, F, I, N


@lean(NEAR_TYPE, inner=True)
def near(floats, ints, at, h, x0, v0, x1, v1, radii, more, found):
    """Test for each body a ball about the path's end that contains the path."""
    clear_of = clear_at(ints[at + layout.CLEAR])
    for k in range(radii.size):
        way = 0.0
        for c in range(3 * k, 3 * k + 3):
            # The largest component of the Bezier coefficients of the path's velocity.
            middle = 3.0 * (x1[c] - x0[c]) / h - v0[c] - v1[c]
            way += max(abs(middle), max(abs(v0[c]), abs(v1[c])))
        reach = h * way + radii[k] + more
        if found[k] == 0.0 and not clear_of(floats, ints, at, x1[3 * k], x1[3 * k + 1], x1[3 * k + 2], reach):
            found[k] = 1.0


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
