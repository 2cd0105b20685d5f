# mypy: ignore-errors
"""The derivatives of forces on the surface of a solid. Behind the term's integers: whether each component of each node
(of a torque: of its own nodes) is held."""

from sceneql.bodies.elements.load_kernels import (
    COUNT,
    EACH,
    FOUND,
    INVERSE,
    NODES,
    OF_PLACES,
    PLACES,
    POSITION_AT,
    SHAPES_AT,
    SHARES_AT,
    SLOPES_AT,
    TURNING,
    VALUE_AT,
    WEIGHTS_AT,
    along,
    turning,
)
from sceneql.compiled.kernels import lean, lean_inlined
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


@lean_inlined
def add_cross(v, factor, out):
    """Add factor times the matrix of v x to out (9,)."""
    out[1] -= factor * v[2]
    out[2] += factor * v[1]
    out[3] += factor * v[2]
    out[5] -= factor * v[0]
    out[6] -= factor * v[1]
    out[7] += factor * v[0]


@lean(TERM, inner=True)
def torque(t, y, entries, floats, ints):
    """Blocks of pairs of nodes (node, node, 3, 3): w_k ([r_k x] J^-1 B_l + [a x] (d_kl - w_l / W)), where B_l is the
    derivative of J a by the place of l, w_l (2 a r_l - (r_l . a) 1 - r_l a)."""
    to, count = turning(y, floats, ints), ints[COUNT]
    held, weights = NODES + count, ints[WEIGHTS_AT]
    a, inverse = floats[to + TURNING : to + INVERSE], floats[to + INVERSE : to + FOUND]
    scratch = floats[to + FOUND : to + FOUND + 18]
    turned, own = scratch[:9], scratch[9:]
    total = 0.0
    for k in range(count):
        total += floats[weights + k]
    for n in range(count):
        w, here = floats[weights + n], ints[POSITION_AT] + 3 * ints[NODES + n]
        x, y_, z = y[here] - floats[to], y[here + 1] - floats[to + 1], y[here + 2] - floats[to + 2]
        along = x * a[0] + y_ * a[1] + z * a[2]
        for i in range(3):
            own[3 * i] = w * (2.0 * a[i] * x - (x, y_, z)[i] * a[0])
            own[3 * i + 1] = w * (2.0 * a[i] * y_ - (x, y_, z)[i] * a[1])
            own[3 * i + 2] = w * (2.0 * a[i] * z - (x, y_, z)[i] * a[2])
            own[4 * i] -= w * along
        for i in range(3):
            for j in range(3):
                turned[3 * i + j] = (
                    inverse[3 * i] * own[j] + inverse[3 * i + 1] * own[3 + j] + inverse[3 * i + 2] * own[6 + j]
                )
        for m in range(count):
            at, mine = 9 * (count * m + n), ints[POSITION_AT] + 3 * ints[NODES + m]
            share, u, v, q = (
                floats[weights + m],
                y[mine] - floats[to],
                y[mine + 1] - floats[to + 1],
                y[mine + 2] - floats[to + 2],
            )
            out = entries[at : at + 9]
            for j in range(3):
                out[j] = share * (v * turned[6 + j] - q * turned[3 + j])
                out[3 + j] = share * (q * turned[j] - u * turned[6 + j])
                out[6 + j] = share * (u * turned[3 + j] - v * turned[j])
            add_cross(a, share * ((1.0 if m == n else 0.0) - w / total), out)
            for k in range(9):
                if ints[held + 3 * m + k // 3] == 1:
                    out[k] = 0.0
