"""Symbolic derivatives of bound trees, and the split of vectors into scalar trees.

Results consist of scalar primitives of the table with plain types. Links and symbols of vector type appear in them as
`component` calls; so do parts without a scalar form (reductions of lists of unknown length, series).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from sceneql.quantities.curves import interpolate, table_of
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import (
    Call,
    Expr,
    Keys,
    Link,
    Number,
    Shape,
    Symbol,
    Type,
    Vector,
    children,
    each_once,
)
from sceneql.quantities.operations import OPERATIONS
from sceneql.quantities.scalars import apply
from sceneql.quantities.simplify import FORMS, ONE, TREES, ZERO, made, simplify, tree

__all__ = ["components", "differentiate", "simplify"]


class _Unknown:
    """Placeholder for a list of unknown length."""


Meaning = Callable[[Link], Any]
"""What a link stands for: an expression, nested lists of scalar trees, or None for the link itself."""


def components(expr: Expr, meaning: Meaning | None = None) -> tuple[Expr, ...]:
    """The scalar trees of a vector (n,), or the one tree of a scalar. Keyframes become nested `where` calls.

    Raises TypeError for a list of unknown length.
    """
    value = _taken_apart(expr, meaning)
    if isinstance(value, _Unknown) or len(expr.type.shape) > 1:
        raise TypeError("a list has no components to write down")
    return value if isinstance(value, tuple) else (value,)


def _taken_apart(expr: Expr, meaning: Meaning | None = None, linked: dict[Link, Any] | None = None) -> Any:
    """Split an expression into nested tuples of scalar trees; ``linked`` caches those of links."""
    values: dict[int, Any] = {}
    linked = {} if linked is None else linked
    for node in each_once(expr):
        if isinstance(node, Link) and node in linked:
            values[id(node)] = linked[node]
            continue
        found = meaning(node) if meaning is not None and isinstance(node, Link) else None
        if found is None:
            values[id(node)] = _node(node, values)
        else:
            values[id(node)] = _tuples(found) if isinstance(found, list) else _taken_apart(found, meaning, linked)
        if isinstance(node, Link):
            linked[node] = values[id(node)]
    return values[id(expr)]


def _tuples(value: Any) -> Any:
    return tuple(_tuples(item) for item in value) if isinstance(value, list) else value


def _node(node: Expr, values: dict[int, Any]) -> Any:
    match node:
        case Number():
            return node
        case Vector(items=items):
            parts = tuple(values[id(item)] for item in items)
            return _Unknown() if any(isinstance(part, _Unknown) for part in parts) else parts
        case Keys():
            return _keys(node, values)
        case Call(args=args):
            parts = tuple(values[id(arg)] for arg in args)
            if not OPERATIONS[node.op].series and not any(isinstance(part, _Unknown) for part in parts):
                return _trees(apply(FORMS, node, list(parts)))
    return _leaf(node, node.type.shape)


def _trees(value: Any) -> Any:
    return tuple(_trees(item) for item in value) if isinstance(value, tuple) else tree(value)


def _leaf(node: Expr, shape: Shape) -> Any:
    if not shape:
        return node
    if None in shape or len(shape) > 1:
        return _Unknown()
    return tuple(Call("component", (node, Number(float(k)))) for k in range(shape[0] or 0))


def _keys(keys: Keys, values: dict[int, Any]) -> Any:
    def parts(expr: Expr) -> tuple[Any, ...]:
        value = values[id(expr)]
        return value if isinstance(value, tuple) else (value,)

    table = table_of(FORMS, keys, lambda expr: float(evaluate(expr, {})), parts)
    result = _trees(interpolate(FORMS, table, values[id(keys.argument)]))
    return result if keys.type.shape else result[0]


def differentiate(expr: Expr, by: Expr) -> Expr:
    """d expr / d by, simplified, with plain types; of a vector (n,) the Vector of its components' derivatives.

    ``by`` is a scalar Symbol or Link, or a `component` call on one. At a kink the derivative is that of one side, at
    a jump 0. Raises TypeError for an operation without a derivative.
    """
    parts = components(expr)
    known: dict[int, Expr] = {}
    for node in each_once(*parts):
        known[id(node)] = _slope(node, by, known)
    slopes = tuple(known[id(part)] for part in parts)
    return Vector(slopes, Type(expr.type.shape)) if expr.type.shape else slopes[0]


def _slope(node: Expr, by: Expr, known: dict[int, Expr]) -> Expr:
    if isinstance(node, Symbol | Link) or (isinstance(node, Call) and node.op == "component"):
        if node == by:
            return ONE
        inside = node.args[0] if isinstance(node, Call) else None
        if isinstance(inside, Call | Keys) and known[id(inside)] != ZERO:
            raise TypeError("a component of what has no scalar form has no derivative")
        return ZERO
    if not isinstance(node, Call):
        inner = [known[id(part)] for part in children(node)]
        return ONE if any(part != ZERO for part in inner) else ZERO
    slopes = [known[id(arg)] for arg in node.args]
    if all(slope == ZERO for slope in slopes):
        return ZERO
    operation = OPERATIONS[node.op]
    if operation.partials is None or any(arg.type.shape for arg in node.args):
        raise TypeError(f"'{node.op}' has no derivative here")
    total: Expr = ZERO
    for partial, slope in zip(operation.partials(TREES, *node.args), slopes, strict=True):
        if slope != ZERO:
            total = made("add", total, made("mul", partial, slope))
    return total
