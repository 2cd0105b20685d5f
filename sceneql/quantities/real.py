"""Operations on floats with the results of IEEE 754 and numpy: poles give infinity, bad arguments NaN.

Nothing raises.
"""

from __future__ import annotations

import math
from collections.abc import Callable

NAN = math.nan


def div(a: float, b: float) -> float:
    """a / b; a quotient by zero is a signed infinity, 0 / 0 is NaN."""
    if b != 0.0:
        return a / b
    return NAN if a == 0.0 or a != a else math.copysign(math.inf, a) * math.copysign(1.0, b)


def power(a: float, b: float) -> float:
    """a to the b: NaN for a negative a and a fractional b, infinity at a pole or on overflow."""
    try:
        return math.pow(a, b)
    except OverflowError:
        return -math.inf if a < 0.0 and b % 2.0 == 1.0 else math.inf
    except ValueError:
        if a != 0.0:
            return NAN
        return math.copysign(math.inf, a) if b % 2.0 == 1.0 else math.inf


def _within(function: Callable[[float], float]) -> Callable[[float], float]:
    """The function, extended by NaN outside its domain."""

    def quiet(x: float) -> float:
        try:
            return function(x)
        except ValueError:
            return NAN

    return quiet


sqrt, sin, cos, tan = _within(math.sqrt), _within(math.sin), _within(math.cos), _within(math.tan)
asin, acos = _within(math.asin), _within(math.acos)


def _logarithm(function: Callable[[float], float]) -> Callable[[float], float]:
    def quiet(x: float) -> float:
        return -math.inf if x == 0.0 else (NAN if x < 0.0 else function(x))

    return quiet


log, log10 = _logarithm(math.log), _logarithm(math.log10)


def exp(x: float) -> float:
    """e to the x, infinity on overflow."""
    try:
        return math.exp(x)
    except OverflowError:
        return math.inf


def sinh(x: float) -> float:
    """Hyperbolic sine, infinity on overflow."""
    try:
        return math.sinh(x)
    except OverflowError:
        return math.copysign(math.inf, x)


def cosh(x: float) -> float:
    """Hyperbolic cosine, infinity on overflow."""
    try:
        return math.cosh(x)
    except OverflowError:
        return math.inf


def floor(x: float) -> float:
    """The largest whole number that is not above x."""
    return float(math.floor(x)) if math.isfinite(x) else x


def ceil(x: float) -> float:
    """The smallest whole number that is not below x."""
    return float(math.ceil(x)) if math.isfinite(x) else x


def nearest(x: float) -> float:
    """The nearest whole number, of two the even one."""
    return float(round(x)) if math.isfinite(x) else x


def sign(x: float) -> float:
    """-1, 0 or 1; NaN for NaN."""
    return x if x != x else float((x > 0.0) - (x < 0.0))


def modulo(a: float, b: float) -> float:
    """a - b floor(a / b), which has the sign of b; NaN for b = 0."""
    return NAN if b == 0.0 else a % b


def smallest(*values: float) -> float:
    """The smallest; NaN if any is."""
    best = values[0]
    for value in values[1:]:
        if value < best or value != value:
            best = value
    return best


def largest(*values: float) -> float:
    """The largest; NaN if any is."""
    best = values[0]
    for value in values[1:]:
        if value > best or value != value:
            best = value
    return best


def where(condition: float, a: float, b: float) -> float:
    """``a`` where the condition is not 0, else ``b``."""
    return a if condition != 0.0 else b
