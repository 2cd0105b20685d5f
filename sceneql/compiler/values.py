"""Reading of time-varying quantities: constants, expressions, links, vectors and keyframes, with dimensions checked."""

from __future__ import annotations

import math
import re
from dataclasses import replace

from sceneql.compiler.keyframes import ReadTime, read_keys
from sceneql.compiler.limits import numbers
from sceneql.compiler.meant.factors import each_by_unit, is_zero, remedy
from sceneql.compiler.meant.together import times_meant
from sceneql.compiler.names import Names
from sceneql.compiler.over_time import momentary
from sceneql.compiler.vector_fields import TURN, keys_meant, pair_meant, timed, vector_meant_by
from sceneql.kinds import Quantity, Value
from sceneql.language.tree import Mapping as MappingNode
from sceneql.language.tree import Node, Scalar, Sequence, unsure
from sceneql.quantities.diagnostic import Diagnostics, Note, ScriptError, suggestion
from sceneql.quantities.dimension import (
    ANGLE,
    FORCE,
    FREQUENCY,
    LENGTH,
    MASS,
    PERCENTAGE,
    PLAIN,
    TIME,
    Dimension,
    common,
    suits,
)
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Expr, Keys, Link, Number, Shape, Symbol, Type, Vector, walk
from sceneql.quantities.instead import power_of_ten
from sceneql.quantities.literal import vector_meant
from sceneql.quantities.spaced import parted_meant
from sceneql.quantities.span import Span
from sceneql.quantities.units import describe, in_words, unit_of

PLAIN_NUMBER = Quantity(PLAIN)
COMPONENTS = ("x", "y", "z")
POINT = "point"
"""The field of an item that `repeat` copies in a list of places."""
_SIZES = (None, PLAIN, LENGTH, MASS * LENGTH**2)
"""Dimensions of vectors that have a size along each axis."""
_AXES: dict[Dimension | None, int] = {LENGTH / TIME: 0, FREQUENCY: 1, FORCE: 1}
SHORTEST, LONGEST = 1e-100, 1e100
"""Range of a direction's length in which products of a few such lengths neither vanish nor overflow."""


def read_value(node: Node, quantity: Quantity, what: str, names: Names, found: Diagnostics) -> Value | None:
    """A value of the quantity's type; None after reporting errors."""
    return _checked(
        read_expr(node, quantity.shape, quantity.dimension, what, names, found), node, quantity, what, found
    )


def _checked(expr: Expr | None, node: Node, quantity: Quantity, what: str, found: Diagnostics) -> Value | None:
    if expr is None or not fits(expr, quantity, what, node.span, found):
        return None
    read = Value(_scaled(expr) if quantity.direction else expr, node.span)
    return read if quantity.over_time or momentary(expr, node.span, found) else None


def _scaled(expr: Expr) -> Expr:
    """A direction; a constant one of extreme length is scaled by a power of two, which keeps the direction exactly."""
    if not Value(expr).constant:
        return expr
    given = [float(x) for x in numbers(evaluate(expr, {}))]
    largest = max(map(abs, given))
    if SHORTEST < largest < LONGEST or not math.isfinite(largest):
        return expr
    power = -math.frexp(largest)[1]
    items = tuple(Number(math.ldexp(x, power)) for x in given)
    return Vector(items, Type((len(items),), PLAIN), expr.span)


def read_expr(
    node: Node, shape: Shape | None, dimension: Dimension | None, what: str, names: Names, found: Diagnostics
) -> Expr | None:
    """The bound tree of a scalar, list or keyframe node; its type is not checked yet."""
    if unsure(node):
        return None
    if shape is not None and shape[:1] == (None,) and isinstance(node, Scalar) and (several := _copies(node, names)):
        node = Sequence(several, False, node.source, node.start, node.end)
    match node:
        case Scalar():
            return scalar_expr(node, names, found)
        case Sequence():
            if (help := keys_meant(node)) is not None:
                found.error("wrong-shape", f"{what} is no list of times and values", node.span, help=help)
                return None
            inner = () if shape is None else shape[1:]
            items = [
                read_expr(one, inner, dimension, what, names.of_copy(item), found)
                for item in node.items
                for one in _copies(item, names) or [_point(item)]
            ]
            if any(item is None for item in items):
                return None
            if not (known := [item for item in items if item is not None]):
                return Vector((), Type((0, *inner), dimension), node.span)
            return _vector(known, what, node.span, found, dimension)
        case MappingNode():
            if "keys" in node.entries:
                return _keys(node, shape, dimension, what, names, found)
            if shape == (3,) or (shape is None and what != "define" and {*node.entries} == {*COMPONENTS}):
                return _by_component(node, dimension, what, names, found)
            texts = [item.span.text for item in node.entries.values() if isinstance(item, Scalar)]
            listed = (shape is None or shape[:1] == (None,)) and len(texts) == len(node.entries)
            help = times_meant(node, what) or timed(node) or (pair_meant(node, dimension) if shape == (2,) else None)
            help = help or (f"write `[{', '.join(texts)}]`" if listed else None)
            if len(node.entries) == 1 and texts in ([""], ["null"]) and help is None:
                help = f"a name stands by itself, without braces: write `{what}: {next(iter(node.entries))}`"
            help = f"a name has one value: write `{node.span.text[1:-1]}`, each by itself" if what == "define" else help
            found.error("wrong-shape", f"{what} is a value, not a group of fields", node.span, help=help)
    return None


def _copies(node: Node, names: Names) -> list[Node]:
    """The outputs that one name of all copies stands for, ``bead.position``; [] for any other node."""
    if not isinstance(node, Scalar) or names.field(node.text) is not None:
        return []
    each = names.copies_of(node.text)
    return [Scalar(text, "text", False, node.source, node.start, node.end) for text in each]


def _point(node: Node) -> Node:
    """The place of a copied item, ``{repeat: {count: 5, as: i}, point: [...]}``; the node itself for any other."""
    copied = isinstance(node, MappingNode) and node.index is not None and {*node.entries} == {POINT}
    return node.entries[POINT] if copied else node  # type: ignore[union-attr]


def scalar_expr(node: Scalar, names: Names, found: Diagnostics) -> Expr | None:
    """The bound tree of a scalar's text."""
    text = parsed_text(node)
    if not text.strip():
        line = node.source.text[node.source.text.rfind("\n", 0, node.start) + 1 : node.start]
        help = parted_meant(line)
        found.error("missing-value", "a value is missing here", node.span, help=help)
        return None
    before, expr = len(found.found), None
    try:
        expr = names.parsed.tree(node, text, names.lookup, found)
    except ScriptError as error:
        found.extend(error.diagnostics)
    if expr is None and len(found.found) > before and (help := power_of_ten(text)) is not None:
        found.found[before] = replace(found.found[before], help=help)
    return expr


def parsed_text(node: Scalar) -> str:
    """The text to parse: the source's own characters where they are equivalent, so that carets point into them."""
    raw = node.content.text
    return raw if " ".join(raw.split()) == " ".join(node.text.split()) else node.text


def _vector(
    items: list[Expr], what: str, span: Span, found: Diagnostics, wanted: Dimension | None = None
) -> Expr | None:
    inner = items[0].type.shape
    given = [i.type.dimension for i in items if not is_zero(i)]
    dimension = (wanted if wanted is not None and not wanted.plain and wanted in given else common(given)) or PLAIN
    for item in items:
        other = item.type.dimension
        if item.type.shape != inner:
            found.error("wrong-shape", f"the items of {what} differ in their number of components", item.span or span)
            return None
        if other is not None and other != dimension and not is_zero(item):
            texts = ", ".join("" if one.span is None else one.span.text for one in items)
            vector, rate = vector_meant(texts), dimension / other in (TIME, FREQUENCY)
            help = remedy(item, dimension) or (vector and f"write `{vector}`")
            rated = "times the `time` a velocity is a length: `1 m/s*time`"
            help = rated if rate else help or each_by_unit(items, wanted)
            found.error(
                "dimension-mismatch",
                f"the components of {what} differ: {describe(dimension)} and {describe(other)}",
                item.span or span,
                help=help,
            )
            return None
    return Vector(tuple(items), Type((len(items), *inner), dimension), span)


def _by_component(
    node: MappingNode, dimension: Dimension | None, what: str, names: Names, found: Diagnostics
) -> Expr | None:
    for key in node.entries:
        if key not in COMPONENTS:
            help = vector_meant_by(node, what) or suggestion(key, (*COMPONENTS, "keys"))
            inner = node.entries[key]
            if isinstance(inner, MappingNode) and any(one.endswith(" s") for one in inner.entries):
                help = f"keys stand in `keys`: write `{what}: {{keys: {inner.span.text}}}`"
                help = help if inner.flow else f"keys stand in `keys`: write `keys:` in place of `{key}:`"
            if key == what and len(node.entries) == 1:
                help = f"write the value alone, `{node.entries[key].span.text}`"
            if node.index is not None and len(node.entries) == 1:
                help = f"the place of a copy is its `point`: write `point: {inner.span.text}`"
            message = f"{what} has the components x, y, z, not '{key}'"
            found.error("unknown-field", message, node.keys[key].span, help=help)
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
    if shape is None or dimension is None:
        known = _type_of_keys(node, what, names)
        shape, dimension = known.shape if shape is None else shape, dimension or known.dimension
    quantity = Quantity(dimension or PLAIN, shape)
    of_slope = Quantity((dimension or PLAIN) / TIME, shape)

    def value(item: Node) -> Expr | None:
        expr = read_expr(item, shape, dimension, what, names, found)
        own = None if expr is None else expr.type.dimension
        of_one = replace(quantity, dimension=own) if dimension is None and own is not None and own.plain else quantity
        read = _checked(expr, item, of_one, what, found)
        return None if read is None else read.expr

    def slope(item: Node) -> Expr | None:
        read = read_value(item, of_slope, f"{what}'s slope", names, found)
        return None if read is None else read.expr

    keys = read_keys(node, what, value, slope, time_reader(names, found), Type(shape, quantity.dimension), found)
    if dimension is None and isinstance(keys, Keys):
        return replace(keys, type=Type(shape, common(key.value.type.dimension for key in keys.keys) or PLAIN))
    return keys


def _type_of_keys(node: MappingNode, what: str, names: Names) -> Type:
    """The type of keys where the field takes any: the first key's shape, and the dimension of the first that has one.

    Of a plain number where none can be read.
    """
    table = node.entries["keys"]
    items = table.entries.values() if isinstance(table, MappingNode) else ()
    nothing = Diagnostics()
    own = replace(names, found=nothing)
    values = [one.entries.get("value", one) if isinstance(one, MappingNode) else one for one in items]
    types = [expr.type for one in values if (expr := read_expr(one, None, None, what, own, nothing)) is not None]
    dimension = next((one.dimension for one in types if one.dimension is not None and not one.dimension.plain), None)
    return Type(types[0].shape if types else (), dimension)


def time_reader(names: Names, found: Diagnostics) -> ReadTime:
    """A reader of the times of keyframes."""
    return lambda node, what: read_value(node, Quantity(TIME), what, names, found)


def fits(expr: Expr, quantity: Quantity, what: str, span: Span, found: Diagnostics) -> bool:
    """Whether a bound tree has a quantity's shape and dimension; errors are reported at the span."""
    if quantity.shape is not None and not _shape_fits(expr.type.shape, quantity.shape):
        found.error(
            "wrong-shape",
            f"{what} is {_shape_text(quantity.shape)}, not {_shape_text(expr.type.shape, expr.type.dimension)}",
            span,
            help=_repeated(expr, quantity)
            or _sized(expr, quantity)
            or _pointed(expr, quantity)
            or _turning(expr, quantity),
            notes=origin(expr, span),
        )
        return False
    has = expr.type.dimension
    if not suits(has, quantity.dimension):
        found.error(
            "dimension-mismatch",
            f"{what} is {in_words(quantity.dimension)}, but this is {in_words(has)}",
            span,
            help=_counted(expr, quantity.dimension) or remedy(expr, quantity.dimension),
            notes=origin(expr, span),
        )
        return False
    if quantity.direction and Value(expr).constant and not any(numbers(evaluate(expr, {}))):
        found.error("out-of-range", f"{what} gives a direction, which 0 0 0 does not have", span)
        return False
    bare = [one for one in _items(expr) if _bare(one)] if quantity.needs_unit else []
    for one in bare:
        place = span if one is expr or one.span is None else one.span
        text = vector_meant(place.text.strip("[]")) or place.text  # no unit stands behind a bracket
        large = Value(one).constant and max(map(abs, numbers(evaluate(one, {})))) > TURN
        help = f"write `{text} deg`" if large else f"write `{text} deg` or `{text} rad`"
        found.error("unit-needed", f"{what} needs a unit", place, help=help)
    return not bare


def _items(expr: Expr) -> list[Expr]:
    """A value, or those of its keys."""
    return [key.value for key in expr.keys] if isinstance(expr, Keys) else [expr]


def _repeated(expr: Expr, wanted: Quantity) -> str | None:
    """The help where one value is given for a vector."""
    size = (wanted.shape or (None,))[0] or (2 if wanted.dimension == LENGTH else None)
    if not suits(expr.type.dimension, wanted.dimension):
        return None
    if expr.type.shape or expr.span is None or len(wanted.shape or ()) != 1 or size is None:
        return None
    text = expr.span.text
    if not isinstance(expr, Number):
        zero = "0" if wanted.dimension is None or wanted.dimension.plain else f"0 {unit_of(wanted.dimension)}"
        return f"write `[{', '.join([text, *(size - 1) * [zero]])}]`, a value for each axis"
    items = size * [text]
    if size == 3 and expr.type.dimension not in _SIZES:  # of others a direction is meant
        axis = _AXES.get(expr.type.dimension, 1)
        zero = re.sub(r"^[-+.\d]+(e[-+]?\d+)?", "0", text)
        items = [text if k == axis else zero for k in range(size)]
    vector = vector_meant(", ".join(items))
    return None if vector is None else f"write `{vector}`, a number for each axis"


def _turning(expr: Expr, wanted: Quantity) -> str | None:
    """The help where an angle is given for an angular velocity: about y, by time."""
    has = expr.type.dimension
    if wanted.shape != (3,) or wanted.dimension != FREQUENCY or not isinstance(expr, Number) or expr.span is None:
        return None
    number, _, unit = expr.span.text.partition(" ")
    return f"it goes by time: write `0 {number} 0 {unit}/s`" if has is not None and has.kind == ANGLE.kind else None


def _sized(expr: Expr, wanted: Quantity) -> str | None:
    """The help where vectors are given for numbers: their length, or a component."""
    if not isinstance(expr, Link) or expr.type.shape != (*(wanted.shape or ()), 3):
        return None
    name = f"{expr.task}.{expr.output}"
    return f"write `length({name})` for its size, or a component, `{name}.x`"


def _pointed(expr: Expr, wanted: Quantity) -> str | None:
    """The help where a list of points is given for one, or the numbers of several points without brackets."""
    size = len(expr.items) if isinstance(expr, Vector) else 0
    if wanted.shape == (3,) and expr.type.shape == (None, 3) and isinstance(expr, Link):
        return f"write one of its points, the first is `item({expr.task}.{expr.output}, 0)`"
    if wanted.shape == (None, 2, 3) and expr.type.shape == (size, 2):
        here = "a segment is two points, `[[0 0 0 m, 1 0 0 m], [0 0 0 m, 0 1 0 m]]`"
        return f"{here}; pairs of numbers, of points from 0, stand beside the `points` of the whole object"
    if wanted.shape == (None, 3) and expr.type.shape == (size,) and size > 3 and size % 3 == 0:
        texts = ["" if item.span is None else item.span.text for item in expr.items]  # type: ignore[union-attr]
        unit = "" if wanted.dimension is None or wanted.dimension.plain else f" {unit_of(wanted.dimension)}"
        points = (f"{' '.join(texts[at : at + 3])}{unit}" for at in range(0, size, 3))
        return f"a point has three numbers: write `[{', '.join(points)}]`"
    return None


def _counted(expr: Expr, wanted: Dimension | None) -> str | None:
    """The help where an angle or a percentage is given for another quantity."""
    kind = "" if expr.type.dimension is None else expr.type.dimension.kind
    if wanted is None or kind not in (ANGLE.kind, PERCENTAGE.kind):
        return None
    if kind == ANGLE.kind:
        return "an angle counts as a number where it is divided by one: `x/(1 rad)`" if wanted.plain else None
    share = expr.span.text if isinstance(expr, Number) and expr.span is not None else "5 %"
    return None if wanted.plain else f"write what it is a part of, such as `{share}*(1 {unit_of(wanted)})`"


def origin(expr: Expr, span: Span) -> list[Note]:
    """A note on where a value is defined, if elsewhere than used; for a vector, its first nonzero item."""
    one = expr
    if isinstance(expr, Vector):
        one = next((item for item in expr.items if not is_zero(item)), expr)
    place = one.span
    if place is None or (place.source is span.source and span.start <= place.start <= place.end <= span.end):
        return []
    return [Note("the value stands here", place)]


def _bare(expr: Expr) -> bool:
    numbers = [node for node in walk(expr) if isinstance(node, Number)]
    names = any(isinstance(node, Symbol | Link) for node in walk(expr))
    return not names and all(n.bare for n in numbers) and any(n.value != 0 for n in numbers)


def _shape_fits(has: Shape, wanted: Shape) -> bool:
    if len(has) != len(wanted):
        return False
    return all(b is None or a is None or a == b for a, b in zip(has, wanted, strict=True))


def _shape_text(shape: Shape, dimension: Dimension | None = LENGTH) -> str:
    if not shape:
        return "a single value"
    if len(shape) == 1:
        return "a list of values" if shape[0] is None else f"a vector of {shape[0]}"
    if len(shape) == 2:
        points = shape[1] in (3, None) and dimension in (LENGTH, None)
        return "a list of points" if points else f"a list of vectors of {shape[1] or 3}"
    return "a list of pairs of points" if shape[1] in (2, None) else f"a list of lists of {shape[1]} vectors"
