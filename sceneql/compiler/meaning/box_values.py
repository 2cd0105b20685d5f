"""Values of formulas of place and time over boxes, in plain Python."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any

from sceneql.kinds import Formula
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Symbol, walk

FLAT, FINE, COARSE = 2, 12, 4
"""Number of sides of a flat box, and of steps along each side of it, and of a deep one, at which formulas are taken."""
PLACE = ("x", "y", "z")


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
    """Values at places of a box and at times; the first in its middle."""
    fine = FINE if len(ends) <= FLAT else COARSE
    steps = [[low + (high - low) * k / fine for k in range(fine + 1)] for low, high in ends]
    for time in times:
        yield value(formula, [0.5 * (low + high) for low, high in ends], time)
        for place in product(*steps):
            yield value(formula, place, time)


def nothing(formula: Formula | None, end: float) -> bool:
    """Whether a formula is certainly 0 up to a time: there is none, or one that is 0 and reads no place.

    One that reads the place may be 0 nearly everywhere: `where(x < 0.1, 2, 0)`.
    """
    if formula is None:
        return True
    if any(isinstance(node, Symbol) and node.name in PLACE for node in walk(formula.expr)):
        return False
    values = [value(formula, (), time) for time in (0.0, 0.37 * end, end)]
    return not any(one is None or any(flat(one)) for one in values)
