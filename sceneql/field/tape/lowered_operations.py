"""Scalar operations that a tape computes by other operations, and the functions that fold operations on constants."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.kinds.field_builder import FieldBuilder


def _sign(a: float) -> float:
    return float((a > 0.0) - (a < 0.0))


FOLD: dict[str, Callable[..., float]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "min": min,
    "max": max,
    "pow": math.pow,
    "atan2": math.atan2,
    "neg": lambda a: -a,
    "abs": abs,
    "square": lambda a: a * a,
    "sqrt": math.sqrt,
    "sin": math.sin,
    "cos": math.cos,
    "exp": math.exp,
    "log": math.log,
    "floor": math.floor,
    "sign": _sign,
}
"""Tape operations as Python functions of numbers, to fold constants; they raise errors outside their domains."""


def _times(name: str, factor: float) -> Callable[[FieldBuilder, int], int]:
    return lambda tape, a: tape.op("mul", tape.op(name, a), tape.constant(factor))


def _tan(tape: FieldBuilder, a: int) -> int:
    return tape.op("div", tape.op("sin", a), tape.op("cos", a))


def _arc(tape: FieldBuilder, a: int, cosine: bool) -> int:
    other = tape.op("sqrt", tape.op("sub", tape.constant(1.0), tape.op("square", a)))
    return tape.op("atan2", other, a) if cosine else tape.op("atan2", a, other)


def _hyperbolic(tape: FieldBuilder, a: int, join: str) -> int:
    grown = tape.op("exp", a)
    both = tape.op(join, grown, tape.op("div", tape.constant(1.0), grown))
    return tape.op("mul", tape.constant(0.5), both)


def _tanh(tape: FieldBuilder, a: int) -> int:
    """1 - 2/(exp(2 a) + 1); a is clamped to -20..20, beyond which tanh is +-1 in float64, so exp(2 a) is finite."""
    held = tape.op("clamp", a, tape.constant(-20.0), tape.constant(20.0))
    grown = tape.op("exp", tape.op("mul", tape.constant(2.0), held))
    less = tape.op("div", tape.constant(2.0), tape.op("add", grown, tape.constant(1.0)))
    return tape.op("sub", tape.constant(1.0), less)


def _modulo(tape: FieldBuilder, a: int, b: int) -> int:
    return tape.op("sub", a, tape.op("mul", b, tape.op("floor", tape.op("div", a, b))))


def _mix(tape: FieldBuilder, a: int, b: int, share: int) -> int:
    return tape.op("add", a, tape.op("mul", tape.op("sub", b, a), share))


def _smoothstep(tape: FieldBuilder, low: int, high: int, a: int) -> int:
    share = tape.op("div", tape.op("sub", a, low), tape.op("sub", high, low))
    share = tape.op("clamp", share, tape.constant(0.0), tape.constant(1.0))
    steep = tape.op("sub", tape.constant(3.0), tape.op("mul", tape.constant(2.0), share))
    return tape.op("mul", tape.op("square", share), steep)


def _above(tape: FieldBuilder, a: int, b: int) -> int:
    """1 where a > b, else 0."""
    return tape.op("max", tape.op("sign", tape.op("sub", a, b)), tape.constant(0.0))


def _not(tape: FieldBuilder, a: int) -> int:
    return tape.op("sub", tape.constant(1.0), a)


def _equal(tape: FieldBuilder, a: int, b: int) -> int:
    return _not(tape, tape.op("abs", tape.op("sign", tape.op("sub", a, b))))


def _where(tape: FieldBuilder, condition: int, a: int, b: int) -> int:
    chosen = tape.op("abs", tape.op("sign", condition))
    return tape.op("add", tape.op("mul", chosen, a), tape.op("mul", _not(tape, chosen), b))


LOWERED: dict[str, Callable[..., int]] = {
    "tan": _tan,
    "asin": lambda tape, a: _arc(tape, a, cosine=False),
    "acos": lambda tape, a: _arc(tape, a, cosine=True),
    "atan": lambda tape, a: tape.op("atan2", a, tape.constant(1.0)),
    "sinh": lambda tape, a: _hyperbolic(tape, a, "sub"),
    "cosh": lambda tape, a: _hyperbolic(tape, a, "add"),
    "tanh": _tanh,
    "log10": _times("log", 1.0 / math.log(10.0)),
    "ceil": lambda tape, a: tape.op("neg", tape.op("floor", tape.op("neg", a))),
    "round": lambda tape, a: tape.op("floor", tape.op("add", a, tape.constant(0.5))),
    "mod": _modulo,
    "hypot": lambda tape, a, b: tape.op("sqrt", tape.op("add", tape.op("square", a), tape.op("square", b))),
    "clamp": lambda tape, a, low, high: tape.op("min", tape.op("max", a, low), high),
    "mix": _mix,
    "smoothstep": _smoothstep,
    "ease": lambda tape, a: _smoothstep(tape, tape.constant(0.0), tape.constant(1.0), a),
    "gt": _above,
    "lt": lambda tape, a, b: _above(tape, b, a),
    "ge": lambda tape, a, b: _not(tape, _above(tape, b, a)),
    "le": lambda tape, a, b: _not(tape, _above(tape, a, b)),
    "eq": _equal,
    "step": lambda tape, edge, a: _not(tape, _above(tape, edge, a)),
    "where": _where,
}
"""By name in ``quantities.operations``, a function (tape, *registers) -> register that emits the operation."""
