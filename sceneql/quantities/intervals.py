"""Interval arithmetic: bounds on an expression whose symbols lie in given ranges, never too narrow."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from sceneql.quantities.expression import Call, Expr, Number, Symbol

Range = tuple[float, float]
MOST = 100.0
"""Largest power that is bounded."""
ANY: Range = (-math.inf, math.inf)


def range_of(expr: Expr, known: Mapping[str, Range]) -> Range:
    """Lower and upper bound of a scalar expression; infinite where it has operations that are not covered here."""
    return _range(expr, known, {})


def _range(expr: Expr, known: Mapping[str, Range], found: dict[int, Range]) -> Range:
    """As `range_of`; ``found``: the ranges of calls met before, by their identity, as parts of a tree are shared."""
    if id(expr) in found:
        return found[id(expr)]
    if isinstance(expr, Number) and isinstance(expr.value, int | float):
        return float(expr.value), float(expr.value)
    if isinstance(expr, Symbol):
        return known.get(expr.name, ANY)
    if not isinstance(expr, Call) or expr.op not in _OPERATIONS:
        return ANY
    low, high = _OPERATIONS[expr.op](*(_range(arg, known, found) for arg in expr.args))
    found[id(expr)] = ANY if math.isnan(low) or math.isnan(high) else (low, high)
    return found[id(expr)]


def _add(a: Range, b: Range) -> Range:
    return a[0] + b[0], a[1] + b[1]


def _neg(a: Range) -> Range:
    return -a[1], -a[0]


def _sub(a: Range, b: Range) -> Range:
    return _add(a, _neg(b))


def _mul(a: Range, b: Range) -> Range:
    ends = [x * y if x and y else 0.0 for x in a for y in b]
    return min(ends), max(ends)


def _div(a: Range, b: Range) -> Range:
    return ANY if b[0] <= 0.0 <= b[1] else _mul(a, (1.0 / b[1], 1.0 / b[0]))


def _pow(a: Range, b: Range) -> Range:
    power = b[0]
    if b[0] != b[1] or not power.is_integer() or not 1.0 <= power <= MOST:
        return ANY
    low, high = a if power % 2 else _abs(a)
    return _power(low, int(power)), _power(high, int(power))


def _power(number: float, power: int) -> float:
    try:
        return number**power
    except OverflowError:
        return math.copysign(math.inf, number if power % 2 else 1.0)


def _abs(a: Range) -> Range:
    return (max(a[0], -a[1], 0.0), max(-a[0], a[1]))


def _less(a: Range, b: Range) -> Range:
    return float(a[1] < b[0]), float(a[0] < b[1])


def _at_most(a: Range, b: Range) -> Range:
    return float(a[1] <= b[0]), float(a[0] <= b[1])


def _equal(a: Range, b: Range) -> Range:
    return 0.0, float(a[0] <= b[1] and b[0] <= a[1])


_OPERATIONS: Mapping[str, Callable[..., Range]] = {
    "add": _add,
    "sub": _sub,
    "neg": _neg,
    "mul": _mul,
    "div": _div,
    "pow": _pow,
    "abs": _abs,
    "sqrt": lambda a: (math.sqrt(max(a[0], 0.0)), math.sqrt(max(a[1], 0.0))) if a[0] >= 0.0 else ANY,
    "hypot": lambda a, b: (math.hypot(_abs(a)[0], _abs(b)[0]), math.hypot(_abs(a)[1], _abs(b)[1])),
    "min": lambda *some: (min(one[0] for one in some), min(one[1] for one in some)),
    "max": lambda *some: (max(one[0] for one in some), max(one[1] for one in some)),
    "lt": _less,
    "le": _at_most,
    "gt": lambda a, b: _less(b, a),
    "ge": lambda a, b: _at_most(b, a),
    "eq": _equal,
}
