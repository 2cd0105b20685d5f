"""Expressions for vectors rotated by quaternions, and for the angular velocity of quaternions."""

from __future__ import annotations

from sceneql.quantities.dimension import LENGTH, PLAIN, TIME
from sceneql.quantities.expression import Call, Expr, Number, Type, Vector

PLACE = Type((3,), LENGTH)
AXIS = Type((3,))


def rotated(rotation: Expr, vector: Expr) -> Expr:
    """A vector v rotated by a unit quaternion [w, u]: v + 2 w (u x v) + 2 u x (u x v)."""
    w, *rest = (Call("component", (rotation, Number(float(k))), Type(())) for k in range(4))
    axis = Vector(tuple(rest), AXIS)
    across = Call("cross", (axis, vector), PLACE)
    half = Call("add", (Call("mul", (w, across), PLACE), Call("cross", (axis, across), PLACE)), PLACE)
    return Call("add", (vector, Call("mul", (Number(2.0), half), PLACE)), PLACE)


def spin(rotation: Expr, rate: Expr) -> Expr:
    """The angular velocity (3,) [1/s] of a unit quaternion q of the rate q': twice the vector of q' conj(q)."""
    one, plain = Type(()), Type((), PLAIN / TIME)
    w, *u = (Call("component", (rotation, Number(float(k))), one) for k in range(4))
    back = Vector((w, *(Call("neg", (c,), one) for c in u)), Type((4,)))
    whole = Call("turn", (rate, back), Type((4,), PLAIN / TIME))
    parts = (Call("component", (whole, Number(float(k))), plain) for k in (1, 2, 3))
    return Vector(tuple(Call("mul", (Number(2.0), c), plain) for c in parts), Type((3,), PLAIN / TIME))
