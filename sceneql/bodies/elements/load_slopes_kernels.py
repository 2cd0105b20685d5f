# mypy: ignore-errors
"""The derivatives of forces on the surface of a solid. Behind the term's integers: whether each component of each node
(of a torque: of its own nodes) is held."""

from sceneql.bodies.elements.load_kernels import (
    COUNT,
    EACH,
    INVERSE,
    NODES,
    OF_PLACES,
    PLACES,
    SCRATCH,
    SHAPES_AT,
    SHARED,
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
    """Blocks of pairs of nodes (node, node, 3, 3): [s_k x] J^-1 B_l + [a x] (G_kl - w_k w_l / W), where B_l is the
    derivative of J a by the place of l, 2 a s_l - (s_l . a) 1 - s_l a."""
    to, count = turning(y, floats, ints), ints[COUNT]
    held, weights, shared = NODES + count, ints[WEIGHTS_AT], to + SHARED
    between = shared + 3 * count
    a, inverse = floats[to + TURNING : to + INVERSE], floats[to + INVERSE : to + SCRATCH]
    scratch = floats[to + SCRATCH : to + SHARED]
    turned, own = scratch[:9], scratch[9:]
    total = 0.0
    for k in range(count):
        total += floats[weights + k]
    for n in range(count):
        s = floats[shared + 3 * n : shared + 3 * n + 3]
        along = s[0] * a[0] + s[1] * a[1] + s[2] * a[2]
        for i in range(3):
            for j in range(3):
                own[3 * i + j] = 2.0 * a[i] * s[j] - s[i] * a[j]
            own[4 * i] -= along
        for i in range(3):
            for j in range(3):
                turned[3 * i + j] = (
                    inverse[3 * i] * own[j] + inverse[3 * i + 1] * own[3 + j] + inverse[3 * i + 2] * own[6 + j]
                )
        for m in range(count):
            at, mine = 9 * (count * m + n), shared + 3 * m
            u, v, q = floats[mine], floats[mine + 1], floats[mine + 2]
            out = entries[at : at + 9]
            for j in range(3):
                out[j] = v * turned[6 + j] - q * turned[3 + j]
                out[3 + j] = q * turned[j] - u * turned[6 + j]
                out[6 + j] = u * turned[3 + j] - v * turned[j]
            pair = floats[between + count * m + n] - floats[weights + m] * floats[weights + n] / total
            add_cross(a, pair, out)
            for k in range(9):
                if ints[held + 3 * m + k // 3] == 1:
                    out[k] = 0.0
