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


MEAN, TURNING, INVERSE, SCRATCH, SHARED = 0, 3, 6, 15, 33
"""Of a torque, whose integers are those of dead loads, what is found of its nodes, behind their weights: their mean
place (3,), a (3,), J^-1 (9,), working memory of slopes (18,), the sums s (count, 3); behind these G (count, count)."""


@lean_inlined
def turning(y, floats, ints):
    """Find the mean place of the nodes, a, J^-1 and the sums s of G by places from there; returns where they are."""
    weights, count, first = ints[WEIGHTS_AT], ints[COUNT], ints[POSITION_AT]
    to = weights + count
    total = 0.0
    for k in range(SCRATCH):
        floats[to + k] = 0.0
    for k in range(count):
        total += floats[weights + k]
        for c in range(3):
            floats[to + MEAN + c] += floats[weights + k] * y[first + 3 * ints[NODES + k] + c]
    for c in range(3):
        floats[to + MEAN + c] /= total
    shared, between = to + SHARED, to + SHARED + 3 * count
    xx = yy = zz = xy = xz = yz = 0.0
    for k in range(count):
        u = v = w = 0.0
        for n in range(count):
            g, at = floats[between + count * k + n], first + 3 * ints[NODES + n]
            u += g * (y[at] - floats[to])
            v += g * (y[at + 1] - floats[to + 1])
            w += g * (y[at + 2] - floats[to + 2])
        floats[shared + 3 * k], floats[shared + 3 * k + 1], floats[shared + 3 * k + 2] = u, v, w
        at = first + 3 * ints[NODES + k]
        x, y_, z = y[at] - floats[to], y[at + 1] - floats[to + 1], y[at + 2] - floats[to + 2]
        xx += y_ * v + z * w
        yy += x * u + z * w
        zz += x * u + y_ * v
        xy -= x * v
        xz -= x * w
        yz -= y_ * w
    a, b, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    size = xx * a + xy * b + xz * c
    found = floats[to + INVERSE : to + SCRATCH]
    found[0], found[1], found[2] = a / size, b / size, c / size
    found[3], found[4], found[5] = found[1], (xx * zz - xz * xz) / size, (xy * xz - xx * yz) / size
    found[6], found[7], found[8] = found[2], found[5], (xx * yy - xy * xy) / size
    for i in range(3):
        for k in range(3):
            floats[to + TURNING + i] += found[3 * i + k] * floats[ints[VALUE_AT] + k]
    return to


@lean(TERM, inner=True)
def torque(t, y, rate, floats, ints):
    """Adds the traction a x r, r from the mean place, by each node's function, and takes its power from the work.

    Its forces a x s, s_k = sum of G_kn r_n with the integrals G of products of functions at rest, have no sum. a =
    J^-1 M, with J = sum of (r.s 1 - s r), is such that their torque is M wherever the nodes are: a pair of pressures on
    two halves of a face has a sum as soon as these differ, whose torque over the length of a strip outweighs their own.
    A traction, not nodes' shares: that of a bent strip, which strains its end as its middle.
    """
    to = turning(y, floats, ints)
    a, b, c = floats[to + TURNING], floats[to + TURNING + 1], floats[to + TURNING + 2]
    for k in range(ints[COUNT]):
        s, at = to + SHARED + 3 * k, ints[VELOCITY_AT] + 3 * ints[NODES + k]
        x, y_, z = floats[s], floats[s + 1], floats[s + 2]
        one, two, three = b * z - c * y_, c * x - a * z, a * y_ - b * x
        rate[at] += one
        rate[at + 1] += two
        rate[at + 2] += three
        rate[ints[WORK_AT]] -= one * y[at] + two * y[at + 1] + three * y[at + 2]
