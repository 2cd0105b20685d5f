# mypy: ignore-errors
"""A blow at an instant."""

from sceneql.bodies.rigid.place_kernels import INVERSE_AT, MOMENTUM_AT, PLACE, VELOCITY_AT, WORK_AT, arm, velocity
from sceneql.compiled.kernels import kernel
from sceneql.system.signatures_kernels import AFTER_STEP

VALUE_AT, TIME_AT = PLACE, PLACE + 1


@kernel(AFTER_STEP, inner=True)
def strike(t0, t1, y0, rate0, y1, floats, ints):
    """Changes velocity and angular momentum where the step has reached the blow's time; takes its energy as work."""
    inverse, time = floats[ints[INVERSE_AT]], floats[ints[TIME_AT]]
    if inverse == 0.0 or not t0 < time <= t1:
        return False
    k, v, momentum = ints[VALUE_AT], ints[VELOCITY_AT], ints[MOMENTUM_AT]
    jx, jy, jz = floats[k], floats[k + 1], floats[k + 2]
    ax, ay, az = velocity(y1, floats, ints, 0)
    y1[v] += inverse * jx
    y1[v + 1] += inverse * jy
    y1[v + 2] += inverse * jz
    if momentum >= 0:
        rx, ry, rz = arm(y1, floats, ints, 0)
        y1[momentum] += ry * jz - rz * jy
        y1[momentum + 1] += rz * jx - rx * jz
        y1[momentum + 2] += rx * jy - ry * jx
    bx, by, bz = velocity(y1, floats, ints, 0)
    y1[ints[WORK_AT]] -= 0.5 * (jx * (ax + bx) + jy * (ay + by) + jz * (az + bz))
    return True
