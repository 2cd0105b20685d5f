"""Reading of texts with values in braces, ``E = {cage.energy:.2f J}``; doubled braces are literal."""

from __future__ import annotations

import re
from itertools import pairwise

from sceneql.compiler.names import Names
from sceneql.compiler.over_time import momentary
from sceneql.compiler.values import parsed_text, scalar_expr
from sceneql.kinds import Interpolated, Text, TextValue, Value
from sceneql.kinds.texts import FORM, overlong
from sceneql.language.behind_quotes import without_letters
from sceneql.language.tree import Node, Scalar, unsure
from sceneql.quantities.diagnostic import Diagnostics, ScriptError
from sceneql.quantities.expression import Shape
from sceneql.quantities.span import Span
from sceneql.quantities.units import Unit, describe, parse_unit, unit_of

_WORD = re.compile(r"\s?([^\W\d]\w*(?:[/*^]\w+)*)")
_NUMBERED = r"(?<!\\)\\(?:x[\da-fA-F]{2}|u[\da-fA-F]{4}|U[\da-fA-F]{8})"
_PRINTED = re.compile(r"%(\.\d+[efg])")
_TEX = re.compile(r"\$([^${}]*[\\^_=][^$]*)\$")
"""A formula of TeX between dollar signs."""
LONGEST_TEX = 500
"""Longest text in which a formula is looked for."""
_UNIT_BEHIND = re.compile(r"\}\s?((?:[µ°]?[A-Za-z]{1,3}|°)(?:[/*^][\w^]+)*)(?![\w(])")
"""A unit directly behind a value's braces."""
_DOLLAR = re.compile(r"\$([^\W\d]\w*)")
_TO_FIXED = re.compile(r"\$?\{([^{}]+?)\.toFixed\((\d)\)\}")
_SIGN = re.compile(r"\$(\{[^{}]*\})")
_LINK = re.compile(r"[^\W\d]\w*(?:\.\w+)+")
PIECE = re.compile(r"\{\{|\}\}|\{(?P<inside>[^{}]*)\}|(?P<odd>[{}])")


def read_text(node: Node, mark: Interpolated, what: str, names: Names, found: Diagnostics) -> Text | None:
    """The text of a scalar; None after reporting errors."""
    if not isinstance(node, Scalar):
        help = None if unsure(node) else f'put it in quotes: `{what}: "{node.span.text}"`'
        found.error("wrong-shape", f"{what} is a text", node.span, help=help)
        return None
    if not node.quoted and (inner := without_letters(node.text)) is not None:
        help = f"values stand in braces in every text: write `{inner}`"
        found.error("syntax", "no letter stands before the quotes of a text", node.span, help=help)
        return None
    if said := overlong(node.text):
        found.error("limit-refused", said, node.span)
        return None
    text, start = parsed_text(node), node.content.start
    if len(text) <= LONGEST_TEX and (tex := _TEX.search(text)) is not None:
        help = f"TeX stands in a formula, `{{formula: {{tex: '{tex[1].strip()}'}}}}`: `sceneql words formula`"
        found.warning("tex-in-text", "this is drawn as it stands, with its dollar signs", node.span, help=help)
    same = text == node.content.text
    if _LINK.fullmatch(text.strip()) is not None and names.gives(text.strip()):
        help = f'a text has its values in braces: write `{what}: "{{{text.strip()}:.2f}}"`'
        found.error("syntax", f"'{text.strip()}' would be drawn as it stands", node.span, help=help)
        return None
    if (fixed := _TO_FIXED.search(text)) is not None:
        behind = re.match(r"\s?([^\W\d][\w/^*]*)?", text[fixed.end() :])
        unit = f" {behind[1]}" if behind is not None and behind[1] else ""
        rest = text[fixed.end() + (behind.end() if behind is not None and unit else 0) :]
        help = f'write `{what}: "{text[: fixed.start()]}{{{fixed[1]}:.{fixed[2]}f{unit}}}{rest}"`'
        found.error("syntax", f"'{fixed[0]}' would be drawn as it stands", node.span, help=help)
        return None
    pieces: list[str | TextValue] = []
    at, ok = 0, True
    for piece in PIECE.finditer(text):
        pieces.append(text[at : piece.start()])
        at = piece.end()
        if piece["odd"] is not None:
            help = "values stand as `{time:.2f s}`, and a brace that is meant as one is written twice"
            place = Span(node.source, start + piece.start(), start + piece.end()) if same else node.span
            found.error("syntax", f"this '{piece[0]}' has no partner", place, help=help)
            ok = False
        elif piece["inside"] is None:
            pieces.append(piece[0][0])
        else:
            told = _told(node, piece["inside"], start + piece.start("inside") if same else None, mark, names, found)
            ok = ok and told is not None
            pieces += [] if told is None else [told]
    pieces.append(text[at:])
    if (form := _PRINTED.search(text)) is not None:
        help = f"a text has its values in braces, and behind a colon their form: `{{ball.position.y:{form[1]}}}`"
        values = re.fullmatch(r"\s*([^\W\d]\w*(?:\.\w+)*)\s*", text.rpartition(",")[2])
        behind = re.match(r"\s*([^\W\d][\w/^*]*)?", text[form.end() :])
        unit = f" {behind[1]}" if behind is not None and behind[1] else ""
        if values is not None and "," in text[form.end() :]:
            whole = f"{text[: form.start()]}{{{values[1]}:{form[1]}{unit}}}"
            help = f'a text has its values in braces, with their form and unit: write `"{whole}"`'
        if text[: form.start()].endswith(":"):  # {energy:%.2f}
            rest = text[form.end() :]
            behind = _UNIT_BEHIND.match(rest)
            rest = rest if behind is None else f" {behind[1]}}}{rest[behind.end() :]}"
            help = f'write `{what}: "{text[: form.start()]}{form[1]}{rest}"`'
        found.error("syntax", f"'{form[0]}' would be drawn as it stands", node.span, help=help)
        return None
    if (sign := _SIGN.search(text)) is not None:
        help = f"values stand in braces alone: write `{sign[1]}`"
        found.error("syntax", "a '$' before braces would be drawn as it stands", node.span, help=help)
        return None
    if (bare := _DOLLAR.search(text)) is not None and (bare[1] == "time" or bare[1] in names.defines):
        shown = ":.1f s" if bare[1] == "time" else ""
        help = f"a text has its values in braces: write `{{{bare[1]}{shown}}}`"
        found.error("syntax", f"'{bare[0]}' would be drawn as it stands", node.span, help=help)
        return None
    ok = ok and not _twice(pieces, node.span, found)
    return Text(tuple(one for one in pieces if one)) if ok else None


def unescaped(node: Scalar) -> str | None:
    """A text in double quotes with backslashes before letters, as single quotes keep it; None for others.

    The number of a character, as `\\u03b1`, is YAML's and nothing else.
    """
    written = re.sub(_NUMBERED, "", node.span.text)
    if not node.quoted or written[:1] != '"' or re.search(r"(?<!\\)(?:\\\\)*\\[a-zA-Z_]", written) is None:
        return None
    written = node.span.text
    return "'" + written[1:-1].replace("'", "''") + "'"


def _twice(pieces: list[str | TextValue], place: Span, found: Diagnostics) -> bool:
    """Whether the unit of a value stands behind its braces, too: the value tells it."""
    for piece, behind in pairwise(pieces):
        if not isinstance(piece, TextValue) or piece.unit is None or not isinstance(behind, str):
            continue
        word = _WORD.match(behind)
        try:
            unit = None if word is None else parse_unit(word[1], place)
        except ScriptError:
            continue
        if unit is not None and unit.dimension == piece.unit.dimension:
            value = "" if piece.value.span is None else piece.value.span.text
            write = f"{{{value}:{piece.form} {unit.text}}}"
            told = f"'{unit.text}' behind these braces would stand there twice"
            help = f"a value tells its unit itself: write `{write}`, and none behind the braces"
            if (whole := _once(place.text, unit.text)) is not None:
                help = f"a value tells its unit itself: write `{whole}`"
            found.error("unit-twice", told, place, help=help)
            return True
    return False


def _once(text: str, unit: str) -> str | None:
    """A text with the only unit of this name that stands behind braces in the braces; None where there are more."""
    pattern = re.compile(
        rf"\{{([^{{}}:]*)(?::([^{{}}\s]*))?(?:\s+{re.escape(unit)})?\}}\s?{re.escape(unit)}(?![\w/*^])"
    )
    found = pattern.findall(text)
    return pattern.sub(lambda one: f"{{{one[1]}:{one[2] or ''} {unit}}}", text) if len(found) == 1 else None


def _told(
    node: Scalar, inside: str, start: int | None, mark: Interpolated, names: Names, found: Diagnostics
) -> TextValue | None:
    """The value between two braces; None after reporting errors.

    ``start``: its offset in the source; None where that is not known.
    """
    expression, _, rest = inside.partition(":")
    if rest.startswith("%"):
        return None  # the text as a whole is reported
    begin, end = node.start, node.end
    if start is not None:
        begin = start + len(expression) - len(expression.lstrip())
        end = begin + len(expression.strip())
    part = Scalar(expression.strip(), "text", False, node.source, begin, end)
    expr = scalar_expr(part, names, found)
    if expr is None:
        return None
    if expr.type.shape:
        help = _of_several(part.text, rest, expr.type.shape)
        found.error("wrong-shape", "a text tells single values; take a component, such as `.x`", part.span, help=help)
        return None
    if not mark.over_time and not momentary(expr, part.span, found):
        return None
    form = FORM.match(rest)
    assert form is not None  # it matches the empty text too
    unit_text = rest[form.end() :].lstrip()
    place = node.span if start is None else Span(node.source, start + len(inside) - len(unit_text), start + len(inside))
    try:
        unit = _unit(unit_text, expr.type.dimension, place)
    except ScriptError as error:
        found.extend(error.diagnostics)
        return None
    if unit is not None and unit.dimension != expr.type.dimension:
        message = f"this is {describe(expr.type.dimension)}, which {unit_text.strip()} is no unit of"
        found.error("dimension-mismatch", message, place)
        return None
    return TextValue(Value(expr, part.span), form[0], unit)


def _of_several(name: str, rest: str, shape: Shape) -> str | None:
    """The help for a vector, or the values of a field or of many, in place of one value of a text."""
    form = f":{rest}" if rest else ""
    if shape == (3,):
        return f"write `{{length({name}){form}}}` for its size, or `{{{name}.x{form}}}`"
    if shape == (None,):
        return f"write `{{mean({name}){form}}}`, or `{{max({name}){form}}}`: it is a number at each place"
    return f"write `{{item({name}, 0).x{form}}}`, of the first" if shape == (None, 3) else None


def _unit(text: str, dimension: object, place: Span) -> Unit | None:
    """The unit written behind the value, else the coherent SI unit; None for plain numbers."""
    if text:
        return parse_unit(text, place)
    own = "1" if dimension is None else unit_of(dimension)  # type: ignore[arg-type]
    return None if own == "1" else parse_unit(own)
