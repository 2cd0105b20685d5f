"""Reading of formulas in plain numbers, as `implicit` and `equations` take them."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import pi

from sceneql.compiler.meant.factors import remedy
from sceneql.compiler.names import Names
from sceneql.compiler.over_time import momentary
from sceneql.compiler.values import origin, parsed_text, read_value
from sceneql.compiler.vector_fields import PLACES
from sceneql.kinds import Quantity, Value
from sceneql.language.tree import Mapping, Node, Scalar, Sequence, unsure
from sceneql.quantities.bind import SECONDS, Lookup, bind
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError, suggestion
from sceneql.quantities.dimension import ANGLE, LENGTH, PERCENTAGE, PLAIN, TEMPERATURE, VOLUME, Dimension
from sceneql.quantities.expression import Expr, Link, Name, Number, Symbol, Type, Vector, walk
from sceneql.quantities.instead import instead
from sceneql.quantities.operations import CONSTANTS
from sceneql.quantities.parser import parse_expression
from sceneql.quantities.span import Span
from sceneql.quantities.units import describe, in_words, unit_of

AMOUNTS = ("rate", "strength", "amount", "value", "power", "flux", "intensity", "flow", "amplitude", "height")
"""Names of how much there is."""
SQUARE = 0.01
"""Square of the distance [m^2] at which the formula has fallen to 1/e."""
POINTS = ("p", "P", "pos", "position", "point", "pt", "xyz", "coord", "coords", "vertex")
"""Names of other programs for the place at which a field is evaluated."""
_RATE_OF = re.compile(r"d_?(\w+?)(?:_?dt)?|(\w+?)_?dot")
EXAMPLE = ((0.5, 0.5), 10.0)
"""Place [m] and peak of the formula where nothing is told."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """The dimension that a formula's values must have.

    ``of_any``: any former dimension of defines and outputs is accepted; ``at_start``: the formula is evaluated before
    the run, when no part has a value; ``by_of``: the model's `of` gives the dimension.
    """

    dimension: Dimension | None
    of_any: bool = False
    at_start: bool = False
    by_of: bool = False

    def suits(self, has: Dimension | None) -> bool:
        """Whether a formula of dimension ``has`` is accepted: one of the wanted dimension, or of a plain number in SI.

        The former dimension of a define or an output stays known while it is alone or in a sum of its like
        (Dimension.kind).
        """
        wanted = self.dimension
        if wanted is None or has is None or has == wanted:
            return True
        if not has.plain or has.kind in (ANGLE.kind, PERCENTAGE.kind):
            return False
        return self.of_any or has.kind in ("", describe(wanted))


def read_formula(
    node: Node, symbols: Iterable[str], wanted: Wanted, what: str, names: Names, found: Diagnostics
) -> Expr | None:
    """A formula over plain numbers, with ``symbols`` free and defines as plain numbers; None after reporting errors."""
    if isinstance(node, Sequence):
        items = [read_formula(item, symbols, wanted, what, names, found) for item in node.items]
        known = [item for item in items if item is not None]
        if len(known) < len(items):
            return None
        for item, place in zip(known, node.items, strict=True):
            if item.type.shape:
                found.error("wrong-shape", f"a component of {what} is one number, not several", place.span)
                return None
        return Vector(tuple(known), Type((len(known),), PLAIN), node.span)
    if unsure(node):
        return None
    if not isinstance(node, Scalar):
        help = _around_place(node, wanted.dimension, what, names) if "x" in symbols else None
        found.error("wrong-shape", f"{what} is a formula", node.span, help=help)
        return None
    free = set(symbols)

    def lookup(parts: tuple[str, ...], span: Span) -> Expr | Diagnostic | None:
        if len(parts) == 1 and parts[0] in free:
            return Symbol("time" if parts[0] == "t" else parts[0], Type((), PLAIN), span)
        lost = parts[0] in names.broken
        if parts[0] not in names.defines and parts[0] not in CONSTANTS and len(parts) == 1 and not lost:
            here = f"free here are {', '.join(sorted(free))}; other names stand under `define`, `{parts[0]}: 1`"
            rate = _RATE_OF.fullmatch(parts[0])
            prime = "" if rate is None else f"{rate[1] or rate[2]}'"
            help = f"did you mean `{prime}`?" if prime in free else suggestion(parts[0], [*free, *names.defines])
            help = _of_place(parts[0], free) or help or instead("function", parts[0]) or here
            if parts[0] == "time" and "t" in free:
                help = SECONDS
            return Diagnostic("unknown-name", f"nothing is called '{parts[0]}'", span, help)
        if len(parts) == 2 and parts[1] in free and parts[0] in POINTS and names.field(parts[0]) is None:
            help = f"the place is {', '.join(one for one in 'xyz' if one in free)} here: write `{parts[1]}`"
            return Diagnostic("unknown-name", f"nothing is called '{'.'.join(parts)}'", span, help)
        expr = names.lookup(parts, span)
        return expr if expr is None or isinstance(expr, Diagnostic) else names.plain(expr)

    own = Diagnostics()
    try:
        parsed = parse_expression(parsed_text(node), node.content)
        expr = bind(parsed, lookup, own)
        better = _without_units(parsed, node, free, lookup, own) if own.found else None
    except ScriptError as error:
        found.extend(error.diagnostics)
        return None
    found.extend(own.found if better is None else [replace(own.found[0], help=better, notes=())])
    if expr is None or not momentary(expr, node.span, found):
        return None
    link = next((part for part in walk(expr) if isinstance(part, Link)), None) if wanted.at_start else None
    if link is not None:
        found.error("invalid", f"'{link.task}.{link.output}' has no value before the start", link.span or node.span)
        return None
    if not wanted.suits(expr.type.dimension):
        message = f"{what} is {describe(wanted.dimension)}, but this is {in_words(expr.type.dimension)}"
        warm = wanted.by_of and expr.type.dimension == TEMPERATURE
        help = "what the model solves is a temperature where it says `of: temperature`" if warm else None
        help = help or remedy(expr, wanted.dimension)
        found.error("dimension-mismatch", message, node.span, help=help, notes=origin(expr, node.span))
        return None
    return expr


def _without_units(parsed: Expr, node: Scalar, free: set[str], lookup: Lookup, found: Diagnostics) -> str | None:
    """The help where only units are wrong, because the free symbols are plain numbers: the formula without units."""
    symbols = {n.parts[0] for n in walk(parsed) if isinstance(n, Name) and n.parts[0] in free}
    if not symbols or any(one.code != "dimension-mismatch" or one.help == SECONDS for one in found.found):
        return None
    text, start = node.content.text, node.content.start
    if parsed_text(node) != text:
        return None
    quantities = {n.span: n.value for n in walk(parsed) if isinstance(n, Number) and not n.bare and n.span is not None}
    for span in sorted(quantities, key=lambda span: -span.start):
        first, last = span.start - start, span.end - start
        if re.search(r"\(\s*$", text[:first]) and re.match(r"\s*\)", text[last:]) and quantities[span] >= 0:
            first, last = text.rindex("(", 0, first), text.index(")", last) + 1
        lost = re.search(r"[*/]\s*$", text[:first]) if quantities[span] == 1 else None
        number = "" if lost else f"{quantities[span]:.12g}"
        text = text[: lost.start() if lost else first] + number + text[last:]
    trial = Diagnostics()
    if bind(parse_expression(text, node.content), lookup, trial) is None or trial.found:
        return None
    names = sorted(symbols)
    these = f"`{names[0]}` is a plain number" if len(names) == 1 else f"`{'`, `'.join(names)}` are plain numbers"
    return f"{these} here: write all others without units too, `{' '.join(text.split())}`"


def _of_place(name: str, free: set[str]) -> str | None:
    """The help for the place as a vector, ``p``, or its distance from the origin, ``r``, where x and y are free."""
    axes = [one for one in "xyz" if one in free]
    if len(axes) < 2:
        return None
    if name in ("p", "pos", "position", "point", "P"):
        return f"the place is `[{', '.join(axes)}]`: write that for `{name}`"
    far = f"sqrt({' + '.join(f'{one}^2' for one in axes)})"
    return f"the distance from the origin is written `{far}`" if name in ("r", "rho", "R") else None


def _around_place(node: Node, wanted: Dimension | None, what: str, names: Names) -> str:
    """The help that writes a bell of the given place and amount as a formula, in SI units.

    ``wanted``: the dimension of the formula. An amount with that times a volume is what the whole bell gives.
    """
    fields = node.entries if isinstance(node, Mapping) else {}
    place = next((value for key, one in fields.items() if key in PLACES and (value := _read(one, LENGTH, names))), None)
    amount = None
    whole = False
    for key, one in fields.items() if wanted is not None else ():
        if key in AMOUNTS and wanted is not None:
            amount = _read(one, wanted, names)
            whole = amount is None
            amount = _read(one, wanted * VOLUME, names) if whole else amount
            break
    at = EXAMPLE[0] if place is None else tuple(place)
    peak = EXAMPLE[1] if amount is None else amount[0] / ((pi * SQUARE) ** (len(at) / 2) if whole else 1.0)
    away = " + ".join(_square(axis, value) for axis, value in zip("xyz", at, strict=False))
    away = away if len(at) == 1 else f"({away})"
    unit = "" if wanted is None or wanted.plain else f", in {unit_of(wanted)}"
    deep = ", for a depth of 1 m" if amount is not None and whole and len(at) == 2 else ""
    sides = [one.span.text for one in fields.values()]
    if place is None and amount is None and len(sides) == len(("low", "high")):
        return f"write it by place: `{what}: where(x < 0.5, {sides[0]}, {sides[1]})`, with the place of their border"
    return f"write one by place and time{unit}{deep}: `{what}: {peak:.3g}*exp(-{away}/{SQUARE:g})`"


def _square(axis: str, value: float) -> str:
    if value == 0.0:
        return f"{axis}^2"
    return f"({axis} {'-' if value > 0 else '+'} {abs(value):g})^2"


def _read(node: Node, dimension: Dimension, names: Names) -> tuple[float, ...] | None:
    """The numbers of a constant value in SI; None for another, or one of another dimension."""
    value = read_value(node, Quantity(dimension, None), "", names, Diagnostics())
    if not isinstance(value, Value) or not value.constant:
        return None
    number = value.number()
    return tuple(map(float, number)) if isinstance(number, tuple | list) else (float(number),)
