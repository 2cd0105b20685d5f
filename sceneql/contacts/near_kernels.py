# mypy: ignore-errors
"""Which bodies may touch a surface, for shapes without a kernel `near`: by their kernel `clear`."""

from sceneql.compiled.kernels import lean
from sceneql.contacts import layout
from sceneql.contacts.shape_kernels import NEAR_TYPE, clear_at


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
