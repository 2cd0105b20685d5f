"""Tables of numbers for keyframes whose times and values are constant."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping

from sceneql.quantities.curves import Components, Table, interpolate, table_of
from sceneql.quantities.expression import Expr, Keys
from sceneql.quantities.operations import FLOATS
from sceneql.quantities.scalars import evaluate_scalars

_NONE: Mapping[object, object] = {}


def keys_table(keys: Keys) -> Table:
    """The numbers of keyframes whose times and values are constant. Raises KeyError where one is not."""

    def components(expr: Expr) -> Components:
        value = evaluate_scalars(expr, _NONE.__getitem__)
        return value if isinstance(value, tuple) else (value,)

    return table_of(FLOATS, keys, lambda expr: float(evaluate_scalars(expr, _NONE.__getitem__)), components)


_TABLES: dict[tuple[int, int, str, int], tuple[Keys, Table | None]] = {}
"""Cache by the id of the keys, which are stored with the table so that no other object gets their id."""
_MOST_TABLES = 10_000


def known_table(keys: Keys) -> Table | None:
    """The table of keyframes whose times and values are constant, made once; None for other keyframes."""
    if len(keys.type.shape) > 1:
        return None
    place = id(keys.keys), id(keys.cycle), keys.curve, len(keys.type.shape)
    if place not in _TABLES:
        if len(_TABLES) >= _MOST_TABLES:
            _TABLES.clear()
        try:
            table = keys_table(keys)
        except (KeyError, TypeError):  # a symbol, a link
            table = None
        _TABLES[place] = keys, table
    return _TABLES[place][1]


def value_at(table: Table, t: float) -> tuple[float, ...]:
    """The components (c,) of a table of floats at a time [s]: held before the first and after the last key."""
    return interpolate(FLOATS, table, t, lambda t, times: bisect_right(times, t) - 1 if t == t else 0)
