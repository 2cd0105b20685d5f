"""Evaluation of bound trees in floats: a node of shape S gives nested tuples of floats."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from sceneql.quantities.curves import interpolate, table_of
from sceneql.quantities.expression import Call, Expr, Keys, Link, Number, Shape, Symbol, Vector, each_once
from sceneql.quantities.operations import FLOATS, OPERATIONS, Operation


def evaluate_scalars(expr: Expr, look_up: Callable[[Any], Any]) -> Any:
    """The value of a bound tree as a float or nested tuple of floats; see `evaluate`."""
    if isinstance(expr, Number):
        return expr.value
    values: dict[int, Any] = {}
    for node in each_once(expr):
        match node:
            case Number(value=number):
                value: Any = number
            case Symbol() | Link():
                value = _floats(look_up(node))
            case Vector(items=items):
                value = tuple(values[id(item)] for item in items)
            case Call(args=args):
                value = apply(FLOATS, node, [values[id(arg)] for arg in args])
            case Keys():
                value = _keys(node, values)
            case _:
                raise TypeError(f"the name {'.'.join(node.parts)} is not bound")
        values[id(node)] = value
    return values[id(expr)]


def _floats(value: Any) -> Any:
    if isinstance(value, tuple | list):
        return tuple(_floats(item) for item in value)
    return _floats(value.tolist()) if hasattr(value, "tolist") else float(value)


def _keys(keys: Keys, values: Mapping[int, Any]) -> Any:
    def components(expr: Expr) -> tuple[Any, ...]:
        value = values[id(expr)]
        return value if isinstance(value, tuple) else (value,)

    table = table_of(FLOATS, keys, lambda expr: float(values[id(expr)]), components)
    result = interpolate(FLOATS, table, values[id(keys.argument)], _last_key)
    return result if keys.type.shape else result[0]


def _last_key(t: float, times: tuple[float, ...]) -> int:
    return bisect_right(times, t) - 1 if t == t else 0


def item_of(call: Call, count: int) -> int:
    """The index that an ``item`` call picks in a list of ``count``. Raises ValueError where it is out of range."""
    number = call.args[1]
    assert isinstance(number, Number)
    if number.value >= count:
        raise ValueError(f"there is no item {number.value:g} in a list of {count}: they count from 0")
    return int(number.value)


def apply(o: Any, call: Call, args: list[Any]) -> Any:
    """Apply an operation over an arithmetic ``o`` to scalars of ``o`` or nested tuples of them."""
    operation = OPERATIONS[call.op]
    if operation.series:
        raise TypeError(f"'{call.op}' needs a quantity over time")
    if call.op == "component":
        index = call.args[1]
        assert isinstance(index, Number)
        return _each(lambda vector: vector[int(index.value)], args[:1], [len(call.args[0].type.shape) - 1])
    if call.op == "item":
        return args[0][item_of(call, len(args[0]))]
    if operation.reduces and len(args) == 1:
        return _reduce(o, operation, args[0], call.args[0].type.shape)
    vectors = operation.vectors(call.args)
    function = getattr(o, operation.name) if operation.primitive else partial(formula_of(operation), o)
    ranks = [len(arg.type.shape) - vector for arg, vector in zip(call.args, vectors, strict=True)]
    return _each(function, args, ranks)


def formula_of(operation: Operation) -> Callable[..., Any]:
    """The formula of a composite or reduction. Raises TypeError for an operation without a formula."""
    if operation.formula is None:
        raise TypeError(f"'{operation.name}' has no formula")
    return operation.formula


def _each(function: Callable[..., Any], args: list[Any], ranks: list[int]) -> Any:
    """The function mapped over the outer axes of the arguments, which broadcast from the last axis."""
    top = max(ranks)
    if top <= 0:
        return function(*args)
    lengths = {len(arg) for arg, rank in zip(args, ranks, strict=True) if rank == top}
    if len(lengths) > 1:
        raise ValueError(f"lists of different lengths: {sorted(lengths)}")
    inner = [rank - (rank == top) for rank in ranks]
    pick = [rank == top for rank in ranks]
    return tuple(
        _each(function, [arg[k] if one else arg for arg, one in zip(args, pick, strict=True)], inner)
        for k in range(lengths.pop())
    )


def _reduce(o: Any, operation: Operation, value: Any, shape: Shape) -> Any:
    formula = formula_of(operation)
    if operation.name == "norm":
        return formula(o, list(_flat(value)))
    if len(shape) < 2 or operation.name == "count":
        return formula(o, value if shape else (value,))
    columns = zip(*value, strict=True) if value else [()] * (shape[1] or 0)
    return tuple(_reduce(o, operation, column, shape[1:]) for column in columns)


def _flat(value: Any) -> list[Any]:
    return [part for item in value for part in _flat(item)] if isinstance(value, tuple) else [value]
