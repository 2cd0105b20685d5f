"""Help for quantities of a wrong dimension or shape: another field, unit or output, corners of a box.

``reader`` is the `Reader` (`sceneql.compiler.read`) that met the value.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import replace
from math import tau
from typing import Any

from pydantic import BaseModel

from sceneql import kinds
from sceneql.compiler import values
from sceneql.compiler.annotations import marks_of, quantities
from sceneql.compiler.meant.values_elsewhere import quantities_fitting
from sceneql.language.tree import Mapping as MappingNode
from sceneql.language.tree import Node, Scalar, Sequence
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.dimension import ANGLE, DENSITY, MASS, PLAIN, Dimension
from sceneql.quantities.expression import Expr, Number, Vector
from sceneql.quantities.unit_table import UNITS
from sceneql.quantities.units import format_quantity, unit_of

NAME = r"[^\W\d][\w.]*"
TRUE = ("true", "yes", "on")
NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
MOST = 200
"""Largest length of a value in which numbers are looked for."""
WATER = "(1000 kg/m^3)"
"""The density in a help where the script says none."""
_HERTZ = re.compile(r"[\d.]\s*[kM]?Hz\s*$")
ANSWERS = (*TRUE, "false", "no", "off")
FRAMES = 30
"""Frames a second of a film that says nothing else."""
_BY_FRAME = re.compile(r"([-+.\d]+)\s*/\s*frames?")
BY_UNIT = ("it has no unit", "it is measured in")
"""Beginnings of helps for a value in another unit where there is no better one."""
WITHOUT = ("for a product", "units are such", "did you mean", "a number of", "what is counted")
"""Beginnings of helps for an unknown unit behind a number that has none."""
OUTPUTS = 3
"""Largest number of outputs that a message offers."""
_NUMBERS = re.compile(r"((?:[-+]?[\d.]+(?:[eE][-+]?\d+)?\s+)*[-+]?[\d.]+(?:[eE][-+]?\d+)?)\s+[^\W\d]\S*")


def for_each(reader: Any, node: Node, cls: type[BaseModel], name: str, title: str) -> str | None:
    """The help for values by the names of parts where a part has one for all that it joins."""
    if not isinstance(node, MappingNode) or "between" not in cls.model_fields or not node.entries:
        return None
    first, value = next(iter(node.entries.items()))
    if first not in reader.names.parts:
        return None
    inner = f"{{between: [{first}, OTHER], {name}: {value.span.text}}}"
    return f"it is one for all that touch: write a part for each pair, `{first}_hits: {{{title}: {inner}}}`"


def is_part(reader: Any, node: Node) -> bool:
    """Whether a value is the name of a part."""
    return isinstance(node, Scalar) and node.text in reader.names.parts


def field_of_part(reader: Any, node: Node, written: Mapping[str, Node], cls: type[BaseModel]) -> str | None:
    """The help for a part's name where a choice stands: the one other field that names such a part."""
    if not is_part(reader, node) or not isinstance(node, Scalar):
        return None
    families = reader.names.catalogue.families_of(reader.names.parts[node.text].word)
    fields = [
        kinds.written_name(key)
        for key, info in cls.model_fields.items()
        if any(isinstance(mark, kinds.Refers) and mark.family in families for mark in marks_of(info))
        and kinds.written_name(key) not in written
    ]
    return f"'{node.text}' is a part: write `{fields[0]}: {node.text}`" if len(fields) == 1 else None


def other_output(reader: Any, node: Node, info: Any, name: str) -> str | None:
    """The help for a part, or an output of it, in place of an output that the field takes: these."""
    part = reader.names.part_of(node.text)[0] if isinstance(node, Scalar) else ""
    if not isinstance(node, Scalar) or part not in reader.names.parts:
        return None
    nothing, found = Diagnostics(), []
    names, marks = replace(reader.names, found=nothing), quantities(info)
    for output in reader.names.outputs_of(part) or ():
        one = Scalar(f"{part}.{output}", "text", False, node.source, node.start, node.start)
        if any(values.read_value(one, mark, name, names, nothing) is not None for mark in marks):
            found.append(one.text)
    found = [one for one in found if one != node.text]
    fields = reader.names.parts[part].fields
    of = fields.entries.get("of") if isinstance(fields, MappingNode) else None
    if of is not None and f"{part}.{of.span.text}" in found:  # a field has the name of what it is of, too
        found = [f"{part}.{of.span.text}"]
    places = [one for one in found if one.endswith(("position", "positions"))]
    told = (places or found)[:OUTPUTS]
    return f"write {' or '.join(f'`{one}`' for one in told)}" if told else None


def of_item(reader: Any, node: Sequence, info: Any, name: str) -> str | None:
    """The help for a part in place of an output among the items of a list: that of its outputs which fits there."""
    items = [one for one in node.items if is_part(reader, one)]
    if not items:
        return None
    marks = [replace(mark, shape=mark.shape[1:]) for mark in quantities(info) if mark.shape]
    part, nothing = items[0].span.text, Diagnostics()
    names, found = replace(reader.names, found=nothing), []
    for output in reader.names.outputs_of(part) or ():
        one = Scalar(f"{part}.{output}", "text", False, node.source, node.start, node.start)
        if any(values.read_value(one, mark, name, names, nothing) is not None for mark in marks):
            found.append(one.text)
    return f"write {' or '.join(f'`{one}`' for one in found[:OUTPUTS])}" if found else None


def number_meant(node: Node, info: Any, name: str, code: str, help: str | None) -> str | None:
    """The help for a word in place of a number, ``tolerance: high``, or behind one without a unit, ``10 lines``."""
    extra: Any = info.json_schema_extra or {}
    default, marks = extra.get("default"), quantities(info)
    if code == "unknown-unit" and (joined := _of_two_units(node, marks)) is not None:
        return f"two units have a sign between them: write `{name}: {joined}`"
    if code == "unknown-unit":
        number = re.fullmatch(r"([-+.\d]+(?:[eE][-+]?\d+)?)\s*[^\W\d]\w*", node.span.text)
        known = [mark.dimension for mark in marks if mark.dimension is not None]
        plain = all(one.plain for one in known) if known else info.annotation in (int, float)
        plain = plain and (help or "").startswith(WITHOUT)
        return f"it has no unit: write `{name}: {number[1]}`" if number is not None and plain else None
    if node.span.text.lower() in ANSWERS and marks:
        example = next((format_quantity(1.0, one) for mark in marks if (one := mark.dimension) is not None), "1")
        return f"it is no switch: write what it is, as `{name}: {default if isinstance(default, str) else example}`"
    if (framed := _BY_FRAME.fullmatch(node.span.text)) is not None:
        return f"of 30 frames a second write `{name}: {float(framed[1]) * FRAMES:g} /s`"
    word = re.fullmatch(NAME, node.span.text) is not None and (help or "").startswith("names stand under")
    if not word or not marks or not isinstance(default, str) or not default[:1].isdigit():
        return _defined(node.span.text, marks) if word else None
    return f"write a number, as `{name}: {default}`, or a name that stands under `define`"


def _defined(name: str, marks: Collection[kinds.Quantity]) -> str | None:
    """The help for a name of nothing in place of a quantity, with one of the field's dimension and components."""
    mark = next((one for one in marks if one.dimension is not None and one.shape in ((), (3,))), None)
    if mark is None or mark.dimension is None:
        return None
    axes = "" if mark.shape == () else "0 1 0 " if mark.dimension.plain else "0 2 0 "
    one = "1" if mark.dimension.plain else format_quantity(1.0, mark.dimension)
    value = f"{axes}{one.partition(' ')[2]}".strip() if axes else one
    return f"names stand under `define`: write `define: {{{name}: {value}}}`, or the value itself, `{value}`"


def _of_two_units(node: Node, marks: Collection[kinds.Quantity]) -> str | None:
    """A number with two units without a sign between them, as the field has them: ``40 N/m`` or ``40 N*m``."""
    found = re.fullmatch(r"([-+.\d]+(?:[eE][-+]?\d+)?)\s*([^\W\d_]{2,4})", node.span.text)
    wanted = [mark.dimension for mark in marks if mark.dimension is not None]
    for k in range(1, len(found[2]) if found is not None else 0):
        first, second = (found[2][:k], found[2][k:]) if found is not None else ("", "")
        if found is not None and first in UNITS and second in UNITS:
            for sign, whole in (("*", UNITS[first][1] * UNITS[second][1]), ("/", UNITS[first][1] / UNITS[second][1])):
                if whole in wanted:
                    return f"{found[1]} {first}{sign}{second}"
    return None


def plain_define(reader: Any, node: Node) -> str | None:
    """The help for a formula of a wrong dimension with a define that is a number without a unit."""
    if not isinstance(node, Scalar):
        return None
    defines = reader.names.defines
    named = [one for one in re.findall(NAME, node.text) if one in defines and isinstance(defines[one], Scalar)]
    bare = [one for one in dict.fromkeys(named) if defines[one].kind in ("integer", "number")]
    if not bare or len(named) == len(bare):
        return None
    text = f"{bare[0]}: {defines[bare[0]].text}"
    return f"'{bare[0]}' is a plain number: give it its unit in `define`, where `{text}` stands"


def _inverse(reader: Any, node: Node, name: str, wanted: Dimension) -> str | None:
    """The help for a frequency in place of a time, and the like."""
    nothing = Diagnostics()
    other = kinds.Quantity(PLAIN / wanted)
    fits = values.read_value(node, other, name, replace(reader.names, found=nothing), nothing) is not None
    return f"it is one over that: write `1/({node.span.text})`" if fits else None


def in_other_unit(reader: Any, node: Node, info: Any, others: Mapping[str, Any], name: str) -> str | None:
    """The help for a quantity of a wrong dimension: the one other field that takes it, or the unit that it has."""
    numbers = _NUMBERS.fullmatch(node.span.text.strip("[]"))
    marks = [mark for mark in marks_of(info) if isinstance(mark, kinds.Quantity | kinds.Symbols)]
    if any(isinstance(mark, kinds.Symbols) and mark.of_field for mark in marks):
        return None  # what is measured is the model's
    wanted = next((mark.dimension for mark in marks if mark.dimension is not None), None)
    if wanted is not None and not wanted.plain and (inverse := _inverse(reader, node, name, wanted)) is not None:
        return inverse
    if numbers is not None and wanted is not None and wanted.kind == ANGLE.kind:
        return f"it is an angle, as `{numbers[1]} deg`"
    if wanted is not None and wanted.plain and node.span.text[-1:] in ("C", "F", "K"):
        return None
    if numbers is not None and wanted is not None and wanted.plain:
        return f"{BY_UNIT[0]}: write `{name}: {numbers[1]}`"
    found = [kinds.written_name(name) for name in quantities_fitting(reader, node, others)]
    if len(found) == 1:
        return f"that is what `{found[0]}` takes: write `{found[0]}: {node.span.text}`"
    if numbers is None or wanted is None:
        return None
    if wanted == MASS and node.span.text.endswith("N"):
        return f"a weight is a mass times gravity: write `{node.span.text}/(9.81 m/s^2)`"
    return f"{BY_UNIT[1]} {(unit := unit_of(wanted))}, as `{numbers[1]} {unit}`"


def by_own_density(reader: Any, written: Mapping[str, Node], first: int) -> None:
    """Let the helps of errors from number ``first`` on multiply and divide by the density that the script says."""
    errors, own = reader.found.found, written.get("density")
    lacking = [k for k in range(first, len(errors)) if WATER in (errors[k].help or "")]
    if not lacking or not isinstance(own, Scalar):
        return
    value = values.read_value(own, kinds.Quantity(DENSITY), "density", reader.names, Diagnostics())
    if value is None or not value.constant:
        return
    # A name would not do: formulas take what is defined as plain numbers.
    text = own.span.text if own.span.text[:1].isdigit() else format_quantity(float(value.number()), DENSITY)
    for k in lacking:
        errors[k] = replace(errors[k], help=errors[k].help.replace(WATER, f"({text})"))


def of_fixed(written: Mapping[str, Node], name: str) -> str:
    """The help for a mass of zero, by which other programs tell what never moves, where `fixed` tells that."""
    text, fixed = f"{name}: {written[name].span.text}", written.get("fixed")
    if fixed is not None and fixed.span.text.lower() in TRUE:
        return f"`fixed: {fixed.span.text}` says that it never moves: leave out `{text}`"
    return f"what never moves is told by `fixed: yes` in place of `{text}`; what is light has a small {name}"


def warn_of_hertz(expr: Expr, mark: kinds.Quantity, found: Diagnostics) -> None:
    """Warn of an angular velocity in Hz, which are rad/s, though most likely turns a second were meant."""
    items = expr.items if isinstance(expr, Vector) else (expr,)
    numbers = [one for one in items if isinstance(one, Number)]
    if not mark.turning or not numbers:
        return
    largest = max(numbers, key=lambda one: abs(one.value))
    place = expr.span  # of `0 2 0 Hz`, whose numbers have their unit together
    if largest.span is not None and _HERTZ.search(largest.span.text) is not None:
        place, numbers = largest.span, [largest]
    if place is None or largest.value == 0 or _HERTZ.search(place.text) is None:
        return
    turns = " ".join(f"{60 * one.value:.6g}" for one in numbers)
    rates = " ".join(f"{one.value:.6g}" for one in numbers)
    text = f"{largest.value:g} Hz is {largest.value:g} rad/s here, and {largest.value / tau:.3g} turns a second"
    found.warning("hertz", text, place, help=f"for turns write `{turns} rpm`; if that is meant write `{rates} rad/s`")


def direction_alone(node: Node) -> str | None:
    """The help for a direction with a unit behind its numbers."""
    numbers = _NUMBERS.fullmatch(node.span.text)
    return None if numbers is None else f"a direction has no unit, and its length does not matter: write `{numbers[1]}`"


def by_corners(node: Node, field: str, length: int) -> str | None:
    """The help for a field that takes a low and a high corner of ``length`` components each; None if unknown.

    With twice as many numbers, these are the corners as they stand; with ``length`` numbers, they are the size of a box
    about the origin.
    """
    text = node.span.source.text[node.span.start : node.span.end]
    numbers = NUMBER.findall(text) if len(text) <= MOST else []
    if len(numbers) == 1:
        numbers = numbers * length
    if len(numbers) == length:
        halves = [abs(float(number)) / 2 for number in numbers]
        corners = [-half for half in halves], halves
    elif len(numbers) == 2 * length:
        given = [float(number) for number in numbers]
        corners = given[:length], given[length:]
    else:
        return None
    low, high = (" ".join(f"{number:g}" for number in corner) for corner in corners)
    return f"write `{field}: [{low}, {high}]`, its low and its high corner"
