"""The arithmetic of scalar expressions: operations build trees, with constants folded and 0 and 1 dropped."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from sceneql.quantities.expression import Call, Expr, Number, each_once
from sceneql.quantities.operations import FLOATS, OPERATIONS

ZERO, ONE = Number(0.0), Number(1.0)


class Trees:
    """An arithmetic ``o`` for formulas and partial derivatives whose results are trees; operands may be floats."""

    def __init__(self, make: Callable[..., Any]) -> None:
        self._make = make

    def __getattr__(self, name: str) -> Callable[..., Any]:
        if name not in OPERATIONS or not OPERATIONS[name].primitive:
            raise AttributeError(name)
        return lambda *args: self._make(name, *args)


def simplify(expr: Expr) -> Expr:
    """A simpler tree with the same value: in calls of scalar primitives constants are folded, 0 and 1 dropped."""
    known: dict[int, Expr] = {}
    for node in each_once(expr):
        known[id(node)] = node
        if isinstance(node, Call) and OPERATIONS[node.op].primitive and not node.type.shape:
            args = [known[id(arg)] for arg in node.args]
            if not any(arg.type.shape for arg in args) and (len(args) > 1 or not OPERATIONS[node.op].reduces):
                known[id(node)] = made(node.op, *args)
    return known[id(expr)]


def tree(value: Expr | float) -> Expr:
    """A number as a tree."""
    return Number(float(value)) if isinstance(value, float | int) else value


def made(op: str, *operands: Expr | float) -> Expr:
    """A scalar primitive on scalar trees, in its simplest form."""
    args = tuple(tree(operand) for operand in operands)
    if op in ("min", "max") and len(args) != 2:
        half = len(args) // 2
        return args[0] if half == 0 else made(op, made(op, *args[:half]), made(op, *args[half:]))
    numbers = [arg.value for arg in args if isinstance(arg, Number)]
    if len(numbers) == len(args):
        value = getattr(FLOATS, op)(*numbers)
        if math.isfinite(value):
            return Number(value)
    rule = _RULES.get(op)
    simpler = None if rule is None else rule(*args)
    return Call(op, args) if simpler is None else simpler


def formed(op: str, *operands: Expr | float) -> Expr | float:
    """A scalar primitive, simplified only by the float constants of a formula, never by the value of a Number."""
    if op in ("min", "max") and len(operands) != 2:
        half = len(operands) // 2
        return operands[0] if half == 0 else formed(op, formed(op, *operands[:half]), formed(op, *operands[half:]))
    if all(isinstance(operand, float) for operand in operands):
        return float(getattr(FLOATS, op)(*operands))
    first, last = operands[0], operands[-1]
    if op == "mul" and 0.0 in (first, last):
        return 0.0
    if (op, first) in (("mul", 1.0), ("add", 0.0)):
        return last
    if (op, last) in (("mul", 1.0), ("div", 1.0), ("add", 0.0), ("sub", 0.0)):
        return first
    return Call("neg", (tree(last),)) if (op, first) == ("sub", 0.0) else Call(op, tuple(map(tree, operands)))


def _is(expr: Expr, value: float) -> bool:
    return isinstance(expr, Number) and expr.value == value


def _negated(expr: Expr) -> Expr | None:
    return expr.args[0] if isinstance(expr, Call) and expr.op == "neg" else None


def _add(a: Expr, b: Expr) -> Expr | None:
    if _is(a, 0.0) or _is(b, 0.0):
        return b if _is(a, 0.0) else a
    inner = _negated(b)
    if inner is not None:
        return made("sub", a, inner)
    first, second = _halves(a), _halves(b)
    if first and second and first[0] is second[0]:
        return made("where", first[0], made("add", first[1], second[1]), made("add", first[2], second[2]))
    return None


def _halves(expr: Expr) -> tuple[Expr, Expr, Expr] | None:
    """Condition and branches of a `where` with a zero branch, as in derivatives of `min`.

    None for other expressions.
    """
    if isinstance(expr, Call) and expr.op == "where" and (_is(expr.args[1], 0.0) or _is(expr.args[2], 0.0)):
        condition, a, b = expr.args
        return condition, a, b
    return None


def _sub(a: Expr, b: Expr) -> Expr | None:
    if _is(b, 0.0):
        return a
    if _is(a, 0.0):
        return made("neg", b)
    inner = _negated(b)
    return None if inner is None else made("add", a, inner)


def _mul(a: Expr, b: Expr) -> Expr | None:
    for p, q in ((a, b), (b, a)):
        if _is(p, 0.0):
            return ZERO
        if _is(p, 1.0):
            return q
        if _is(p, -1.0):
            return made("neg", q)
    # The branch not taken may be infinite, and 0 times infinity is NaN: multiply inside the branches.
    for p, q in ((a, b), (b, a)):
        halves = _halves(p)
        if halves is not None:
            return made("where", halves[0], made("mul", halves[1], q), made("mul", halves[2], q))
    return None


def _div(a: Expr, b: Expr) -> Expr | None:
    if _is(b, 1.0):
        return a
    return ZERO if _is(a, 0.0) and not _is(b, 0.0) else None


def _neg(a: Expr) -> Expr | None:
    return _negated(a)


def _pow(a: Expr, b: Expr) -> Expr | None:
    if _is(b, 1.0):
        return a
    return ONE if _is(b, 0.0) else None


def _where(condition: Expr, a: Expr, b: Expr) -> Expr | None:
    if isinstance(condition, Number):
        return a if condition.value != 0.0 else b
    same = a is b or (isinstance(a, Number) and isinstance(b, Number) and a.value == b.value)
    return a if same else None


_RULES: dict[str, Callable[..., Any]] = {
    "add": _add, "sub": _sub, "mul": _mul, "div": _div, "neg": _neg, "pow": _pow, "where": _where,
}  # fmt: skip

TREES = Trees(made)
"""Arithmetic that simplifies all that it can, for derivatives."""

FORMS = Trees(formed)
"""Arithmetic that keeps the form of the script, for splitting vectors."""
