"""Texts with values inside: ``t = {time:.2f s}``."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sceneql.kinds.values import Checked, Value
from sceneql.quantities.expression import Call, walk
from sceneql.quantities.operations import OPERATIONS
from sceneql.quantities.units import Unit

if TYPE_CHECKING:
    from sceneql.kinds.moment import Moment

FORM = re.compile(r"[+ ]?#?0?\d{0,2}(\.\d{1,2})?[eEfFgG%]?")
"""Allowed format specifications of a number: a subset of Python's for floats."""
MOST_LETTERS = 2_000
"""Most letters of a text that is drawn in pictures."""
SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
POWER = re.compile(r"e([+-])0*(\d+)$")


def overlong(text: str | None) -> str | None:
    """The error text for a text with too many letters to be drawn; None where it is short enough."""
    if text is None or len(text) <= MOST_LETTERS:
        return None
    return f"a text of {len(text):,} letters is longer than the {MOST_LETTERS:,} that are drawn"


@dataclass(frozen=True, slots=True)
class TextValue(Checked):
    """A value inside a text: its format specification and its unit (None: a plain number)."""

    value: Value
    form: str
    unit: Unit | None

    @property
    def over_time(self) -> bool:
        """Whether it needs the course of the run so far."""
        return any(isinstance(node, Call) and OPERATIONS[node.op].series for node in walk(self.value.expr))

    def at(self, moment: Moment) -> str:
        """The number with its unit now."""
        if self.over_time:
            number = float(moment.course(self.value, None, moment.time)[1][-1])
        else:
            number = float(moment.measure(self.value))
        unit = self.unit
        return written(number if unit is None else (number - unit.offset) / unit.scale, self.form, unit)


def written(number: float, form: str, unit: Unit | None) -> str:
    """A number as pictures show it, with its unit; a dash for NaN."""
    if not math.isfinite(number):
        return "–" if math.isnan(number) else "∞" if number > 0 else "\u2212∞"
    text = format(number, form or ".4g")
    power = POWER.search(text)
    if power is not None:
        raised = ("-" if power[1] == "-" else "") + power[2]
        text = f"{text[: power.start()]}·10{raised.translate(SUPERSCRIPTS)}"
    text = text.replace("-", "\u2212")
    return text if unit is None else f"{text} {shown_unit(unit.text)}"


def shown_unit(text: str) -> str:
    """A unit as it is printed: ``kg/m^3`` with a raised 3, ``degC`` with a small ring."""
    head, *tails = text.replace("**", "^").replace("*", "·").replace("deg", "°").split("^")
    raised = head
    for tail in tails:
        digits = len(tail) - len(tail.lstrip("-0123456789"))
        raised += tail[:digits].translate(SUPERSCRIPTS) + tail[digits:]
    return raised


@dataclass(frozen=True, slots=True)
class Text(Checked):
    """A text whose pieces in braces are values: ``{expression:form unit}``."""

    pieces: tuple[str | TextValue, ...]

    @property
    def values(self) -> list[Value]:
        """The values inside."""
        return [piece.value for piece in self.pieces if isinstance(piece, TextValue)]

    @property
    def courses(self) -> list[Value]:
        """The values inside that need the course of the run so far."""
        return [piece.value for piece in self.pieces if isinstance(piece, TextValue) and piece.over_time]

    def at(self, moment: Moment) -> str:
        """The text now."""
        return "".join(piece if isinstance(piece, str) else piece.at(moment) for piece in self.pieces)
