"""Symbolic derivatives of bound scalar trees, and vectors taken apart into scalars."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sceneql.quantities.bind import fold
from sceneql.quantities.expression import Call, Expr, Keys, Link, Number, Symbol, Type, Vector
from sceneql.quantities.quick_operations import OPERATIONS

ZERO, ONE = Number(0.0), Number(1.0)


def differentiate(expr: Expr, by: Symbol | Link) -> Expr:
    """d expr / d by, simplified; types are plain. Raises TypeError for an operation without a derivative."""
    return _derivative(expr, by, {})


def _derivative(expr: Expr, by: Symbol | Link, known: dict[int, Expr]) -> Expr:
    if id(expr) in known:
        return known[id(expr)]
    result: Expr = ZERO
    if isinstance(expr, Symbol | Link):
        result = ONE if expr == by else ZERO
    elif isinstance(expr, Call):
        inner = [_derivative(arg, by, known) for arg in expr.args]
        if any(part != ZERO for part in inner):
            partials = OPERATIONS[expr.op].partials
            if partials is None:
                raise TypeError(f"'{expr.op}' has no derivative")
            for part, outer in zip(inner, partials(*expr.args), strict=True):
                if outer is not None and part != ZERO:
                    result = simplify(Call("add", (result, Call("mul", (_all(outer), part)))))
    elif isinstance(expr, Keys) and any(isinstance(node, type(by)) and node == by for node in _below(expr.argument)):
        raise TypeError("keyframes have no derivative")
    known[id(expr)] = result
    return result


def _below(expr: Expr) -> list[Expr]:
    from sceneql.quantities.expression import walk

    return list(walk(expr))


def _all(expr: Expr) -> Expr:
    """Simplify a freshly built tree from its leaves."""
    if not isinstance(expr, Call):
        return expr
    return simplify(Call(expr.op, tuple(_all(arg) for arg in expr.args), expr.type, expr.span))


def simplify(expr: Expr) -> Expr:
    """One node, its arguments being simple: constants folded, 0 and 1 dropped."""
    if not isinstance(expr, Call):
        return expr
    args = tuple(simplify(arg) for arg in expr.args)
    expr = replace(expr, args=args)
    if len(args) == 2:
        a, b = args
        match expr.op:
            case "add":
                if a == ZERO:
                    return b
                if b == ZERO:
                    return a
            case "sub":
                if b == ZERO:
                    return a
                if a == ZERO:
                    return simplify(Call("neg", (b,)))
            case "mul":
                if ZERO in (a, b):
                    return ZERO
                if a == ONE:
                    return b
                if b == ONE:
                    return a
            case "div":
                if a == ZERO:
                    return ZERO
                if b == ONE:
                    return a
            case "pow":
                if b == ONE:
                    return a
                if b == ZERO:
                    return ONE
    if expr.op == "neg" and isinstance(args[0], Call) and args[0].op == "neg":
        return args[0].args[0]
    return fold(expr) if not expr.type.shape else expr


def components(expr: Expr) -> tuple[Expr, ...]:
    """The scalar trees of a vector one (a scalar: itself). Raises TypeError where they cannot be written down.

    Links and symbols of vector type become `component` calls on them.
    """
    shape = expr.type.shape
    if not shape:
        return (_scalar(expr),)
    if len(shape) != 1 or shape[0] is None:
        raise TypeError("a list of unknown length has no components to write down")
    match expr:
        case Vector(items=items):
            return tuple(_scalar(item) for item in items)
        case Symbol() | Link():
            return tuple(_pick(expr, k) for k in range(shape[0]))
        case Keys():
            return tuple(_pick(expr, k) for k in range(shape[0]))
        case Call(op="cross", args=(a, b)):
            u, v = components(a), components(b)
            return tuple(
                _of("sub", _of("mul", u[i], v[j]), _of("mul", u[j], v[i])) for i, j in ((1, 2), (2, 0), (0, 1))
            )
        case Call(op="normalize", args=(a,)):
            u = components(a)
            return tuple(_of("div", c, _norm(u)) for c in u)
        case Call(op=op, args=args) if OPERATIONS[op].elementwise:
            rows = [components(arg) if arg.type.shape else (_scalar(arg),) * shape[0] for arg in args]
            return tuple(_of(op, *row) for row in zip(*rows, strict=True))
        case Call():
            return tuple(_pick(expr, k) for k in range(shape[0]))
    raise TypeError(f"{expr!r} has no components to write down")


def _scalar(expr: Expr) -> Expr:
    """A scalar tree without vectors inside, where that can be."""
    if not isinstance(expr, Call):
        return expr
    match expr.op:
        case "component":
            index = expr.args[1]
            assert isinstance(index, Number)
            inner = expr.args[0]
            return expr if isinstance(inner, Symbol | Link | Keys) else components(inner)[int(index.value)]
        case "dot":
            u, v = components(expr.args[0]), components(expr.args[1])
            return _total([_of("mul", a, b) for a, b in zip(u, v, strict=True)])
        case "length":
            return _norm(components(expr.args[0]))
        case "distance":
            u, v = components(expr.args[0]), components(expr.args[1])
            return _norm([_of("sub", a, b) for a, b in zip(u, v, strict=True)])
    return replace(expr, args=tuple(_scalar(arg) if not arg.type.shape else arg for arg in expr.args))


def _pick(expr: Expr, k: int) -> Expr:
    return Call("component", (expr, Number(float(k))), Type((), expr.type.dimension), expr.span)


def _of(op: str, *args: Expr) -> Expr:
    return simplify(Call(op, args))


def _total(parts: Sequence[Expr]) -> Expr:
    total = parts[0]
    for part in parts[1:]:
        total = _of("add", total, part)
    return total


def _norm(parts: Sequence[Expr]) -> Expr:
    return _of("sqrt", _total([_of("mul", c, c) for c in parts]))
