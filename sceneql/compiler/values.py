"""Nodes to quantities in time: constants, expressions, links, vectors and keyframes, with their dimensions checked."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any, get_args

from sceneql.compiler.names import Names, plain
from sceneql.compiler.over_time import momentary
from sceneql.kinds import Quantity, Value
from sceneql.language.tree import Mapping as MappingNode
from sceneql.language.tree import Node, Scalar, Sequence
from sceneql.quantities.bind import bind
from sceneql.quantities.diagnostic import Diagnostics, ScriptError, suggestion
from sceneql.quantities.dimension import PLAIN, TIME, Dimension
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import (
    Call,
    Expr,
    Key,
    Keys,
    Link,
    Number,
    Shape,
    Symbol,
    Type,
    Vector,
    walk,
)
from sceneql.quantities.operations import CONSTANTS
from sceneql.quantities.parser import parse_expression, parse_value
from sceneql.quantities.printing import describe
from sceneql.quantities.span import Span
from sceneql.quantities.units import unit_of

PLAIN_NUMBER = Quantity(PLAIN)
CURVES = ("step", "linear", "smooth", "cubic")
KEY_FIELDS = ("value", "slope", "slope_in", "slope_out")
COMPONENTS = ("x", "y", "z")


def read_value(node: Node, quantity: Quantity, what: str, names: Names, found: Diagnostics) -> Value | None:
    """A value of the quantity's type, or None after reporting what is wrong."""
    expr = read_expr(node, quantity.shape, quantity.dimension, what, names, found)
    if expr is None or not _fits(expr, quantity, what, node.span, found):
        return None
    if not quantity.over_time and not momentary(expr, node.span, found):
        return None
    return Value(expr, node.span)


def read_expr(
    node: Node, shape: Shape | None, dimension: Dimension | None, what: str, names: Names, found: Diagnostics
) -> Expr | None:
    """The bound tree of a scalar, list or keyframe node; the type is not yet compared with what is wanted."""
    match node:
        case Scalar():
            return scalar_expr(node, names, found)
        case Sequence():
            inner = shape[1:] if shape is not None and len(shape) > 1 else ()
            items = [read_expr(item, inner, dimension, what, names, found) for item in node.items]
            if any(item is None for item in items):
                return None
            known = [item for item in items if item is not None]
            if not known:
                return Vector((), Type((0, *inner), dimension), node.span)
            return _vector(known, what, node.span, found)
        case MappingNode():
            if "keys" in node.entries:
                return _keys(node, shape, dimension, what, names, found)
            if shape == (3,):
                return _by_component(node, dimension, what, names, found)
            found.error("wrong-shape", f"{what} is a value, not a group of fields", node.span)
    return None


def scalar_expr(node: Scalar, names: Names, found: Diagnostics) -> Expr | None:
    """The bound tree of a scalar's text."""
    text = parsed_text(node)
    if not text.strip():
        found.error("missing-value", "a value is missing here", node.span)
        return None
    try:
        return bind(parse_value(text, node.content), names.lookup, found)
    except ScriptError as error:
        for diagnostic in error.diagnostics:
            found.add(diagnostic)
        return None


def parsed_text(node: Scalar) -> str:
    """The text to parse: the source's own characters where they say the same, so that carets point into them."""
    raw = node.content.text
    return raw if " ".join(raw.split()) == " ".join(node.text.split()) else node.text


def read_formula(node: Node, symbols: Iterable[str], what: str, names: Names, found: Diagnostics) -> Expr | None:
    """A textbook formula over plain numbers: the symbols are free, defines come in as plain numbers."""
    if isinstance(node, Sequence):
        items = [read_formula(item, symbols, what, names, found) for item in node.items]
        if any(item is None for item in items):
            return None
        return Vector(tuple(item for item in items if item is not None), Type((len(items),), PLAIN), node.span)
    if not isinstance(node, Scalar):
        found.error("wrong-shape", f"{what} is a formula", node.span)
        return None
    free = set(symbols)

    def lookup(parts: tuple[str, ...], span: Span) -> Expr | None:
        if len(parts) == 1 and parts[0] in free:
            return Symbol("time" if parts[0] == "t" else parts[0], Type((), PLAIN), span)
        if parts[0] not in names.defines and parts[0] not in CONSTANTS and len(parts) == 1:
            found.error(
                "unknown-name",
                f"nothing is called '{parts[0]}'",
                span,
                help=suggestion(parts[0], [*free, *names.defines]) or "free here are " + ", ".join(sorted(free)),
            )
            return None
        expr = names.lookup(parts, span)
        return None if expr is None else plain(expr)

    try:
        expr = bind(parse_expression(parsed_text(node), node.content), lookup, found)
    except ScriptError as error:
        for diagnostic in error.diagnostics:
            found.add(diagnostic)
        return None
    return expr if expr is None or momentary(expr, node.span, found) else None


def _vector(items: list[Expr], what: str, span: Span, found: Diagnostics) -> Expr | None:
    inner = items[0].type.shape
    dimension = next((i.type.dimension for i in items if i.type.dimension is not None and not _zero(i)), PLAIN)
    for item in items:
        other = item.type.dimension
        if item.type.shape != inner:
            found.error("wrong-shape", f"the items of {what} differ in their number of components", item.span or span)
            return None
        if other is not None and other != dimension and not _zero(item):
            found.error(
                "dimension-mismatch",
                f"the components of {what} differ: {describe(dimension)} and {describe(other)}",
                item.span or span,
            )
            return None
    return Vector(tuple(items), Type((len(items), *inner), dimension), span)


def _by_component(
    node: MappingNode, dimension: Dimension | None, what: str, names: Names, found: Diagnostics
) -> Expr | None:
    for key in node.entries:
        if key not in COMPONENTS:
            found.error(
                "unknown-field",
                f"{what} has the components x, y, z, not '{key}'",
                node.keys[key].span,
                help=suggestion(key, (*COMPONENTS, "keys")),
            )
            return None
    quantity = Quantity(dimension or PLAIN)
    items: list[Expr] = []
    for key in COMPONENTS:
        if key not in node.entries:
            items.append(Number(0.0, Type((), quantity.dimension)))
            continue
        value = read_value(node.entries[key], quantity, f"{what}.{key}", names, found)
        if value is None:
            return None
        items.append(value.expr)
    return Vector(tuple(items), Type((3,), quantity.dimension), node.span)


def _keys(
    node: MappingNode, shape: Shape | None, dimension: Dimension | None, what: str, names: Names, found: Diagnostics
) -> Expr | None:
    shape = shape or ()
    quantity = Quantity(dimension or PLAIN, shape)
    of_slope = Quantity((dimension or PLAIN) / TIME, shape)

    def value(item: Node) -> Expr | None:
        read = read_value(item, quantity, what, names, found)
        return None if read is None else read.expr

    def slope(item: Node) -> Expr | None:
        read = read_value(item, of_slope, f"{what}'s slope", names, found)
        return None if read is None else read.expr

    return read_keys(node, what, value, slope, Type(shape, quantity.dimension), names, found)


def read_keys(
    node: MappingNode, what: str, value: Any, slope: Any, type_: Type, names: Names, found: Diagnostics
) -> Expr | None:
    """Keyframes; ``value`` and ``slope`` read one key's. Key times are constant and increase."""
    ok = True
    for key in node.entries:
        if key not in ("keys", "curve", "cycle", "delay"):
            hint = suggestion(key, ("keys", "curve", "cycle", "delay"))
            found.error("unknown-field", f"keyframes have no field '{key}'", node.keys[key].span, help=hint)
            ok = False
    table = node.entries["keys"]
    if not isinstance(table, MappingNode) or not table.entries:
        found.error("wrong-shape", "keys are written `{time: value, ...}`", table.span)
        return None
    keys: list[Key] = []
    last = -math.inf
    for name, item in table.entries.items():
        at = read_value(table.keys[name], Quantity(TIME), "a key's time", names, found)
        slopes: dict[str, Expr | None] = {}
        if isinstance(item, MappingNode) and "value" in item.entries:
            for extra in [key for key in item.entries if key not in KEY_FIELDS]:
                hint = suggestion(extra, KEY_FIELDS)
                found.error("unknown-field", f"a key has no field '{extra}'", item.keys[extra].span, help=hint)
                ok = False
            slopes = {key: slope(item.entries[key]) for key in KEY_FIELDS[1:] if key in item.entries}
            item = item.entries["value"]
        read = value(item)
        if at is None or read is None or any(s is None for s in slopes.values()):
            ok = False
            continue
        if not at.constant:
            found.error("not-constant", "a key's time must be constant", table.keys[name].span)
            ok = False
            continue
        now = at.number()
        if now <= last:
            found.error("keys-order", "the times of keys must increase", table.keys[name].span)
            ok = False
        last = now
        both = slopes.get("slope")
        keys.append(Key(at.expr, read, slopes.get("slope_in", both), slopes.get("slope_out", both)))
    curve = _curve(node, found)
    cycle = _time_field(node, "cycle", names, found)
    delay = _time_field(node, "delay", names, found)
    if not ok or curve is None:
        return None
    argument: Expr = Symbol("time", Type((), TIME))
    if delay is not None:
        argument = Call("sub", (argument, delay), Type((), TIME))
    return Keys(argument, tuple(keys), curve, cycle, type_, node.span)


def _curve(node: MappingNode, found: Diagnostics) -> Any:
    if "curve" not in node.entries:
        return "smooth"
    item = node.entries["curve"]
    text = item.text if isinstance(item, Scalar) else ""
    if text in CURVES:
        return text
    hint = suggestion(text, CURVES) or "one of " + ", ".join(CURVES)
    found.error("unknown-choice", f"curve cannot be '{text}'", item.span, help=hint)
    return None


def _time_field(node: MappingNode, name: str, names: Names, found: Diagnostics) -> Expr | None:
    if name not in node.entries:
        return None
    value = read_value(node.entries[name], Quantity(TIME), name, names, found)
    return None if value is None else value.expr


def _fits(expr: Expr, quantity: Quantity, what: str, span: Span, found: Diagnostics) -> bool:
    if quantity.shape is not None and not _shape_fits(expr.type.shape, quantity.shape):
        found.error(
            "wrong-shape",
            f"{what} is {_shape_text(quantity.shape)}, not {_shape_text(expr.type.shape)}",
            span,
        )
        return False
    has = expr.type.dimension
    # A plain number stands for SI in any field.
    if quantity.dimension is not None and has is not None and has != quantity.dimension and not has.plain:
        found.error(
            "dimension-mismatch",
            f"{what} is {describe(quantity.dimension)}, but this is {describe(has)}",
            span,
        )
        return False
    if quantity.direction and Value(expr).constant and not any(_numbers(evaluate(expr, {}))):
        found.error("out-of-range", f"{what} gives a direction, which 0 0 0 does not have", span)
        return False
    if quantity.needs_unit and _bare(expr):
        found.error("unit-needed", f"{what} needs a unit", span, help=f"write `{span.text} deg` or `{span.text} rad`")
        return False
    return True


def _bare(expr: Expr) -> bool:
    numbers = [node for node in walk(expr) if isinstance(node, Number)]
    names = any(isinstance(node, Symbol | Link) for node in walk(expr))
    return not names and all(n.bare for n in numbers) and any(n.value != 0 for n in numbers)


def _zero(expr: Expr) -> bool:
    return isinstance(expr, Number) and expr.value == 0 and expr.bare


def _shape_fits(has: Shape, wanted: Shape) -> bool:
    if len(has) != len(wanted):
        return False
    return all(b is None or a is None or a == b for a, b in zip(has, wanted, strict=True))


def _shape_text(shape: Shape) -> str:
    if not shape:
        return "a single value"
    if len(shape) == 1:
        return "a list of values" if shape[0] is None else f"a vector of {shape[0]}"
    return "a list of points"


def finite(number: Any) -> bool:
    """Whether a number, or all numbers of nested tuples, are finite."""
    if isinstance(number, tuple):
        return all(finite(item) for item in number)
    return math.isfinite(number)


_LIMITS: Mapping[str, tuple[Callable[[float, float], bool], str]] = {
    "above": (lambda x, limit: x > limit, "above"),
    "at_least": (lambda x, limit: x >= limit, "at least"),
    "below": (lambda x, limit: x < limit, "below"),
    "at_most": (lambda x, limit: x <= limit, "at most"),
}


def check_limits(
    value: Any, limits: Mapping[str, float], what: str, annotation: Any, span: Span, found: Diagnostics
) -> None:
    """Report a constant that lies outside its field's range, or is not finite."""
    if isinstance(value, Value):
        if not value.constant:
            return
        value = evaluate(value.expr, {})
        if not finite(value):
            found.error("not-finite", f"{what} is not a finite number", span)
            return
    if not limits:
        return
    for number in _numbers(value):
        for limit, bound in limits.items():
            holds, word = _LIMITS[limit]
            if not holds(number, bound):
                asked, given = (_told(one, annotation) for one in (bound, number))
                found.error("out-of-range", f"{what} must be {word} {asked}, not {given}", span)
                return


def _numbers(value: Any) -> list[float]:
    if isinstance(value, tuple | list):
        return [number for item in value for number in _numbers(item)]
    return [float(value)] if isinstance(value, int | float) and not isinstance(value, bool) else []


def _told(number: float, annotation: Any) -> str:
    """A number in SI with the unit in which a field's range is told."""
    quantity = _quantity(annotation)
    if quantity is None or quantity.dimension is None:
        return f"{number:g}"
    if quantity.needs_unit and quantity.dimension.plain:
        return f"{math.degrees(number):g} deg"
    return f"{number:g}" if quantity.dimension.plain else f"{number:g} {unit_of(quantity.dimension)}"


def _quantity(annotation: Any) -> Quantity | None:
    """The first quantity that a type names."""
    parts = get_args(annotation)
    marks = [part for part in parts if isinstance(part, Quantity)]
    inner = (_quantity(part) for part in parts if not isinstance(part, str | Quantity))
    return marks[0] if marks else next((found for found in inner if found is not None), None)
