# mypy: ignore-errors
"""Forces on the surface of a solid."""

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import TERM

POSITION_AT, VELOCITY_AT, WORK_AT, VALUE_AT = range(4)
WEIGHTS_AT, COUNT, NODES = range(4, 7)
"""Of dead loads: offset of each node's area [m^2] or share, how many nodes, and these."""
SHAPES_AT, SLOPES_AT, SHARES_AT, PLACES, EACH, OF_PLACES = range(4, 10)
"""Of pressure: offsets of the functions (place, node) and of their derivatives (place, node, 2), of the places' shares;
how many places, nodes of a face, and from OF_PLACES on the nodes of each place's face."""


@lean(TERM, inner=True)
def dead(t, y, rate, floats, ints):
    """Adds a load that keeps its direction, and takes its power from the work."""
    for k in range(ints[COUNT]):
        weight, at = floats[ints[WEIGHTS_AT] + k], ints[VELOCITY_AT] + 3 * ints[NODES + k]
        for c in range(3):
            force = weight * floats[ints[VALUE_AT] + c]
            rate[at + c] += force
            rate[ints[WORK_AT]] -= force * y[at + c]


@lean_inlined
def along(y, floats, ints, place, which, c):
    """A component of the derivative of the place by a coordinate of its face."""
    total, each = 0.0, ints[EACH]
    first, slopes = OF_PLACES + each * place, ints[SLOPES_AT] + 2 * each * place
    for n in range(each):
        total += floats[slopes + 2 * n + which] * y[ints[POSITION_AT] + 3 * ints[first + n] + c]
    return total


@lean(TERM, inner=True)
def pressure(t, y, rate, floats, ints):
    """Adds -p n dA = -p (dx/da x dx/db) da db to each node by its function."""
    each = ints[EACH]
    for q in range(ints[PLACES]):
        p = -floats[ints[VALUE_AT]] * floats[ints[SHARES_AT] + q]
        ax, ay, az = along(y, floats, ints, q, 0, 0), along(y, floats, ints, q, 0, 1), along(y, floats, ints, q, 0, 2)
        bx, by, bz = along(y, floats, ints, q, 1, 0), along(y, floats, ints, q, 1, 1), along(y, floats, ints, q, 1, 2)
        x, y_, z = p * (ay * bz - az * by), p * (az * bx - ax * bz), p * (ax * by - ay * bx)
        for n in range(each):
            share, at = floats[ints[SHAPES_AT] + each * q + n], ints[VELOCITY_AT] + 3 * ints[OF_PLACES + each * q + n]
            rate[at] += share * x
            rate[at + 1] += share * y_
            rate[at + 2] += share * z
            rate[ints[WORK_AT]] -= share * (x * y[at] + y_ * y[at + 1] + z * y[at + 2])
