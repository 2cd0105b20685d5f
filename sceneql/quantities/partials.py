"""Partial derivatives of the primitive operations, written over any arithmetic ``o``; one tuple entry an argument.

At a kink (``abs``, ``min``, ``max``) the derivative is that of one side; at a jump it is 0.
"""

from __future__ import annotations

import math
from typing import Any

from sceneql.quantities.noise import BY_X, BY_Y, BY_Z

Partials = tuple[Any, ...]


def add(o: Any, a: Any, b: Any) -> Partials:
    """1, 1."""
    return 1.0, 1.0


def sub(o: Any, a: Any, b: Any) -> Partials:
    """1, -1."""
    return 1.0, -1.0


def mul(o: Any, a: Any, b: Any) -> Partials:
    """b, a."""
    return b, a


def div(o: Any, a: Any, b: Any) -> Partials:
    """1/b, -a/b^2."""
    return o.div(1.0, b), o.neg(o.div(o.div(a, b), b))


def neg(o: Any, a: Any) -> Partials:
    """-1."""
    return (-1.0,)


def pow(o: Any, a: Any, b: Any) -> Partials:
    """b a^(b-1), a^b log a."""
    return o.mul(b, o.pow(a, o.sub(b, 1.0))), o.mul(o.pow(a, b), o.log(a))


def sqrt(o: Any, a: Any) -> Partials:
    """1/(2 sqrt a)."""
    return (o.div(0.5, o.sqrt(a)),)


def abs(o: Any, a: Any) -> Partials:
    """The sign of a."""
    return (o.sign(a),)


def min(o: Any, a: Any, b: Any) -> Partials:
    """1 for the smaller."""
    return o.where(o.le(a, b), 1.0, 0.0), o.where(o.le(a, b), 0.0, 1.0)


def max(o: Any, a: Any, b: Any) -> Partials:
    """1 for the larger."""
    return o.where(o.ge(a, b), 1.0, 0.0), o.where(o.ge(a, b), 0.0, 1.0)


def where(o: Any, condition: Any, a: Any, b: Any) -> Partials:
    """0 for the condition, 1 for the chosen branch."""
    return 0.0, o.where(condition, 1.0, 0.0), o.where(condition, 0.0, 1.0)


def sin(o: Any, a: Any) -> Partials:
    """The cosine."""
    return (o.cos(a),)


def cos(o: Any, a: Any) -> Partials:
    """Minus the sine."""
    return (o.neg(o.sin(a)),)


def tan(o: Any, a: Any) -> Partials:
    """1 + tan^2."""
    return (o.add(1.0, o.pow(o.tan(a), 2.0)),)


def asin(o: Any, a: Any) -> Partials:
    """1/sqrt(1 - a^2)."""
    return (o.div(1.0, o.sqrt(o.sub(1.0, o.mul(a, a)))),)


def acos(o: Any, a: Any) -> Partials:
    """-1/sqrt(1 - a^2)."""
    return (o.div(-1.0, o.sqrt(o.sub(1.0, o.mul(a, a)))),)


def atan(o: Any, a: Any) -> Partials:
    """1/(1 + a^2)."""
    return (o.div(1.0, o.add(1.0, o.mul(a, a))),)


def atan2(o: Any, y: Any, x: Any) -> Partials:
    """x/(x^2 + y^2), -y/(x^2 + y^2)."""
    square = o.add(o.mul(x, x), o.mul(y, y))
    return o.div(x, square), o.neg(o.div(y, square))


def hypot(o: Any, a: Any, b: Any) -> Partials:
    """a/h, b/h."""
    size = o.hypot(a, b)
    return o.div(a, size), o.div(b, size)


def sinh(o: Any, a: Any) -> Partials:
    """The hyperbolic cosine."""
    return (o.cosh(a),)


def cosh(o: Any, a: Any) -> Partials:
    """The hyperbolic sine."""
    return (o.sinh(a),)


def tanh(o: Any, a: Any) -> Partials:
    """1 - tanh^2."""
    return (o.sub(1.0, o.pow(o.tanh(a), 2.0)),)


def exp(o: Any, a: Any) -> Partials:
    """exp(a)."""
    return (o.exp(a),)


def log(o: Any, a: Any) -> Partials:
    """1/a."""
    return (o.div(1.0, a),)


def log10(o: Any, a: Any) -> Partials:
    """1/(a log 10)."""
    return (o.div(1.0 / math.log(10.0), a),)


def mod(o: Any, a: Any, b: Any) -> Partials:
    """1, -floor(a/b)."""
    return 1.0, o.neg(o.floor(o.div(a, b)))


def flat(o: Any, *args: Any) -> Partials:
    """0 for each: constant but for jumps."""
    return (0.0,) * len(args)


def noise_line(o: Any, x: Any, order: Any) -> Partials:
    """The noise of the next order; 0 for the order, which is part of the form."""
    return o.noise_line(x, o.add(order, BY_X)), 0.0


def noise_space(o: Any, x: Any, y: Any, z: Any, order: Any) -> Partials:
    """The noise of the next order along each axis; 0 for the order, which is part of the form."""
    return *(o.noise_space(x, y, z, o.add(order, by)) for by in (BY_X, BY_Y, BY_Z)), 0.0
