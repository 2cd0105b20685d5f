# mypy: ignore-errors
"""The potential of forces on the surface of a solid that keep their direction."""

from sceneql.bodies.elements.load_kernels import COUNT, NODES, POSITION_AT, VALUE_AT, WEIGHTS_AT
from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import ENERGY


@lean(ENERGY, inner=True)
def dead(t, y, floats, ints):
    """Minus the sum of force times place [J]."""
    total = 0.0
    for k in range(ints[COUNT]):
        at, weight = ints[POSITION_AT] + 3 * ints[NODES + k], floats[ints[WEIGHTS_AT] + k]
        for c in range(3):
            total -= weight * floats[ints[VALUE_AT] + c] * y[at + c]
    return total
