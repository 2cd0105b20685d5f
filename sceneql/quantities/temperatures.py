"""Temperatures on scales with another zero than 0 K, as 20 °C: sums and products whose meaning is unambiguous."""

from __future__ import annotations

from dataclasses import dataclass, field

from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Call, Expr, Number

COMPARISONS = ("lt", "le", "gt", "ge", "eq")


@dataclass(slots=True)
class Temperatures:
    """The operands of one expression that are temperatures by a literal in °C or °F, by the ids of their nodes."""

    _known: dict[int, tuple[Expr, Number, float]] = field(default_factory=dict)
    """(the node itself, so that no other gets its id; the literal; the literal's number as a difference [K])."""

    def add(self, literal: Number, difference: float) -> None:
        """Note a literal; ``difference`` is what its number is as a difference of temperatures [K]."""
        self._known[id(literal)] = literal, literal, difference

    def combine(self, whole: Call, *args: Expr) -> None:
        """Track the result of an operation on ``args``.

        Raises ScriptError (`offset-unit`) where its meaning is ambiguous.
        """
        known = [self._known.get(id(arg)) for arg in args]
        found = [one for one in known if one is not None]
        if not found or whole.op in COMPARISONS or (whole.op == "sub" and known[1] is not None):
            return
        _, literal, difference = found[-1]
        in_kelvin = f"{difference:.6g} K"
        if whole.op in ("add", "sub") and len(found) == 1:
            self._known[id(whole)] = whole, literal, difference
            return
        written = "" if literal.span is None else literal.span.text
        message = f"'{written}' may mean a temperature here, or a difference of two"
        help = f"write `{literal.value:.6g} K` for the temperature, `{in_kelvin}` for a difference"
        if whole.op == "add":
            message, help = "two temperatures have no sum", f"a difference of temperatures is in K: write `{in_kelvin}`"
        raise ScriptError([Diagnostic("offset-unit", message, literal.span, help)])
