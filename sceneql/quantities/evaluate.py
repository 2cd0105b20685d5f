"""Evaluation of bound trees: plain Python on floats and tuples, or numpy on arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from sceneql.quantities.expression import Expr
from sceneql.quantities.scalars import evaluate_scalars

Environment = Mapping[Any, Any] | Callable[[Any], Any]


def evaluate(expr: Expr, env: Environment, arrays: bool = False) -> Any:
    """The value of a bound tree in SI: a float or nested tuple of floats, or with ``arrays`` a float or float64 array.

    ``env`` gives the value of each Symbol and Link, by node (spans do not matter): a number, nested tuples or an array
    of the node's shape. With ``arrays`` the values may have leading axes (samples, instants), over which all operations
    broadcast; a reduction of a scalar or of a list of unknown length reduces the leading axes too. Poles and bad
    arguments give inf and NaN as in IEEE 754. Raises KeyError for what ``env`` does not have, TypeError for an unbound
    name and for an operation that needs a series, ValueError for lists of different lengths.
    """
    look_up = env if callable(env) else env.__getitem__
    if arrays:
        from sceneql.quantities.arrays import evaluate_arrays

        return evaluate_arrays(expr, look_up)
    return evaluate_scalars(expr, look_up)
