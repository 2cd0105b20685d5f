# mypy: ignore-errors
"""Impulses of friction at places of rigid bodies (system.Place)."""

from numba import types

from sceneql.bodies.rigid.place_kernels import (
    ARM_AT,
    INERTIA_AT,
    INVERSE_AT,
    MOMENTUM_AT,
    VELOCITY_AT,
    WORK_AT,
    arm,
    velocity,
)
from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import A, F, I, N


@lean(types.void(A, A, I, N, F, F, F))
def strike(y, floats, ints, at, jx, jy, jz):
    """Change the velocity and the momentum of a body by an impulse [N s] at its place, and take its energy as work."""
    v, momentum = ints[at + VELOCITY_AT], ints[at + MOMENTUM_AT]
    ax, ay, az = velocity(y, floats, ints, at)
    rx, ry, rz = arm(y, floats, ints, at)
    inverse = floats[ints[at + INVERSE_AT]]
    if inverse == 0.0:
        return
    y[v] += inverse * jx
    y[v + 1] += inverse * jy
    y[v + 2] += inverse * jz
    y[momentum] += ry * jz - rz * jy
    y[momentum + 1] += rz * jx - rx * jz
    y[momentum + 2] += rx * jy - ry * jx
    bx, by, bz = velocity(y, floats, ints, at)
    y[ints[at + WORK_AT]] -= 0.5 * (jx * (ax + bx) + jy * (ay + by) + jz * (az + bz))


@lean(F(A, I, N))
def lightness(floats, ints, at):
    """A bound of the velocity that an impulse of 1 gives the place, in any direction [1/kg]."""
    k, inertia = ints[at + ARM_AT], ints[at + INERTIA_AT]
    square = floats[k] ** 2 + floats[k + 1] ** 2 + floats[k + 2] ** 2
    most = floats[inertia] + floats[inertia + 1] + floats[inertia + 2]
    return floats[ints[at + INVERSE_AT]] + square * most
