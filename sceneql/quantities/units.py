"""Units: text to a ratio, an offset and a dimension, and quantities back to text.

Grammar: ``factor ((* | / | ·) factor)*`` or ``1/factor...``, a factor being a name of the table and a whole exponent
(``m^2``, ``s^-1``) or a fraction in parentheses (``m^(1/2)``).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache

from sceneql.quantities.diagnostic import Diagnostic, ScriptError, suggestion
from sceneql.quantities.dimension import PLAIN, TEMPERATURE, Dimension
from sceneql.quantities.instead import instead
from sceneql.quantities.span import Span
from sceneql.quantities.unit_names import sign_of
from sceneql.quantities.unit_table import KNOWN_UNITS, OFFSET_UNITS, QUANTITIES, UNITS

__all__ = ["KNOWN_UNITS", "Unit", "describe", "format_quantity", "in_words", "parse_unit", "scan_unit", "unit_of"]

LARGEST_EXPONENT = LARGEST_UNIT = 20
"""Limits on the exponent of a factor and on the number of factors: more is a mistake, and could be slow to compute."""


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit: a value of v is v * ratio + shift in SI. ``shift`` is not 0 for ``degC`` and ``degF`` alone."""

    ratio: Fraction
    shift: Fraction
    dimension: Dimension
    text: str

    @property
    def scale(self) -> float:
        """The ratio to SI as a double."""
        return float(self.ratio)

    @property
    def offset(self) -> float:
        """The value of 0 in SI."""
        return float(self.shift)

    def to_si(self, value: Fraction) -> float:
        """The value in SI, rounded once. Raises OverflowError where no double holds it."""
        return float(value * self.ratio + self.shift)


_NAME = re.compile(r"%|°[CF]\b|[^\W\d]\w*'*(?:\.[^\W\d]\w*'*)*")
_EXPONENT = re.compile(r"\s*(?:\^|\*\*)\s*(?:([+-]?\d{1,4})(?![\w.])|\(\s*([+-]?\d{1,4})\s*/\s*(\d{1,4})\s*\))")
_POWER = re.compile(r"\s*(?:\^|\*\*)")
_JOIN = re.compile(r"[/·]|\*(?!\*)")
_SPACED_JOIN = re.compile(r"\s*(?:[/·]|\*(?!\*))\s*")
_INVERSE = re.compile(r"1/(?=%|[^\W\d])")
_UNIT_BEFORE = re.compile(r"\d\.?\s*((?:1/)?[^\W\d][^\s()\[\],]*)[*/]\Z")
_BELOW = r"(?:[\s(*/·]|[^\W\d]\w*(?:\^-?\d+)?)*"  # of names alone: a number there makes it a quotient, not a unit
_BAR_BEFORE = re.compile(rf"(?<![\w.])(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?\s*([^\W\d][\w^*/·-]*)?\s*/({_BELOW})\Z")
_WORDS = re.compile(r"[^\W\d]\w*")
LONGEST_BEFORE = 80
_RAISED = re.compile(r"([^\W\d_]+)(-?[1-9])")
_SUPERSCRIPTS = str.maketrans({"²": "^2", "³": "^3"})


def parse_unit(text: str, span: Span | None = None) -> Unit:
    """The unit of a text such as ``kN/m`` or ``1/s``; spaces around the signs are allowed.

    ``span`` is where the text stands. Raises ScriptError (`unknown-unit`, `offset-unit`, `syntax`).
    """
    start = len(text) - len(text.lstrip())
    unit, end = scan_unit(text, start, span, spaced=True)
    if text[end:].strip():
        raise _error("syntax", f"'{text[end:].strip()[:40]}' is no part of a unit", span, end, len(text))
    return unit


def scan_unit(text: str, start: int, span: Span | None, *, spaced: bool = False) -> tuple[Unit, int]:
    """The unit that starts at ``text[start]``, and where it ends; it may begin with a division bar.

    The first name must be a known unit. After a sign the next name belongs to the unit only if it is a known unit, not
    the name of a call, and (unless ``spaced``) touches the sign: ``1 m/dt`` and ``2 m * h`` are arithmetic.
    """
    found = _INVERSE.match(text, start)
    sign, at = (-1, found.end()) if found else (-1, start + 1) if text[start : start + 1] == "/" else (1, start)
    ratio, shift, dimension, factors = Fraction(1), Fraction(0), PLAIN, 0
    join = _SPACED_JOIN if spaced else _JOIN
    while True:
        name = _name(text, at)
        if name is None:
            raise _error("syntax", "a unit is missing here", span, at, at + 1)
        if name not in UNITS and name not in OFFSET_UNITS:
            raise _unknown(name, span, at)
        exponent, end = _exponent(text, at + len(name), span)
        factors += 1
        if factors > LARGEST_UNIT:
            raise _error("syntax", f"a unit has at most {LARGEST_UNIT} factors", span, start, end)
        if name in OFFSET_UNITS:
            _alone(text, start, at, end, exponent, factors, span, join)
            ratio, shift = OFFSET_UNITS[name]
            return Unit(ratio, shift, TEMPERATURE, text[start:end]), end
        try:
            factor, factor_dimension = _factor(name, sign * exponent)
            ratio = factor if factors == 1 else ratio * factor
            representable = float(ratio) != 0.0
        except OverflowError:
            representable = False
        if not representable:
            raise _error("syntax", "no double holds the ratio of this unit to SI", span, start, end)
        dimension = factor_dimension if factors == 1 else dimension * factor_dimension
        following = join.match(text, end)
        if following is None or not (spaced or _continues(text, following.end())):
            return Unit(ratio, shift, dimension, text[start:end]), end
        sign, at = (-1 if "/" in following.group() else 1), following.end()


def starts_unit(text: str, at: int) -> bool:
    """Whether a name, ``%`` or ``1/name`` stands at ``text[at]``: after a number, all of these must be units."""
    return _NAME.match(text, at) is not None or _INVERSE.match(text, at) is not None


def continues_unit(text: str, at: int) -> bool:
    """Whether a number's unit and a sign that touches both stand before ``text[at]``, as before q in ``2 kN/q``."""
    written = _UNIT_BEFORE.search(text, max(0, at - LONGEST_BEFORE), at)
    if written is None:
        return False
    try:
        parse_unit(written[1])
    except ScriptError:
        return False
    return True


def unit_hint(name: str) -> str | None:
    """The help line of the error for a name that is no unit."""
    (found,) = _unknown(name, None, 0).diagnostics
    return found.help


def stands_below(name: str, text: str, at: int) -> bool:
    """Whether a unit's name at ``text[at]`` stands below a division bar that follows a number, with or without unit.

    As s in ``1500 /s``, and kg and K in ``4186 J/(kg*K)``.
    """
    written = _BAR_BEFORE.search(text, max(0, at - LONGEST_BEFORE), at)
    if written is None or name not in UNITS:
        return False
    return all(word in UNITS for part in written.groups("") for word in _WORDS.findall(part))


def _name(text: str, at: int) -> str | None:
    found = _NAME.match(text, at)
    return None if found is None else found.group()


def _continues(text: str, at: int) -> bool:
    name = _name(text, at)
    return name in UNITS and text[at + len(name) : at + len(name) + 1] != "("


def _exponent(text: str, at: int, span: Span | None) -> tuple[Fraction, int]:
    found = _EXPONENT.match(text, at)
    if found is None:
        sign = _POWER.match(text, at)
        if sign is not None:
            where = sign.end() - 1
            message = "a unit's exponent is a whole number, or a fraction in parentheses"
            help = "for a power of the quantity, put number and unit in parentheses: `(2 m)^n`"
            raise _error("syntax", message, span, where, where + 1, help)
        return Fraction(1), at
    whole, over, under = found.groups()
    if under is not None and int(under) == 0:
        raise _error("syntax", "a unit's exponent divides by zero", span, *found.span())
    exponent = Fraction(int(whole)) if whole is not None else Fraction(int(over), int(under))
    if abs(exponent) > LARGEST_EXPONENT or exponent.denominator > LARGEST_EXPONENT:
        raise _error("syntax", f"a unit's exponent is at most {LARGEST_EXPONENT}", span, *found.span())
    return exponent, found.end()


@lru_cache(1000)
def _factor(name: str, exponent: Fraction) -> tuple[Fraction, Dimension]:
    ratio, dimension = UNITS[name]
    if exponent == 1:
        return ratio, dimension
    if exponent.denominator == 1:
        return Fraction(ratio ** int(exponent)), dimension**exponent
    return Fraction(float(ratio) ** float(exponent)), dimension**exponent


def _alone(
    text: str, start: int, at: int, end: int, exponent: Fraction, factors: int, span: Span | None, join: re.Pattern[str]
) -> None:
    following = join.match(text, end)
    compound = factors > 1 or exponent != 1 or at != start
    if compound or (following is not None and _continues(text, following.end())):
        message = f"'{_name(text, at)}' has its zero elsewhere than at 0 K, so that it can only stand alone"
        raise _error("offset-unit", message, span, at, end, "write K for differences of temperature")


def _unknown(name: str, span: Span | None, at: int) -> ScriptError:
    written = name.translate(_SUPERSCRIPTS)
    if written == name and (raised := _RAISED.fullmatch(name)) is not None and raised[1] in UNITS:
        written = f"{raised[1]}^{raised[2]}"
    if written != name:
        hint: str | None = f"write `{written}`"
    else:
        hint = instead("unit", name)
        if "." in name and all(piece in UNITS for piece in name.split(".")):
            hint = f"units are multiplied by `*`: write `{name.replace('.', '*')}`, and powers as `s^-1`"
        same = [known for known in KNOWN_UNITS if known.lower() == name.lower()]
        same += [name[:-1]] if name.endswith("s") and name[:-1] in KNOWN_UNITS else []  # 20 cms
        meant = sign_of(name) or (same[0] if same else None)
        hint = hint or (suggestion(name, KNOWN_UNITS) if meant is None else f"did you mean '{meant}'?")
    return _error("unknown-unit", f"there is no unit '{name}'", span, at, at + max(1, len(name)), hint)


def _error(code: str, message: str, span: Span | None, start: int, end: int, help: str | None = None) -> ScriptError:
    place = None if span is None else span.part(start, end)
    return ScriptError([Diagnostic(code, message, place, help)])


@cache
def _shown() -> dict[Dimension, tuple[str, str]]:
    return {parse_unit(text).dimension: (text, name) for text, name in reversed(QUANTITIES)}


def unit_of(dimension: Dimension) -> str:
    """The coherent SI unit of a dimension as a script may write it: ``N/m``, ``m/s^2``; ``1`` for a plain number."""
    return _shown()[dimension][0] if dimension in _shown() else str(dimension)


def format_quantity(value: float, dimension: Dimension | None) -> str:
    """A quantity as a script may write it, such as ``1000 N/m``; a plain number has no unit."""
    number = repr(value).removesuffix(".0")
    return number if dimension is None or dimension.plain else f"{number} {unit_of(dimension)}"


def describe(dimension: Dimension | None) -> str:
    """A dimension in words: ``a stiffness (N/m)``, ``a plain number``."""
    if dimension is None:
        return "a quantity"
    if dimension.plain:
        return "a plain number"
    name = _shown()[dimension][1] if dimension in _shown() else "a quantity"
    return f"{name} ({unit_of(dimension)})"


def in_words(dimension: Dimension | None) -> str:
    """The same, where a plain number may be an angle or a percentage."""
    return describe(dimension) if dimension is None or not dimension.kind else dimension.kind
