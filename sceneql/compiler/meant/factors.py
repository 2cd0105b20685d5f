"""Help for quantities that lack a factor, or have a unit too many, or one with a prefix where two were meant."""

from __future__ import annotations

import re
from collections.abc import Collection

from sceneql.quantities.diagnostic import ScriptError
from sceneql.quantities.dimension import DENSITY, ENERGY, LENGTH, MASS, PLAIN, TEMPERATURE, TIME, Dimension, suits
from sceneql.quantities.expression import Call, Expr, Link, Number, Symbol, Vector, walk
from sceneql.quantities.instead import of_unit, unit_meant
from sceneql.quantities.parser import parse_value
from sceneql.quantities.spaced import apart
from sceneql.quantities.unit_table import UNITS
from sceneql.quantities.units import describe, unit_of

_MISSING = (
    (DENSITY, "(1000 kg/m^3)", "a density"),
    (ENERGY / TEMPERATURE, "(4.2e6 J/K)", "what all of it takes to be a kelvin warmer"),
    (LENGTH**3 / MASS / TIME**2, "(6.674e-11 m^3/(kg*s^2))", "the constant of gravity"),
    (DENSITY * ENERGY / MASS / TEMPERATURE, "(4.2e6 J/(K*m^3))", "what a volume takes to be a kelvin warmer"),
)
"""(dimension, an example of it, its name) of what turns a quantity to one that goes by a similar name: kinematic
viscosity to dynamic, conductivity to diffusivity."""
_A_SECOND = re.compile(r"(\d+\.?\d*)\s*(?:1?/\s*s|Hz)")
OF_METALS = 10.0
"""Conductivity [W/(m K)] from which on it is a metal's."""


def remedy(expr: Expr, wanted: Dimension | None) -> str | None:
    """The help where a quantity lacks a factor, or has a unit with a prefix where two units were meant."""
    here = "" if expr.span is None else expr.span.text
    if (other := unit_meant(here, expr.type.dimension, wanted)) is not None:
        return other
    text = None if expr.span is None or isinstance(expr, Link) else apart(expr.span.text)
    if text is not None and expr.span is not None:
        try:
            meant = parse_value(text, expr.span)
        except ScriptError:
            return _factor(expr, wanted)
        one = meant.items[0] if isinstance(meant, Vector) else meant
        if isinstance(one, Number) and suits(one.type.dimension, wanted):
            return f"two units have a sign between them: write `{text}`"
    return _product(expr, wanted) or _factor(expr, wanted) or of_unit(here) or _counted(here, wanted)


def _counted(text: str, wanted: Dimension | None) -> str | None:
    """The help for what is counted in a second where it is a plain number: frames, `25 /s`."""
    found = _A_SECOND.fullmatch(text)
    return f"it has no unit: write `{found[1]}`" if found is not None and wanted == PLAIN else None


def _product(expr: Expr, wanted: Dimension | None) -> str | None:
    """The help for a product of a named value and a number whose unit is one too many: for a length, `r * 2 m`."""
    has = expr.type.dimension
    if expr.span is None or has is None or wanted is None:
        return None
    text = expr.span.text
    for found in re.finditer(r"(?<![\w.])(\d[\d.]*)\s*([a-zA-Z]+)(?![\w^/*])", text):
        unit = UNITS.get(found[2])
        if unit is not None and "*" in text and wanted * unit[1] == has:
            rest = text[: found.end(1)] + text[found.end() :]
            return f"the names in it have units already, and the product has one too many: write `{rest}`"
    return None


def _factor(expr: Expr, wanted: Dimension | None) -> str | None:
    """The help where a formula of names lacks a factor of time or length: for the length `1 m*time`, 1/(1 s)."""
    has = expr.type.dimension
    if has is not None and wanted is not None and expr.span is not None:
        metal = isinstance(expr, Number) and isinstance(expr.value, float | int) and expr.value > OF_METALS
        for kind, factor, word in _MISSING:
            factor = factor.replace("4.2e6 J/(K*m", "3.5e6 J/(K*m") if metal else factor  # of water
            if has * kind == wanted:
                return f"multiply it by {word}: write `{expr.span.text}*{factor}`"
            if has / kind == wanted:
                return f"divide it by {word}: write `{expr.span.text}/{factor}`"
    if has is None or wanted is None or expr.span is None or not any(isinstance(n, Symbol | Link) for n in walk(expr)):
        return None
    text = f"({expr.span.text})" if re.search(r"[-+<>=]", expr.span.text) else expr.span.text
    for dimension, sign in ((has / wanted, "/"), (wanted / has, "*")):
        if dimension in (TIME, LENGTH):
            word = "divide it by" if sign == "/" else "multiply it by"
            return f"{word} {describe(dimension)}: write `{text}{sign}(1 {unit_of(dimension)})`"
    unit = unit_of(wanted / has)
    one = next((item for item in expr.items if not is_zero(item)), expr) if isinstance(expr, Vector) else expr
    text = text if one.span is None else one.span.text
    if isinstance(one, Call) and one.op in ("component", "item") and isinstance(one.args[0], Link):
        return None  # its number says which one
    if unit != "1" and any(isinstance(node, Number) and node.bare and node.value != 0 for node in walk(expr)):
        return f"a number in it has no unit: write `{text}*(1 {unit})`, or `{unit}` behind that number"
    return None


def each_by_unit(items: Collection[Expr], wanted: Dimension | None) -> str | None:
    """The help for a list of several quantities where any is taken, as the curves of a graph: each by its unit."""
    texts = [
        f"{one.span.text}/(1 {unit_of(one.type.dimension)})"
        for one in items
        if isinstance(one, Link | Call) and one.span is not None and one.type.dimension is not None
    ]
    if wanted is not None or len(texts) < len(items):
        return None
    return f"divide each by its unit: write `[{', '.join(texts)}]`; or show each in a graph of its own"


def is_zero(expr: Expr) -> bool:
    """Whether an expression is a 0 without a unit, which is of any dimension."""
    return isinstance(expr, Number) and expr.value == 0 and expr.bare
