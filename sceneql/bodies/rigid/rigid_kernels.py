# mypy: ignore-errors
"""How rigid bodies turn: the closing term, and the length of their quaternions."""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import AFTER_STEP, TERM, A, F, N

COUNT, ROTATION_AT, MOMENTUM_AT, INVERSE_AT, PRINCIPAL_AT = range(5)

LENGTHENED = 1e-5
"""Change of a quaternion's squared length from which it is 1 again at the end of a step: only its direction counts."""

THREE = types.UniTuple(F, 3)


@lean_inlined
def turned_back(a, b, c, d, x, y, z):
    """A vector of the world in the axes of the body with the quaternion a, b, c, d, of any length but 0."""
    s = 2.0 / (a * a + b * b + c * c + d * d)
    # v + s (q x (q x v) - w q x v): the rotation by the conjugate.
    px, py, pz = c * z - d * y, d * x - b * z, b * y - c * x
    ux, uy, uz = c * pz - d * py, d * px - b * pz, b * py - c * px
    return x + s * (ux - a * px), y + s * (uy - a * py), z + s * (uz - a * pz)


@lean(THREE(A, N, F, F, F))
def to_body(y, at, x, y_, z):
    """A vector of the world in the axes of the body whose quaternion stands at y[at:], of any length but 0."""
    return turned_back(y[at], y[at + 1], y[at + 2], y[at + 3], x, y_, z)


@lean(THREE(A, N, F, F, F))
def to_world(y, at, x, y_, z):
    """A vector of the axes of the body whose quaternion stands at y[at:], of any length but 0, in the world's."""
    return turned_back(y[at], -y[at + 1], -y[at + 2], -y[at + 3], x, y_, z)


@lean_inlined
def times_symmetric(floats, at, x, y, z):
    """A symmetric matrix, its xx, yy, zz, yz, xz, xy at floats[at:], times a vector."""
    xx, yy, zz = floats[at], floats[at + 1], floats[at + 2]
    yz, xz, xy = floats[at + 3], floats[at + 4], floats[at + 5]
    return xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z


@lean(THREE(A, A, N, N, N))
def body_spin(y, floats, rotation_at, momentum_at, inverse_at):
    """Angular velocity [rad/s] in the body's axes: the inverse inertia times the angular momentum."""
    x, y_, z = to_body(y, rotation_at, y[momentum_at], y[momentum_at + 1], y[momentum_at + 2])
    return times_symmetric(floats, inverse_at, x, y_, z)


@lean(TERM, inner=True)
def close(t, y, rate, floats, ints):
    """dq/dt = q (0, w) / 2, w being the angular velocity in the body's axes; a fixed body keeps its momentum."""
    for k in range(ints[COUNT]):
        q, momentum, inverse = ints[ROTATION_AT] + 4 * k, ints[MOMENTUM_AT] + 3 * k, ints[INVERSE_AT] + 6 * k
        a, b, c, d = y[q], y[q + 1], y[q + 2], y[q + 3]
        x, y_, z = turned_back(a, b, c, d, y[momentum], y[momentum + 1], y[momentum + 2])
        x, y_, z = times_symmetric(floats, inverse, 0.5 * x, 0.5 * y_, 0.5 * z)
        rate[q] -= b * x + c * y_ + d * z
        rate[q + 1] += a * x + c * z - d * y_
        rate[q + 2] += a * y_ + d * x - b * z
        rate[q + 3] += a * z + b * y_ - c * x
        if floats[inverse] == 0.0:
            rate[momentum] = rate[momentum + 1] = rate[momentum + 2] = 0.0


@lean(AFTER_STEP, inner=True)
def settle(t0, t1, y0, rate0, y1, floats, ints):
    """Quaternions of length 1: on every sample, and at the end of a step where they are off by more than LENGTHENED.

    The rotation is not changed by this, and its rate changes by the same factor.
    """
    changed = False
    for k in range(ints[COUNT]):
        q = ints[ROTATION_AT] + 4 * k
        square = y1[q] ** 2 + y1[q + 1] ** 2 + y1[q + 2] ** 2 + y1[q + 3] ** 2
        if t0 == t1 or abs(square - 1.0) > LENGTHENED:
            length = square**0.5
            for c in range(q, q + 4):
                y1[c] /= length
            changed = True
    return changed
