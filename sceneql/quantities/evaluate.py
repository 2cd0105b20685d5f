"""Evaluation of bound trees: plain Python on floats and tuples, or numpy on arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from sceneql.quantities.expression import Expr
from sceneql.quantities.scalars import evaluate_scalars

Environment = Mapping[Any, Any] | Callable[[Any], Any]


def evaluate(expr: Expr, env: Environment, arrays: bool = False) -> Any:
    """The value of a bound tree in SI: a float or nested tuple of floats, or with ``arrays`` a float or float64 array.

    ``env`` gives the value of each Symbol and Link, by node (spans do not matter): a number, nested tuples or an
    array of the node's shape. With ``arrays`` these may have axes before those of the shape (samples, instants): all
    operations go along them, but a reduction of a single value or of a list of unknown length takes them too. Poles
    and bad arguments give inf and NaN as in IEEE 754. Raises KeyError for what ``env`` does not have, TypeError for an
    unbound name and for an operation that needs a series, ValueError for lists of different lengths.
    """
    look_up = env if callable(env) else env.__getitem__
    if arrays:
        from sceneql.quantities.arrays import evaluate_arrays

        return evaluate_arrays(expr, look_up)
    return evaluate_scalars(expr, look_up)
