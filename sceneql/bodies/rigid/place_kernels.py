# mypy: ignore-errors
"""A place where a force acts (system.Place): where it is, how fast it moves, and the force put on its body."""

from sceneql.bodies.rigid.rigid_kernels import THREE, body_spin, to_world
from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import A, F, I, N

POSITION_AT, VELOCITY_AT, WORK_AT, INVERSE_AT, ROTATION_AT, MOMENTUM_AT, INERTIA_AT, ARM_AT, PLACE = range(9)


@lean(THREE(A, A, I, N))
def arm(y, floats, ints, at):
    """From the center of mass to the place of ints[at:], in the world's axes [m]."""
    k = ints[at + ARM_AT]
    if k < 0:
        return 0.0, 0.0, 0.0
    return to_world(y, ints[at + ROTATION_AT], floats[k], floats[k + 1], floats[k + 2])


@lean(THREE(A, A, I, N))
def position(y, floats, ints, at):
    """Where the place of ints[at:] is [m]."""
    x, (rx, ry, rz) = ints[at + POSITION_AT], arm(y, floats, ints, at)
    return y[x] + rx, y[x + 1] + ry, y[x + 2] + rz


@lean(THREE(A, A, I, N))
def where(y, floats, ints, at):
    """As `position`; of ints[at:] that begin with -1 the floats from ints[at + 1] on."""
    if ints[at + POSITION_AT] < 0:
        k = ints[at + VELOCITY_AT]
        return floats[k], floats[k + 1], floats[k + 2]
    return position(y, floats, ints, at)


@lean(THREE(A, A, I, N))
def velocity(y, floats, ints, at):
    """How fast the place of ints[at:] moves [m/s]."""
    v = ints[at + VELOCITY_AT]
    if ints[at + ARM_AT] < 0:
        return y[v], y[v + 1], y[v + 2]
    q = ints[at + ROTATION_AT]
    rx, ry, rz = arm(y, floats, ints, at)
    wx, wy, wz = to_world(y, q, *body_spin(y, floats, q, ints[at + MOMENTUM_AT], ints[at + INERTIA_AT]))
    return y[v] + wy * rz - wz * ry, y[v + 1] + wz * rx - wx * rz, y[v + 2] + wx * ry - wy * rx


@lean(F(A, A, A, I, N, F, F, F))
def push(y, rate, floats, ints, at, fx, fy, fz):
    """Adds a force [N] at the place of ints[at:]; its power [W].

    The force goes to the velocity's entries of the rate, and its torque to the momentum's.
    """
    v, momentum = ints[at + VELOCITY_AT], ints[at + MOMENTUM_AT]
    rate[v] += fx
    rate[v + 1] += fy
    rate[v + 2] += fz
    if ints[at + ARM_AT] >= 0:
        rx, ry, rz = arm(y, floats, ints, at)
        rate[momentum] += ry * fz - rz * fy
        rate[momentum + 1] += rz * fx - rx * fz
        rate[momentum + 2] += rx * fy - ry * fx
    vx, vy, vz = velocity(y, floats, ints, at)
    return fx * vx + fy * vy + fz * vz


@lean(F(A, A, A, I, N, F, F, F))
def twist(y, rate, floats, ints, at, tx, ty, tz):
    """Adds a torque [N m] to the body of the place of ints[at:]; its power [W]."""
    q, momentum = ints[at + ROTATION_AT], ints[at + MOMENTUM_AT]
    rate[momentum] += tx
    rate[momentum + 1] += ty
    rate[momentum + 2] += tz
    wx, wy, wz = to_world(y, q, *body_spin(y, floats, q, momentum, ints[at + INERTIA_AT]))
    return tx * wx + ty * wy + tz * wz
