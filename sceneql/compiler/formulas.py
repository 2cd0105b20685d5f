"""Nodes to textbook formulas, as `implicit` and `equations` take them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from sceneql.compiler.names import Names
from sceneql.compiler.over_time import momentary
from sceneql.compiler.values import origin, parsed_text
from sceneql.language.tree import Node, Scalar, Sequence, unsure
from sceneql.quantities.bind import SECONDS, bind
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError, suggestion
from sceneql.quantities.dimension import ANGLE, PERCENTAGE, PLAIN, Dimension
from sceneql.quantities.expression import Expr, Link, Symbol, Type, Vector, walk
from sceneql.quantities.operations import CONSTANTS
from sceneql.quantities.parser import parse_expression
from sceneql.quantities.span import Span
from sceneql.quantities.units import describe, in_words


@dataclass(frozen=True, slots=True)
class Wanted:
    """The dimension of a formula's values. ``of_any``: what a define or an output was is not asked; ``at_start``: it is
    evaluated before the run, when no part has a value."""

    dimension: Dimension | None
    of_any: bool = False
    at_start: bool = False

    def suits(self, has: Dimension | None) -> bool:
        """Whether a formula may be of a dimension: of this one, or a plain number in SI.

        What a define or an output was stays known while it is alone or in a sum of its like (Dimension.kind).
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
    """A textbook formula over plain numbers: the symbols are free, defines come in as plain numbers."""
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
        found.error("wrong-shape", f"{what} is a formula", node.span)
        return None
    free = set(symbols)

    def lookup(parts: tuple[str, ...], span: Span) -> Expr | Diagnostic | None:
        if len(parts) == 1 and parts[0] in free:
            return Symbol("time" if parts[0] == "t" else parts[0], Type((), PLAIN), span)
        lost = parts[0] in names.broken
        if parts[0] not in names.defines and parts[0] not in CONSTANTS and len(parts) == 1 and not lost:
            help = suggestion(parts[0], [*free, *names.defines]) or "free here are " + ", ".join(sorted(free))
            if parts[0] == "time" and "t" in free:
                help = SECONDS
            return Diagnostic("unknown-name", f"nothing is called '{parts[0]}'", span, help)
        expr = names.lookup(parts, span)
        return expr if expr is None or isinstance(expr, Diagnostic) else names.plain(expr)

    try:
        expr = bind(parse_expression(parsed_text(node), node.content), lookup, found)
    except ScriptError as error:
        for diagnostic in error.diagnostics:
            found.add(diagnostic)
        return None
    if expr is None or not momentary(expr, node.span, found):
        return None
    link = next((part for part in walk(expr) if isinstance(part, Link)), None) if wanted.at_start else None
    if link is not None:
        found.error("invalid", f"'{link.task}.{link.output}' has no value before the start", link.span or node.span)
        return None
    if not wanted.suits(expr.type.dimension):
        message = f"{what} is {describe(wanted.dimension)}, but this is {in_words(expr.type.dimension)}"
        found.error("dimension-mismatch", message, node.span, notes=origin(expr, node.span))
        return None
    return expr
