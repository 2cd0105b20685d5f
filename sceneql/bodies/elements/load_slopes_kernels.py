# mypy: ignore-errors
"""The derivatives of forces on the surface of a solid. Behind the term's integers: whether each component of each node
is held."""

from sceneql.bodies.elements.load_kernels import (
    EACH,
    OF_PLACES,
    PLACES,
    SHAPES_AT,
    SHARES_AT,
    SLOPES_AT,
    VALUE_AT,
    along,
)
from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM


@lean(TERM, inner=True)
def pressure(t, y, entries, floats, ints):
    """Of each place the blocks of pairs of its face's nodes (place, node, node, 3, 3); held components' rows are 0."""
    each = ints[EACH]
    held = OF_PLACES + each * ints[PLACES]
    for q in range(ints[PLACES]):
        p = -floats[ints[VALUE_AT]] * floats[ints[SHARES_AT] + q]
        ax, ay, az = along(y, floats, ints, q, 0, 0), along(y, floats, ints, q, 0, 1), along(y, floats, ints, q, 0, 2)
        bx, by, bz = along(y, floats, ints, q, 1, 0), along(y, floats, ints, q, 1, 1), along(y, floats, ints, q, 1, 2)
        for n in range(each):
            slopes = ints[SLOPES_AT] + 2 * (each * q + n)
            # d(a x b) by the node's place: cross(a' b - b' a), the matrix of a cross product.
            one, two = p * floats[slopes], p * floats[slopes + 1]
            x, y_, z = one * bx - two * ax, one * by - two * ay, one * bz - two * az
            for m in range(each):
                share, at = floats[ints[SHAPES_AT] + each * q + m], 9 * (each * (each * q + m) + n)
                for k in range(9):
                    entries[at + k] = 0.0
                entries[at + 1] += share * z
                entries[at + 2] -= share * y_
                entries[at + 3] -= share * z
                entries[at + 5] += share * x
                entries[at + 6] += share * y_
                entries[at + 7] -= share * x
                node = held + 3 * ints[OF_PLACES + each * q + m]
                for k in range(9):
                    if ints[node + k // 3] == 1:
                        entries[at + k] = 0.0
