"""Scaling of formulas by powers of two, so that their largest and least numbers do not overflow or underflow."""

from __future__ import annotations

import math
from collections.abc import Callable

from sceneql.quantities.expression import Call, Expr, Number, each_once

ORDINARY = 64
"""Largest binary exponent of a number that stays as it is written."""
MOST = 1000
"""Largest binary exponent of a single factor: floats hold little more."""

Scaled = tuple[Expr, int]


def balanced(formula: Expr) -> Expr:
    """A formula divided by a power of two; the formula itself where its numbers are ordinary.

    The scaling is exact: values are the same up to the factor wherever neither overflows nor underflows. Parts of a
    union or an intersection (``min``, ``max``) each have a factor of their own.
    """
    if isinstance(formula, Call) and formula.op in ("min", "max"):  # positive factors keep the sign, each part's own
        parts = tuple(map(balanced, formula.args))
        return formula if parts == formula.args else _call(formula, parts)
    known: dict[int, Scaled] = {}
    for node in each_once(formula):
        known[id(node)] = _scaled(node, lambda part: known[id(part)])
    other, power = known[id(formula)]
    return other if power else formula


def _scaled(node: Expr, of: Callable[[Expr], Scaled]) -> Scaled:
    """A scaled node and its binary exponent, from those of its arguments."""
    if isinstance(node, Number) and math.isfinite(node.value):
        mantissa, power = math.frexp(node.value)
        return (Number(mantissa, node.type), power) if abs(power) > ORDINARY else (node, 0)
    if not isinstance(node, Call):
        return node, 0
    parts, powers = zip(*map(of, node.args), strict=True)
    if not any(powers):
        return node, 0
    if node.op in ("mul", "div"):
        return _call(node, parts), powers[0] + (powers[1] if node.op == "mul" else -powers[1])
    if node.op in ("neg", "abs"):
        return _call(node, parts), powers[0]
    if node.op in ("add", "sub", "min", "max"):
        most = max(powers)
        return _call(node, tuple(_times(p, k - most) for p, k in zip(parts, powers, strict=True))), most
    exponent = node.args[-1]
    if node.op == "pow" and isinstance(exponent, Number) and exponent.value.is_integer():
        return _call(node, (parts[0], exponent)), int(exponent.value) * powers[0]
    return node, 0


def _call(node: Call, args: tuple[Expr, ...]) -> Expr:
    return Call(node.op, args, node.type)


def _times(expr: Expr, power: int) -> Expr:
    """The expression times 2^power, for power <= 0."""
    if power == 0:
        return expr
    if isinstance(expr, Number):
        return Number(math.ldexp(expr.value, power), expr.type)
    less = Call("mul", (Number(2.0 ** max(power, -MOST)), expr), expr.type)
    return _times(less, min(power + MOST, 0))
