"""Checks of numbers against a field's range: finite, and within its limits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, get_args

from sceneql.kinds import LIMITS, Quantity, Value
from sceneql.quantities.diagnostic import Diagnostics, Note
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.instead import instead
from sceneql.quantities.span import Span
from sceneql.quantities.units import unit_of

LARGEST_WHOLE = 2**53
"""Largest whole number below which doubles skip none; products of a few such numbers are finite doubles."""


def finite(number: Any) -> bool:
    """Whether a number, or all numbers of nested tuples, are finite."""
    if isinstance(number, tuple):
        return all(finite(item) for item in number)
    return math.isfinite(number)


WORDS = 2
"""Most words of a number with its unit."""


def check_limits(
    value: Any, limits: Mapping[str, float], what: str, annotation: Any, span: Span, found: Diagnostics, whose: str = ""
) -> None:
    """Report a constant that lies outside its field's range, or is not finite.

    ``whose``: the part that it is of, where the script's text does not tell.
    """
    notes = []
    if isinstance(value, Value):
        if not value.constant:
            return
        place = value.expr.span
        if place is not None and whose and not (span.start <= place.start <= place.end <= span.end):
            notes.append(Note("the value stands here", place))
        value = evaluate(value.expr, {})
        if not finite(value):
            found.error("not-finite", f"{what} is not a finite number", span)
            return
    if not limits:
        return
    for number in numbers(value):
        for limit, bound in limits.items():
            holds, word = LIMITS[limit]
            if not holds(number, bound):
                asked, given = (_told(one, annotation) for one in (bound, number))
                taken = "zero" if number == 0.0 else "negative" if number < 0.0 else None
                help = None if taken is None else instead(taken, what.rpartition(".")[2])
                if limit == "at_most" and bound == 1 and 2 <= number <= 100 and given == f"{number:g}":
                    help = f"write `{number:g} %` for a percentage"
                if help is None:
                    help = _mended(span.text, number, bound)
                of = f": that is '{whose}'" if whose else ""
                text = f"{what} must be {word} {asked}, not {given}{of}"
                found.error("out-of-range", text, span, help=help, notes=notes)
                return


def _mended(text: str, number: float, bound: float) -> str | None:
    """The help for a number that lies outside by its sign, or by radians that are degrees."""
    if number < 0.0 <= bound and text.startswith("-") and len(text.split()) <= WORDS:
        return f"write it without the minus, `{text[1:].strip()}`"
    if text.endswith("rad") and number > bound:
        return f"in degrees write `{text[: -len('rad')].strip()} deg`"
    return None


def numbers(value: Any) -> list[float]:
    """The numbers in a number or in nested tuples, in order; empty for anything else."""
    if isinstance(value, tuple | list):
        return [number for item in value for number in numbers(item)]
    return [float(value)] if isinstance(value, int | float) and not isinstance(value, bool) else []


def _told(number: float, annotation: Any) -> str:
    """A number in SI with the coherent unit of the field, as messages show it."""
    quantity = _quantity(annotation)
    if quantity is None or quantity.dimension is None:
        return f"{number:g}"
    if quantity.needs_unit and quantity.dimension.plain:
        return f"{math.degrees(number):g} deg"
    return f"{number:g}" if quantity.dimension.plain else f"{number:g} {unit_of(quantity.dimension)}"


def _quantity(annotation: Any) -> Quantity | None:
    """The first Quantity mark in a type; None if there is none."""
    parts = get_args(annotation)
    marks = [part for part in parts if isinstance(part, Quantity)]
    inner = (_quantity(part) for part in parts if not isinstance(part, str | Quantity))
    return marks[0] if marks else next((found for found in inner if found is not None), None)
