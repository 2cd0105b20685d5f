"""Evaluation of bound trees by numpy: a node of shape S gives an array (..., *S) with any leading axes (samples)."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial, reduce
from types import SimpleNamespace
from typing import Any

from sceneql.quantities import chance, noise
from sceneql.quantities.curves import interpolate, table_of
from sceneql.quantities.expression import Call, Expr, Keys, Link, Number, Shape, Symbol, Vector, children, each_once
from sceneql.quantities.key_tables import known_table, value_at
from sceneql.quantities.operations import OPERATIONS
from sceneql.quantities.scalars import item_of


def evaluate_arrays(expr: Expr, look_up: Callable[[Any], Any]) -> Any:
    """The value of a bound tree as a float or float64 array; see `evaluate`."""
    import numpy as np

    values: dict[int, Any] = {}
    with np.errstate(all="ignore"):
        for node in each_once(expr, below=_below):
            match node:
                case Number(value=number):
                    value: Any = np.float64(number)
                case Symbol() | Link():
                    value = np.asarray(look_up(node), dtype=np.float64)
                case Vector(items=items):
                    value = _side_by_side([values[id(item)] for item in items], len(node.type.shape))
                case Call(args=args):
                    value = _apply(node, [values[id(arg)] for arg in args])
                case Keys():
                    value = _keys(node, values)
                case _:
                    raise TypeError(f"the name {'.'.join(node.parts)} is not bound")
            values[id(node)] = value
    result = values[id(expr)]
    return float(result) if np.ndim(result) == 0 else np.asarray(result, dtype=np.float64)


@cache
def numpy_arithmetic() -> SimpleNamespace:
    """The primitive operations of the table on arrays: the arithmetic ``o`` of formulas and curves."""
    import numpy as np

    def folded(function: Any) -> Callable[..., Any]:
        return lambda *args: reduce(function, args)

    def counted(function: Any) -> Callable[..., Any]:
        return lambda a, b: function(a, b).astype(np.float64)

    own = {
        "where": lambda condition, a, b: np.where(condition != 0.0, a, b),
        "random": _random,
        "noise_line": partial(_noise, noise.line),
        "noise_space": partial(_noise, noise.space),
    }
    functions: dict[str, Any] = {}
    for operation in OPERATIONS.values():
        if operation.primitive and operation.name not in own:
            function = getattr(np, str(operation.numpy))
            if operation.name in ("min", "max"):
                function = folded(function)
            elif operation.name == "pow":
                function = _power
            elif operation.name in ("lt", "le", "gt", "ge", "eq"):
                function = counted(function)
            functions[operation.name] = function
    return SimpleNamespace(**functions, **own)


def _power(a: Any, b: Any) -> Any:
    """a to the power b; numpy's power takes the square root for b = 0.5, which gives NaN for minus infinity."""
    import numpy as np

    return np.where((a == -np.inf) & (b == 0.5), np.inf, np.power(a, b))


def _random(*counters: Any) -> Any:
    import numpy as np

    known = np.broadcast_arrays(*counters)
    finite = np.all([np.isfinite(x) for x in known], axis=0)
    words = [np.mod(np.floor(np.where(finite, x, 0.0)), 2.0**32).astype(np.uint64) for x in known]
    first, second, key = (words + [np.zeros((), dtype=np.uint64)] * 2)[:3]
    return np.where(finite, chance.unit(*chance.philox(first, second, key)), np.nan)


def _noise(formula: Callable[..., Any], *args: Any) -> Any:
    """A noise of quantities.noise on arrays; the last argument is the order of its derivative."""
    import numpy as np

    *numbers, order = args
    known = np.broadcast_arrays(*numbers)
    finite = np.all([np.isfinite(x) for x in known], axis=0)
    m = SimpleNamespace(floor=np.floor, where=np.where, word=lambda x: np.mod(x, 2.0**32).astype(np.uint64))
    return np.where(finite, formula(m, *(np.where(finite, x, 0.0) for x in known), int(order)), np.nan)


def _apply(call: Call, args: list[Any]) -> Any:
    import numpy as np

    operation = OPERATIONS[call.op]
    if operation.series:
        raise TypeError(f"'{call.op}' needs a quantity over time")
    if call.op == "component":
        index = call.args[1]
        assert isinstance(index, Number)
        return args[0][..., int(index.value)]
    if call.op == "item":
        axis = -len(call.args[0].type.shape)
        return np.take(args[0], item_of(call, args[0].shape[axis]), axis=axis)
    if operation.reduces and len(args) == 1:
        return _reduce(call.op, args[0], call.args[0].type.shape)
    vectors = operation.vectors(call.args)
    ranks = [len(arg.type.shape) - vector for arg, vector in zip(call.args, vectors, strict=True)]
    parts = zip(args, ranks, vectors, strict=True)
    args = [_aligned(arg, rank, max(ranks) - rank, int(vector)) for arg, rank, vector in parts]
    o = numpy_arithmetic()
    if operation.primitive:
        return getattr(o, operation.name)(*args)
    if operation.formula is None:
        raise TypeError(f"'{call.op}' has no formula")
    pieces = [
        tuple(arg[..., k] for k in range(arg.shape[-1])) if vector else arg
        for arg, vector in zip(args, vectors, strict=True)
    ]
    result = operation.formula(o, *pieces)
    return np.stack(np.broadcast_arrays(*result), axis=-1) if operation.vector_result else result


def _aligned(value: Any, rank: int, missing: int, core: int) -> Any:
    """Insert ``missing`` axes of length 1 behind the leading axes, so that arguments of unlike rank broadcast."""
    import numpy as np

    value = np.asarray(value)
    place = max(value.ndim - rank - core, 0)
    return value.reshape(value.shape[:place] + (1,) * missing + value.shape[place:]) if missing else value


def _side_by_side(items: list[Any], rank: int) -> Any:
    """Stack items of shape S to an array (..., n, *S); ``rank`` is that of (n, *S)."""
    import numpy as np

    if not items:
        return np.zeros(0)
    return np.stack(np.broadcast_arrays(*items), axis=-rank)


def _reduce(name: str, value: Any, shape: Shape) -> Any:
    import numpy as np

    value = np.asarray(value)
    own = len(shape) if name == "norm" else min(1, len(shape))
    first = value.ndim - len(shape)
    axes = tuple(range(max(first, 0), first + own))
    if not shape or shape[0] is None:
        axes = tuple(range(first + own))
    if name == "count":
        return np.float64(value.size if not shape else value.shape[first])
    if name == "norm":
        return np.sqrt(np.sum(value * value, axis=axes))
    if name != "sum" and any(value.shape[axis] == 0 for axis in axes):
        return np.full(np.delete(value.shape, axes), np.nan)
    return getattr(np, name)(value, axis=axes)


def _below(expr: Expr) -> tuple[Expr, ...]:
    """The children to evaluate.

    Of keyframes with constant times and values, which become a table, only the argument.
    """
    return (expr.argument,) if isinstance(expr, Keys) and known_table(expr) is not None else children(expr)


def _keys(keys: Keys, values: dict[int, Any]) -> Any:
    import numpy as np

    o, t = numpy_arithmetic(), values[id(keys.argument)]
    table = known_table(keys)
    if table is not None and np.ndim(t) == 0:
        found = value_at(table, float(t))
        return np.array(found) if keys.type.shape else np.float64(found[0])

    def components(expr: Expr) -> tuple[Any, ...]:
        value = values[id(expr)]
        return tuple(value[..., k] for k in range(value.shape[-1])) if keys.type.shape else (value,)

    if table is None:
        table = table_of(o, keys, lambda expr: float(values[id(expr)]), components)
    result = np.broadcast_arrays(*interpolate(o, table, t), t)[:-1]
    return np.stack(result, axis=-1) if keys.type.shape else result[0]
