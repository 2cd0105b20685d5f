"""Examples in helps with the author's own quantity in place of the example's, where they are of one dimension."""

from __future__ import annotations

import re

from sceneql.quantities.diagnostic import ScriptError, same_as
from sceneql.quantities.dimension import LENGTH, TIME, Dimension
from sceneql.quantities.expression import Expr, Number, Shape, Vector
from sceneql.quantities.parser import parse_value
from sceneql.quantities.span import Source, Span

_NUMBER = r"-?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?"
_EXAMPLE = re.compile(rf"(\w+): ({_NUMBER}(?: {_NUMBER})*(?: ?(?:[^\W\d]|/|%)[\w^*/·()-]*?)?)(?=[,}}`\]])")
_QUANTITY = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?) ?([^\W\d]\w*)?")
_ITEM = re.compile(r"\s+(?=[-+.\d])")
_SHOWN = re.compile(r"`[^`]*`")
UNSURE = ("size", "width", "diameter", "extent", "from", "start", "begin", "start_time", "t0")
"""Names whose value is not the one that an example by a name that means the same shows: a diameter is two radii."""

HALF = "half of"
_HALF_OF = re.compile(rf"({HALF} [^`]*) `(\w+): [^`]*`")
"""What stands in a help whose example is half of what the author wrote."""
DIRECTION = "direction"
"""A field whose numbers have no unit, and point as a place does."""


def with_own(help: str, name: str, text: str, *, beside: bool = False) -> str:
    """A help whose one example that an unknown field's value ``text`` could stand for has that value.

    Of lengths, times and plain numbers, which are many things, it has to be by the field's name, or one that means the
    same; likewise the value of a field ``beside`` the one that the help is for.
    """
    own = _type(text)
    if HALF in help and not beside and re.fullmatch(_NUMBER, text.strip()):
        return _HALF_OF.sub(rf"\1 `\2: {float(text) / 2:.6g}`", help)
    if HALF in help and own != ((), LENGTH, LENGTH.kind) and not beside:  # of another example's number it is not half
        return _HALF_OF.sub(r"\1 `\2`", help)
    if own is None or (name in UNSURE and HALF not in help):
        return help
    found = [one for shown in _SHOWN.finditer(help) for one in _EXAMPLE.finditer(help, *shown.span())]
    vague = own[1] is None or own[1].plain or own[1] in (LENGTH, TIME)
    vague = beside or (vague and (len(found) > 1 or own[1] not in (LENGTH, TIME)))
    fits = [one for one in found if _type(one[2]) == own and (not vague or same_as(name, [one[1]]) is not None)]
    if HALF in help and own[0] == () and not beside:
        fits, text = [one for one in found if _type(one[2]) == own], _halved(text)
    towards = [one for one in found if one[1] == DIRECTION and own == ((3,), LENGTH, LENGTH.kind)]
    if towards and not (fits or beside):
        fits, text = towards, " ".join(re.findall(_NUMBER, text))
    if len(fits) != 1:
        return help
    start, end = fits[0].span(2)
    down = text.startswith("-") and own[0] == () and not fits[0][2].startswith("-")  # what pulls has no minus
    return help[:start] + (text[1:].strip() if down else text) + help[end:]


def numbers_with_unit(text: str) -> tuple[list[float], str] | None:
    """Plain numbers of one unit, ``""`` if none is written, side by side, in brackets or not; else None."""
    items = [one for part in text.replace("[", " ").replace("]", " ").split(",") for one in _ITEM.split(part) if one]
    parts = [_QUANTITY.fullmatch(" ".join(item.split())) for item in items]
    units = [part[2] or "" for part in parts if part is not None]
    if not parts or None in parts or (any(units[:-1]) and len({*units}) > 1):
        return None
    return [float(part[1]) for part in parts if part is not None], units[-1]


def _halved(text: str) -> str:
    """Half of a number with its unit."""
    number = re.match(_NUMBER, text)
    return text if number is None else f"{float(number[0]) / 2:.6g}{text[number.end() :]}"


def in_si(text: str) -> list[float]:
    """The numbers of a text in SI, without their unit; empty where it is no constant number or vector."""
    value = _parsed(text)
    numbers = value.items if isinstance(value, Vector) else [value]
    return [one.value for one in numbers if isinstance(one, Number)]


def _type(text: str) -> tuple[Shape, Dimension | None, str] | None:
    """Shape and dimension of numbers with at most one unit; None of other texts."""
    value = _parsed(text)
    if isinstance(value, Vector):
        return (len(value.items),), *_dimension(value.items[0])
    return (value.type.shape, *_dimension(value)) if isinstance(value, Number) else None


def _dimension(value: Expr) -> tuple[Dimension | None, str]:
    """Dimension and kind: an angle is no plain number."""
    dimension = value.type.dimension
    return dimension, "" if dimension is None else dimension.kind


def _parsed(text: str) -> Expr | None:
    """The tree of a text that begins with a number or bracket; None of others."""
    if not text or text[:1] not in "-+.0123456789[" or "\n" in text:
        return None
    try:
        return parse_value(text, Span(Source("value", text), 0, len(text)))
    except ScriptError:
        return None
