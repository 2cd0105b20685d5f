"""Values of formulas of place and time over boxes, in plain Python."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any

from sceneql.kinds import Formula
from sceneql.quantities.evaluate import evaluate

FINE = 12
"""Number of places along each side of a box at which a formula is looked at."""


def value(formula: Formula, place: Sequence[float], time: float) -> Any:
    """The number, or tuple of numbers, at a place and time; None where it reads more, or is no number."""
    known = {"x": 0.0, "y": 0.0, "z": 0.0, **dict(zip("xyz", place, strict=False)), "t": time, "time": time}

    def look_up(node: Any) -> float:
        return known[node.name]

    try:
        return evaluate(formula.expr, look_up)
    except (AttributeError, KeyError, TypeError, ValueError, ArithmeticError):
        return None


def flat(number: Any) -> list[float]:
    """The numbers of a nested tuple."""
    return [c for one in number for c in flat(one)] if isinstance(number, tuple | list) else [float(number)]


def box(kind: Any) -> list[tuple[float, float]] | None:
    """The ends [m] of the box of a field along each axis; None where it has another domain."""
    size = getattr(kind, "size", None)
    if not isinstance(size, tuple) or not {"cell", "corner"} <= type(kind).model_fields.keys():
        return None
    corner = getattr(kind, "corner", None) or (0.0,) * len(size)
    return [(low, low + side) for low, side in zip(corner, size, strict=True)]


def over(formula: Formula, ends: Sequence[tuple[float, float]], times: Sequence[float]) -> Iterator[Any]:
    """Values at places of a box and at times."""
    steps = [[low + (high - low) * k / FINE for k in range(FINE + 1)] for low, high in ends]
    for time in times:
        for place in product(*steps):
            yield value(formula, place, time)


def nothing(formula: Formula | None, ends: Sequence[tuple[float, float]], end: float) -> bool:
    """Whether a formula is certainly 0: the number 0, or none."""
    if formula is None:
        return True
    values = list(over(formula, ends, (0.0, 0.37 * end, end)))
    return not _varies(formula) and None not in values and not any(any(flat(one)) for one in values)


def _varies(formula: Formula) -> bool:
    """Whether a formula depends on the place, so that what lies between looked-at places is not known."""
    return value(formula, (), 0.0) is None or any(
        value(formula, place, 0.0) != value(formula, (0.0, 0.0, 0.0), 0.0)
        for place in ((0.31, 0.17, 0.59), (17.3, 5.9, 3.1))
    )
