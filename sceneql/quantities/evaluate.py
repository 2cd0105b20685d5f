"""Evaluation of bound trees: plain Python on floats and tuples, or numpy on arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from sceneql.quantities.curves import evaluate_keys
from sceneql.quantities.expression import Call, Expr, Keys, Link, Number, Symbol, Vector
from sceneql.quantities.quick_operations import OPERATIONS, Operation

Environment = Mapping[Any, Any] | Callable[[Symbol | Link], Any]


def evaluate(expr: Expr, env: Environment, arrays: bool = False) -> Any:
    """The value of a bound tree: a float or nested tuple of floats, or with ``arrays`` a float or float64 array.

    ``env`` gives the values of symbols and links, by node (spans do not matter). Domain errors give NaN or inf.
    Raises KeyError for a symbol or link that ``env`` does not have.
    """
    look_up = env if callable(env) else env.__getitem__
    known: dict[int, Any] = {}  # a shared node is evaluated once
    if not arrays:
        return _walk(expr, look_up, known, None)
    import numpy as np

    with np.errstate(all="ignore"):
        value = _walk(expr, look_up, known, np)
    return float(value) if np.ndim(value) == 0 else np.asarray(value, dtype=float)


def _walk(expr: Expr, look_up: Callable[[Any], Any], known: dict[int, Any], np: Any) -> Any:
    key = id(expr)
    if key not in known:
        known[key] = _one(expr, look_up, known, np)
    return known[key]


def _one(expr: Expr, look_up: Callable[[Any], Any], known: dict[int, Any], np: Any) -> Any:
    match expr:
        case Number(value=value):
            return value
        case Symbol() | Link():
            return look_up(expr)
        case Vector(items=items):
            values = tuple(_walk(item, look_up, known, np) for item in items)
            return values if np is None else np.stack(np.broadcast_arrays(*values), axis=-1) if _scalars(expr) else np.array(values)
        case Keys():
            return evaluate_keys(expr, _walk(expr.argument, look_up, known, np), np)
        case Call(op=op, args=args):
            operation = OPERATIONS[op]
            values = tuple(_walk(arg, look_up, known, np) for arg in args)
            if np is not None:
                return _arrays(operation, values, np)
            if operation.elementwise:
                return _elementwise(operation, values)
            return operation.python(*values)
    raise TypeError(f"an unbound name cannot be evaluated: {expr!r}")


def _scalars(expr: Vector) -> bool:
    return bool(expr.items) and all(not item.type.shape for item in expr.items)


def _arrays(operation: Operation, values: tuple[Any, ...], np: Any) -> Any:
    if isinstance(operation.arrays, str):
        return getattr(np, operation.arrays)(*(np.asarray(v, dtype=float) for v in values))
    return operation.arrays(np, *values)


def _elementwise(operation: Operation, values: tuple[Any, ...]) -> Any:
    deepest = max(values, key=_depth)
    depth = _depth(deepest)
    if depth == 0:
        return operation.python(*values)
    if operation.reduces and len(values) == 1:
        from sceneql.quantities.numeric import flat

        return operation.python(flat(values[0]))
    rows = []
    for k in range(len(deepest)):
        rows.append(_elementwise(operation, tuple(v[k] if _depth(v) == depth else v for v in values)))
    return tuple(rows)


def _depth(value: Any) -> int:
    depth = 0
    while isinstance(value, tuple):
        depth += 1
        if not value:
            break
        value = value[0]
    return depth
