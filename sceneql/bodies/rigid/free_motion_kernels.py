# mypy: ignore-errors
"""The free motion of rigid bodies: each turns with its angular momentum as it would without torque."""

from sceneql.bodies.rigid.free_rotation_kernels import rotated
from sceneql.bodies.rigid.rigid_kernels import COUNT, MOMENTUM_AT, PRINCIPAL_AT, ROTATION_AT
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import FREE_MOTION


@lean_inlined
def product(a, b, c, d, e, f, g, h):
    """The product of two quaternions: the rotation by the second, then by the first."""
    return (
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g + c * e + d * f - b * h,
        a * h + d * e + b * g - c * f,
    )


@lean(FREE_MOTION, inner=True)
def turn(h, y, floats, ints):
    """Turns every body by its exact free rotation over h [s]."""
    for k in range(ints[COUNT]):
        q, momentum, at = ints[ROTATION_AT] + 4 * k, ints[MOMENTUM_AT] + 3 * k, ints[PRINCIPAL_AT] + 7 * k
        first, second, third = floats[at], floats[at + 1], floats[at + 2]
        x, y_, z = y[momentum], y[momentum + 1], y[momentum + 2]
        if first == 0.0 or (x == 0.0 and y_ == 0.0 and z == 0.0):
            continue
        pa, pb, pc, pd = floats[at + 3], floats[at + 4], floats[at + 5], floats[at + 6]
        length = (y[q] ** 2 + y[q + 1] ** 2 + y[q + 2] ** 2 + y[q + 3] ** 2) ** 0.5
        a, b, c, d = product(y[q] / length, y[q + 1] / length, y[q + 2] / length, y[q + 3] / length, pa, pb, pc, pd)
        a, b, c, d = rotated(a, b, c, d, x, y_, z, first, second, third, h)
        y[q], y[q + 1], y[q + 2], y[q + 3] = product(a, b, c, d, pa, -pb, -pc, -pd)
