"""Reading of colors and rotations, whose grammar is more than a quantity's."""

from __future__ import annotations

import re
from collections.abc import Sequence
from colorsys import hls_to_rgb
from dataclasses import replace
from math import degrees, inf, pi

from sceneql.compiler.css_colors import NAMED, css_color
from sceneql.compiler.keyframes import read_keys
from sceneql.compiler.names import Names
from sceneql.compiler.values import parsed_text, read_expr, read_value, time_reader
from sceneql.compiler.vector_fields import ENDS
from sceneql.kinds import Quantity, Value
from sceneql.language.tree import Mapping as MappingNode
from sceneql.language.tree import Node, Scalar, unsure
from sceneql.language.tree import Sequence as SequenceNode
from sceneql.quantities.diagnostic import Diagnostics, suggestion
from sceneql.quantities.dimension import ANGLE, PLAIN
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Number, Type, Vector

RGB = Type((3,), PLAIN)
QUATERNION = Type((4,), PLAIN)
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
ROUNDED, TURN = 0.03, 24
"""Difference from a part of a turn up to which it is one written with few digits, and parts of a turn, 15 deg each."""
_HEX = re.compile(r"0[xX]([0-9a-fA-F]{6})")
_DIGITS = re.compile(r"\d+\.?\d*|\.\d+")
DARK = 16
"""A color whose numbers are all at most this is not taken as bytes: as such it would be nearly black."""
BRIGHTER = "1 1 1 is white; a light is made brighter by its `power`, a material by `glow`"
OPAQUE = "it has three numbers; what one sees through is `material: glass`: `sceneql words glass`"
RED = 'write a CSS name, `orange`, "#ff8800", or three numbers from 0 to 1, `1 0.5 0`'
_CHOSEN = re.compile(r"\[([\w\s,]+)\]\s*\[([^\[\]]+)\]")
"""A list of colors by name, and the number behind it: ``[red, green][i]``."""
_ABOUT = re.compile(r"([-+]?[\d.]+)\s*(?:deg)?\s*\*?\s*([xyz])")
EULER = ("euler", "angles", "degrees", "euler_angles")
"""Fields of other programs for angles about x, y and z."""
ORDERS = ("xyz", "xzy", "yxz", "yzx", "zxy", "zyx")
UNTURNED = "`1 0 0 0` turns nothing, and `{about: z, angle: 30 deg}` by an angle"


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
        if _is_name(text) and text not in names.defines:
            components = css_color(text)
            if components is None:
                found.error("unknown-color", f"'{text}' is no color", node.span, help=_meant(text))
                return None
            return Value(Vector(tuple(Number(c) for c in components), RGB), node.span)
    if isinstance(node, Scalar) and (mixed := _mixed(node.text)) is not None:
        found.error("unknown-color", f"'{node.text.strip()}' is no color", node.span, help=mixed)
        return None
    if (several := _several(node, names)) is not None:
        found.error("wrong-shape", "color is one color, not several", node.span, help=several)
        return None
    before = len(found.found)
    if isinstance(node, MappingNode) and not set(node.entries) <= {*AXES}:
        texts = re.findall(r"[a-z]+", node.span.text)
        first = next((one for one in texts if one in NAMED), "skyblue")
        ends = [one.span.text for one in node.entries.values()]
        better = f"write `{first}`"
        if len(ends) == len(ENDS) and all(key in names for key, names in zip(node.entries, ENDS, strict=True)):
            better = f"what changes has keys: write `{{keys: {{0 s: {ends[0]}, 1 s: {ends[1]}}}}}`"
        found.error("wrong-shape", "color is one color, not a group of fields", node.span, help=better)
        return None
    value = read_value(node, Quantity(PLAIN, (3,)), "color", names, found)
    _of_names(found, before)
    if [one.code for one in found.found[before:] if one.help is None] == ["wrong-shape"]:
        meant = OPAQUE if found.found[-1].message.endswith("not a vector of 4") else RED
        found.found[-1] = replace(found.found[-1], help=meant)
    numbers = evaluate(value.expr, {}) if value is not None and value.constant else (0.0,)
    if not all(0 <= number <= 1 for number in numbers):  # nor are they NaN
        told = all(0 <= number < inf for number in numbers)
        help = (BRIGHTER if max(numbers) <= DARK else _of_bytes(numbers)) if told else None
        found.error("out-of-range", "the numbers of a color are from 0 to 1", node.span, help=help)
        return None
    return value


def _several(node: Node, names: Names) -> str | None:
    """The help for colors by name in brackets, of which a number behind them, or that of the copy, chooses one."""
    chosen = _CHOSEN.fullmatch(node.text.strip()) if isinstance(node, Scalar) else None
    given = [] if chosen is None else [one.strip() for one in chosen[1].split(",")]
    if isinstance(node, SequenceNode):
        given = [item.text for item in node.items if isinstance(item, Scalar)]
        given = given if len(given) == len(node.items) else []
    if not given or not all(one in NAMED and one not in names.defines for one in given):
        return None
    scope = names.scope
    copy = next(iter(scope.fields), "") if scope is not None else ""
    number = chosen[2] if chosen is not None else copy
    if not number:
        return f"write one of them, `{given[0]}`; one for each of several objects stands at each of them"
    listed = ", ".join(f"[{', '.join(f'{c:.3g}' for c in css_color(one) or ())}]" for one in given)
    return f"of the colors by their numbers one is `item([{listed}], {number})`"


def _is_name(text: str) -> bool:
    """Whether a text gives a color by name, by digits, or by a call as in CSS and other languages."""
    called = text.startswith(("rgb(", "rgba(", "hsl(", "hsla("))
    words = all(word.isalpha() for word in text.split())
    return called or words or text.isidentifier() or text.startswith("#") or _HEX.fullmatch(text) is not None


_TINT = re.compile(r"(light|pale|dark|deep)[-_ ]?([a-z]+)")
"""A shade as one says it, of which CSS names some alone."""


_TIKZ = re.compile(r"([a-z]+)!(\d+)(?:!([a-z]+))?")


def _mixed(text: str) -> str | None:
    """The help for a mixture of two colors as in TikZ, ``red!50!white`` or ``red!50``, else None."""
    if (told := _TIKZ.fullmatch(text.strip().lower())) is None:
        return None
    first, second = css_color(told[1]), css_color(told[3] or "white")
    if first is None or second is None or float(told[2]) > 100:
        return None
    share = float(told[2]) / 100
    return _of_bytes([share * a + (1 - share) * b for a, b in zip(first, second, strict=True)])


SQUARES = ("checker", "checkers", "checkered", "checkerboard", "chequered", "chess", "chessboard", "squares", "tiles")
"""Patterns of squares as other programs call them."""


def _meant(text: str) -> str:
    """The help for a text that is no color."""
    *_, last = text.split() or [""]
    if (digits := _HEX.fullmatch(text)) is not None:
        return f'write `"#{digits[1].lower()}"`'
    if text.startswith(("rgb", "rgba")) and len(numbers := [float(one) for one in _DIGITS.findall(text)]) >= 3:
        return _of_bytes(numbers[:3])
    if (help := _of_hue(text)) is not None:
        return help
    if (tint := _TINT.fullmatch(text.lower())) is not None and tint[2] in NAMED and "".join(tint.groups()) not in NAMED:
        share = 0.5 if tint[1] in ("light", "pale") else 1.0
        mixed = [share * one + 1 - share for one in css_color(tint[2]) or ()]
        mixed = [0.5 * one for one in mixed] if tint[1] in ("dark", "deep") else mixed
        return f"this is no CSS name: {_of_bytes(mixed)}"
    if text.lower().replace(" ", "").replace("_", "") in SQUARES:
        return "squares of two colors are a material: `material: checker` stands in place of the color"
    near = suggestion("".join(text.split()), NAMED) if len(text.split()) == 1 else None
    if "".join(text.split()).lower() in NAMED:
        near = f"did you mean '{''.join(text.split()).lower()}'?"
    near = near or suggestion(last, NAMED)
    return near or 'write a CSS name, "#rrggbb" or three numbers from 0 to 1'


_HSL = re.compile(r"hsla?\(\s*([^,]+?)\s*(deg)?\s*,\s*([\d.]+)(%?)\s*,\s*([\d.]+)(%?)[^)]*\)")
"""Hue, saturation and lightness as in CSS, or each from 0 to 1."""


def _of_hue(text: str) -> str | None:
    """The help for a color by hue, saturation and lightness; the hue alone where it is a formula; None for others."""
    if (told := _HSL.fullmatch(text)) is None:
        return None
    hue, degrees, *rest = told.groups()
    saturation, lightness = (min(float(rest[k]) / (100 if rest[k + 1] else 1), 1.0) for k in (0, 2))
    try:
        turns = float(hue)
    except ValueError:
        inner = f"({hue})" if re.search(r"[-+]", hue) else hue
        return f"the full color of a hue, which goes from 0 to 1, is `hue({inner}/360)`"
    turns /= 1 if turns <= 1 and not (degrees or "%" in text) else 360
    return _of_bytes(hls_to_rgb(turns, lightness, saturation))


def _of_bytes(numbers: Sequence[float]) -> str:
    """The help for a color whose numbers go from 0 to 255."""
    if max(numbers) > 255:
        return BRIGHTER
    share = [number / 255 if max(numbers) > 1 else number for number in numbers]
    digits = "".join(f"{round(255 * number):02x}" for number in share)
    return f'write `{" ".join(f"{number:.3g}" for number in share)}`, or `"#{digits}"`'


def _of_names(found: Diagnostics, first: int) -> None:
    """Let the colors by name in helps from number ``first`` on be their numbers, as formulas take them."""
    for k, one in enumerate(found.found[first:], first):
        if one.help is not None and "`where(" in one.help:
            help = re.sub(r"(?<=, )([a-z]+)(?=[,)])", lambda name: _numbers(name[0]), one.help)
            found.found[k] = replace(one, help=help)


def _numbers(name: str) -> str:
    return f"[{', '.join(f'{c:.3g}' for c in css_color(name) or ())}]" if name in NAMED else name


def read_rotation(node: Node, names: Names, found: Diagnostics) -> Value | None:
    """A rotation as a unit quaternion [w, x, y, z] (4,)."""
    if unsure(node):
        return None
    if isinstance(node, MappingNode):
        given = node.entries
        if "keys" in given and "about" in given:
            help = f"write `{{about: {given['about'].span.text}, angle: {{keys: {given['keys'].span.text}}}}}`"
            found.error("rotation-shape", "a rotation about an axis has keys for its angle", node.span, help=help)
            return None
        if "keys" in given:

            def key(item: Node) -> Expr | None:
                return _expr(read_rotation(item, names, found))

            keyed = read_keys(node, "rotation", key, None, time_reader(names, found), QUATERNION, found)
            return None if keyed is None else Value(keyed, node.span)
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
    expr = None
    if isinstance(node, Scalar) and (about := _ABOUT.fullmatch(node.text.strip())) is not None:
        help = f"write `{{about: {about[2]}, angle: {about[1]} deg}}`"
        found.error("rotation-shape", "a rotation names its axis or its order", node.span, help=help)
        return None
    if not isinstance(node, MappingNode):
        expr = read_expr(node, QUATERNION.shape, PLAIN, "rotation", names, found)
        if expr is None:
            return None
        if expr.type.shape in (QUATERNION.shape, (None,)):
            value = read_value(node, Quantity(PLAIN, QUATERNION.shape), "rotation", names, found)
            if value is not None and value.constant and not any(value.number()):
                found.error("invalid", "a rotation is a quaternion that is not zero", node.span, help=UNTURNED)
                return None
            if value is not None and value.constant and _by_axis(node, value.number(), found):
                return None
            return value
    turned: Node = node
    if isinstance(node, MappingNode) and len(node.entries) == 1 and next(iter(node.entries)) in EULER:
        (turned,) = node.entries.values()
        expr = read_expr(turned, (3,), None, "rotation", names, Diagnostics())
    found.error("rotation-shape", "a rotation names its axis or its order", node.span, help=_turned(turned, expr))
    return None


def _by_axis(node: Node, numbers: Sequence[float], found: Diagnostics) -> bool:
    """Whether four numbers are an axis and an angle, which is an error; warns of the quaternion of no turn w last."""
    *axis, angle = (float(one) for one in numbers)
    if tuple(axis) == (0.0, 0.0, 0.0) and angle == 1.0:
        text = "as a quaternion `w x y z` this turns by 180 deg about z"
        found.warning("quaternion-order", text, node.span, help="w stands first: `1 0 0 0` turns nothing")
    elif axis[0] == 0.0 and angle != 0.0 and any(axis):
        text = f"as a quaternion `w x y z` this turns by 180 deg about {axis[1]:g} {axis[2]:g} {angle:g}"
        help = f"w stands first: write `{angle:g} {axis[0]:g} {axis[1]:g} {axis[2]:g}` if it is the last here"
        found.warning("quaternion-order", text, node.span, help=help)
    square = sum(c * c for c in axis)
    if abs(square - 1.0) > 1e-3 or abs(square + angle * angle - 1.0) < 2e-3 or angle in (1.0, -1.0):
        return False
    unit = "rad" if abs(angle) <= 2 * pi else "deg"
    text = "four numbers are a quaternion `w x y z`, of length 1"
    about = " ".join(f"{c:g}" for c in axis)
    help = f"an axis and an angle are `{{about: {about}, angle: {angle:g} {unit}}}`"
    found.error("rotation-shape", text, node.span, help=help)
    return True


def _axis(node: Node, names: Names, found: Diagnostics) -> Expr | None:
    if isinstance(node, Scalar):
        text = parsed_text(node).strip()
        sign = -1.0 if text.startswith("-") else 1.0
        if text.lstrip("-") in AXES:
            return Vector(tuple(Number(sign * c + 0.0) for c in AXES[text.lstrip("-")]), RGB, node.span)
    return _expr(read_value(node, Quantity(PLAIN, (3,)), "about", names, found))


def _turned(node: Node, expr: Expr | None) -> str:
    """The help for a rotation that names neither its axis nor its order."""
    literal = () if expr is None else expr.items if isinstance(expr, Vector) else (expr,)
    if expr is not None and expr.type.shape == (3,) and expr.type.dimension == PLAIN and "pi" in node.span.text:
        turns = evaluate(expr, {}) if Value(expr).constant else ()
        if turns:
            return f"write `{{xyz: {' '.join(f'{degrees(one):.6g}' for one in turns)} deg}}`"
    if isinstance(node, Scalar) and all(isinstance(one, Number) for one in literal) and len(literal) in (1, 3):
        written = node.text.strip()
        unit = "rad" if any(isinstance(one, Number) and _in_radians(float(one.value)) for one in literal) else "deg"
        angle = f"{written} {unit}" if all(isinstance(one, Number) and one.bare for one in literal) else written
        return f"write `{{xyz: {angle}}}`" if len(literal) == 3 else f"write `{{about: y, angle: {angle}}}`"
    if isinstance(node, Scalar) and expr is not None and not expr.type.shape:
        return f"write `{{about: y, angle: {node.text.strip()}}}`, or about another axis"
    if isinstance(node, SequenceNode) and len(literal) == 3 and all(isinstance(one, Number) for one in literal):
        if all(isinstance(one, Number) and one.bare for one in literal):
            unit = "rad" if any(isinstance(one, Number) and _in_radians(float(one.value)) for one in literal) else "deg"
            return f"write `{{xyz: {' '.join(item.span.text for item in node.items)} {unit}}}`"
        return f"write `{{xyz: [{', '.join(item.span.text for item in node.items)}]}}`"
    if isinstance(node, MappingNode) and node.entries:
        given = {name: item.span.text for name, item in node.entries.items()}
        if given.keys() == {"axis", "angle"}:
            return f"write `{{about: {given['axis']}, angle: {given['angle']}}}`"
        if len(given) == 1 and given.keys() <= AXES.keys():
            return f"write `{{about: {next(iter(given))}, angle: {next(iter(given.values()))}}}`"
        if given.keys() <= AXES.keys():
            return f"write `{{xyz: [{', '.join(given.get(axis, '0 deg') for axis in AXES)}]}}`"
    return "write `{about: z, angle: 30 deg}`, `{xyz: 10 20 30 deg}` or a quaternion `[w, x, y, z]`"


def _in_radians(number: float) -> bool:
    """Whether a number without a unit is most likely an angle in radians: a fraction, near a part of a turn."""
    part = number / (pi / 12)
    return number != round(number) and abs(part - round(part)) < ROUNDED and 0 < abs(part) <= TURN


def _expr(value: Value | None) -> Expr | None:
    return None if value is None else value.expr
