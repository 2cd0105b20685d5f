# mypy: ignore-errors
"""The direction and the derivative of smooth friction, as kernels see them."""

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.contacts.barrier.friction_slopes_kernels import direction, foreseen, resistance
from sceneql.system.signatures_kernels import A, F

THREE, SIX = types.UniTuple(F, 3), types.UniTuple(F, 6)


@lean(THREE(A, F))
def direction_at(u, slip):
    """The direction of friction against a slip u (3,) [m/s]."""
    return direction(u[0], u[1], u[2], slip)


@lean(THREE(A, A, A, F))
def direction_after(p, u, x, slip):
    """The direction p (3,) after an update of the slip from u to x (3,) [m/s]."""
    return foreseen(p[0], p[1], p[2], u[0], u[1], u[2], x[0], x[1], x[2], slip)


@lean(SIX(A, A, A, F))
def derivative(normal, u, p, slip):
    """xx, xy, xz, yy, yz, zz of the derivative over the load [s/m]."""
    return resistance(normal[0], normal[1], normal[2], u[0], u[1], u[2], p[0], p[1], p[2], slip)
