"""Parsing of numbers with units: literals of expressions, and scalars that consist of numbers and one unit."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from fractions import Fraction

from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Expr, Number, Type, Vector
from sceneql.quantities.instead import instead
from sceneql.quantities.operations import CONSTANTS, OPERATIONS
from sceneql.quantities.span import Span
from sceneql.quantities.unit_names import sign_of
from sceneql.quantities.unit_table import UNITS
from sceneql.quantities.units import Unit, scan_unit, starts_unit

NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
WORD = r"[^\W\d]\w*'*(?:\.(?:[^\W\d]\w*'*|\d+))*"
_PIECE = re.compile(rf"([+-]?{NUMBER})(?:/({NUMBER}))?")
_WORD = re.compile(WORD)
_GAP = re.compile(r"\s*")
_ITEM = re.compile(rf"\s*([+-]?{NUMBER})\s*([^\W\d][\w^*/·-]*|%)?\s*,?\s*")
_ITEMS = re.compile(rf"(?:{_ITEM.pattern})+")
_THOUSANDS = re.compile(r"(?<![\d,.])([1-9]\d{0,2}(?:,\d{3})+)(?![\d,])")
_LINK = re.compile(r"[^\W\d]\w*(?:\.\w+)*")
_DECIMAL = re.compile(r"(?<![\d,])(\d+),(?=\d+(?![\d,]))")
_ANGLED = re.compile(r"(?:rgb\w*\s*)?<([^<>{}\[\]\n]*)>")
EXACT = 40
"""Largest number of digits of a literal that is converted exactly and rounded once: 1.7 mm is the double nearest to
0.0017."""
_CROSSED = re.compile(rf"{NUMBER}\s*[a-zµ]*(?:\s*[x×]\s*{NUMBER}\s*[a-zµ]*)+")
LONGEST_CROSSED = 200


def read_unit(text: str, at: int, span: Span, *, below: bool = False) -> tuple[Unit | None, int]:
    """The unit behind a number that ends at ``at`` (None: there is none), and where the unit ends.

    A name, ``%`` or ``1/name`` there must be a unit; ``/name`` too, if ``below`` is set. Raises ScriptError.
    """
    start = _skip(text, at)
    word = _WORD.match(text, start)
    if word is not None and word.group() in OPERATIONS and text[_skip(text, word.end()) :][:1] == "(":
        message = "two values stand side by side"
        help = f"a vector of formulas is `[a, b, c]`, with brackets; for a product write `*{word.group()}(...)`"
        raise ScriptError([Diagnostic("syntax", message, span.part(*word.span()), help)])
    if not starts_unit(text, start) and not (below and text.startswith("/", start)):
        return None, at
    try:
        return scan_unit(text, start, span)
    except ScriptError as error:
        (found,) = error.diagnostics
        if found.code != "unknown-unit" or word is None:
            raise
        if sign_of(word.group()) is not None:
            raise
        if word.group()[:1] == "_" and at > 0 and text[at - 1].isdigit():  # 1_000
            digits = re.match(r"[\d_]*", text[at:]) or word
            first = re.search(r"[\d_]*$", text[:at]) or word
            help = f"digits stand together: write `{(first.group() + digits.group()).replace('_', '')}`"
            raise ScriptError([replace(found, help=help)]) from None
        if (other := instead("behind", word.group())) is not None:
            raise ScriptError([replace(found, help=other)]) from None
        if instead("unit", word.group()) is not None:
            raise
        digits_before = re.search(r"[\d.]*$", text[:at])
        factor = "" if digits_before is None or start > at else digits_before.group()
        hint = f"for a product write `{factor}*{word.group()[:40]}`"
        if word.group() in ("x", "y", "z"):
            number = re.search(r"[\d.]*$", text[:at]) or word
            raise ScriptError([replace(found, help=f"write `{number.group()}*{word.group()}` for a product")]) from None
        near = re.fullmatch(r"did you mean '(\w+)'\?", found.help or "")
        sure = near is not None and near[1] in UNITS and len(word.group()) > 1 and word.group() not in CONSTANTS
        sure = sure or re.fullmatch(r"write `[^`]*`", found.help or "") is not None
        both = hint if found.help is None else f"{found.help}; {hint}"
        raise ScriptError([found if sure else replace(found, help=both)]) from None


def quantity(number: str, unit: Unit | None, span: Span, divisor: str | None = None) -> Number:
    """The literal of a number, or of a fraction, in a unit. Raises ScriptError where it is not finite."""
    try:
        if divisor is None and (unit is None or (unit.ratio == 1 and unit.shift == 0)):
            value = _finite(number)
        else:
            exact = _exact(number) if divisor is None else _exact(number) / _exact(divisor)
            value = float(exact) if unit is None else unit.to_si(exact)
    except ZeroDivisionError:
        raise ScriptError([Diagnostic("syntax", "this divides by zero", span)]) from None
    except OverflowError:
        raise ScriptError([Diagnostic("syntax", "this number is too large", span)]) from None
    if unit is None:
        return Number(value, Type((), None) if value == 0.0 else Type(), span=span)
    return Number(value, Type((), unit.dimension), bare=False, span=span)


def _finite(number: str) -> float:
    value = float(number)
    if math.isinf(value):
        raise OverflowError
    return value


def _exact(number: str) -> Fraction:
    value = _finite(number)
    # Digits and exponents without limit would make numbers without limit.
    return Fraction(number) if len(number) <= EXACT and value != 0.0 else Fraction(value)


def whole_value(text: str, span: Span) -> Expr | None:
    """``1/60 s``, ``-4 0.15 0``, ``0 1.2 0 m``, ``0 1 0 /s``: numbers or fractions with one unit at most.

    None where the text is not of this form or is a single number, which are expressions. Raises ScriptError.
    """
    pieces: list[re.Match[str]] = []
    at = _skip(text, 0)
    while (piece := _PIECE.match(text, at)) is not None and (at == 0 or text[at - 1].isspace()):
        if piece.group() == "1" and text[piece.end() : piece.end() + 1] == "/" and pieces:
            break
        pieces.append(piece)
        at = _skip(text, piece.end())
    if not pieces or (len(pieces) == 1 and pieces[0][2] is None):
        return None
    # Behind one number a bar is a division, whose name may be a define.
    unit, end = read_unit(text, at, span, below=len(pieces) > 1) if at < len(text) else (None, at)
    if _skip(text, end) < len(text) or (len(pieces) == 1 and unit is None):
        return None
    items = [quantity(p[1], unit, span.part(*p.span()), p[2]) for p in pieces]
    if len(items) == 1:
        return Number(items[0].value, items[0].type, items[0].bare, span.part(pieces[0].start(), end))
    return Vector(tuple(items), span=span.part(pieces[0].start(), end))


def vector_meant(text: str) -> str | None:
    """The vector most likely meant by numbers with commas or with a unit each: ``1 2 3 m`` for ``1 m, 2 m, 3 m``.

    None where the text has no such form.
    """
    items: list[tuple[str, str]] = []
    at = 0
    while at < len(text) <= EXACT * 3:
        item = _ITEM.match(text, at)
        if item is None:
            return None
        items.append((item[1], item[2] or ""))
        at = item.end()
    units = sorted({unit for _, unit in items if unit})
    if len(items) < 2 or (len(units) > 1 and not all(unit for _, unit in items)):
        return None
    if len(units) > 1:
        return f"[{', '.join(f'{number} {unit}' for number, unit in items)}]"
    return " ".join([*(number for number, _ in items), *units])


def in_brackets(text: str, at: int = 0) -> str | None:
    """The vector in angle brackets at ``text[at]`` as a script writes it: ``[0, 1, 0]`` for ``<0, 1, 0>``, if any."""
    found = _ANGLED.match(text, at)
    return None if found is None else f"[{', '.join(one.strip() for one in found[1].split(','))}]"


def comma_meant(text: str, at: int = 0) -> str:
    """The help for a comma that cannot stand in the value at ``text[at]``: a decimal one, or one between components."""
    point = "a decimal number has a point"
    if (angled := in_brackets(text, at)) is not None:
        return f"a vector has square brackets: write `{angled}`"
    if (numbers := _ITEMS.match(text, at, at + 3 * EXACT)) is not None:
        text = numbers.group().strip(", \t\r\n")
    whole = _THOUSANDS.sub(lambda one: one[1].replace(",", ""), text.strip())
    if ", " not in text and whole != text.strip():
        return f"digits stand together: write `{whole}`; {point}"
    decimal = _DECIMAL.sub(r"\1.", text.strip())
    if ", " not in text and decimal != text.strip():
        return f"{point}: write `{decimal}`"
    names = [one.strip() for one in text.split(",")]
    if len(names) > 1 and all(_LINK.fullmatch(one) for one in names):
        return f"a list stands in brackets: write `[{', '.join(names)}]`"
    vector = vector_meant(text)
    return f"a vector is `0 1.2 0 m` or `[a, b, c]`, and {point}" if vector is None else f"write `{vector}`; {point}"


def _skip(text: str, at: int) -> int:
    found = _GAP.match(text, at)
    return at if found is None else found.end()


def with_points(text: str, span: Span) -> str | None:
    """A value with decimal commas as one with points, if it is one then; None for others."""
    points = re.sub(r"(?<=\d),(?=\d)", ".", text)
    try:
        return points.strip() if points != text and whole_value(points, span) is not None else None
    except ScriptError:
        return None


def crossed(text: str) -> str | None:
    """The help for sizes with crosses between them, ``1 x 2 x 3 m``."""
    crossed = len(text) <= LONGEST_CROSSED and _CROSSED.fullmatch(text.strip()) is not None
    sides = vector_meant(re.sub(r"\s*[x×]\s*", ", ", text.strip())) if crossed else None
    return f"write `{sides}`" if sides else None
