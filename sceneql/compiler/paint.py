"""Nodes to colors and rotations: fields whose grammar is more than a quantity's."""

from __future__ import annotations

from sceneql.compiler.css_colors import NAMED, css_color
from sceneql.compiler.keyframes import read_keys
from sceneql.compiler.names import Names
from sceneql.compiler.values import parsed_text, read_expr, read_value, time_reader
from sceneql.kinds import Quantity, Value
from sceneql.language.tree import Mapping as MappingNode
from sceneql.language.tree import Node, Scalar, unsure
from sceneql.quantities.diagnostic import Diagnostics, suggestion
from sceneql.quantities.dimension import ANGLE, PLAIN
from sceneql.quantities.expression import Call, Expr, Number, Type, Vector

RGB = Type((3,), PLAIN)
QUATERNION = Type((4,), PLAIN)
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
ORDERS = ("xyz", "xzy", "yxz", "yzx", "zxy", "zyx")


def read_color(node: Node, names: Names, found: Diagnostics) -> Value | None:
    """An sRGB color (3,) from 0 to 1: a CSS name, ``#rrggbb``, or a vector value."""
    if unsure(node):
        return None
    if isinstance(node, MappingNode) and "keys" in node.entries:

        def key(item: Node) -> Expr | None:
            return _expr(read_color(item, names, found))

        expr = read_keys(node, "color", key, None, time_reader(names, found), RGB, found)
        return None if expr is None else Value(expr, node.span)
    if isinstance(node, Scalar):
        text = node.text.strip()
        called = text.startswith(("rgb(", "rgba(", "hsl(", "hsla("))  # as CSS writes them
        if called or text.startswith("#") or (text.isidentifier() and text not in names.defines):
            components = css_color(text)
            if components is None:
                hint = suggestion(text, NAMED) or 'write a CSS name, "#rrggbb" or three numbers from 0 to 1'
                found.error("unknown-color", f"'{text}' is no color", node.span, help=hint)
                return None
            return Value(Vector(tuple(Number(c) for c in components), RGB), node.span)
    return read_value(node, Quantity(PLAIN, (3,)), "color", names, found)


def read_rotation(node: Node, names: Names, found: Diagnostics) -> Value | None:
    """A rotation as a unit quaternion [w, x, y, z] (4,)."""
    if unsure(node):
        return None
    if isinstance(node, MappingNode):
        given = node.entries
        if "keys" in given:

            def key(item: Node) -> Expr | None:
                return _expr(read_rotation(item, names, found))

            turned = read_keys(node, "rotation", key, None, time_reader(names, found), QUATERNION, found)
            return None if turned is None else Value(turned, node.span)
        if given.keys() == {"about", "angle"}:
            axis = _axis(given["about"], names, found)
            angle = read_value(given["angle"], Quantity(ANGLE, needs_unit=True), "angle", names, found)
            if axis is None or angle is None:
                return None
            return Value(Call("about", (axis, angle.expr), QUATERNION, node.span), node.span)
        order = next(iter(given), "")
        if len(given) == 1 and order in ORDERS:
            angles = read_value(given[order], Quantity(ANGLE, (3,), needs_unit=True), order, names, found)
            if angles is None:
                return None
            return Value(Call(f"euler_{order}", (angles.expr,), QUATERNION, node.span), node.span)
    else:
        expr = read_expr(node, QUATERNION.shape, PLAIN, "rotation", names, found)
        if expr is None:
            return None
        if expr.type.shape in (QUATERNION.shape, (None,)):
            return read_value(node, Quantity(PLAIN, QUATERNION.shape), "rotation", names, found)
    found.error(
        "rotation-shape",
        "a rotation names its axis or its order",
        node.span,
        help="write `{about: z, angle: 30 deg}`, `{xyz: 10 20 30 deg}` or a quaternion `[w, x, y, z]`",
    )
    return None


def _axis(node: Node, names: Names, found: Diagnostics) -> Expr | None:
    if isinstance(node, Scalar):
        text = parsed_text(node).strip()
        sign = -1.0 if text.startswith("-") else 1.0
        if text.lstrip("-") in AXES:
            return Vector(tuple(Number(sign * c + 0.0) for c in AXES[text.lstrip("-")]), RGB, node.span)
    return _expr(read_value(node, Quantity(PLAIN, (3,)), "about", names, found))


def _expr(value: Value | None) -> Expr | None:
    return None if value is None else value.expr
