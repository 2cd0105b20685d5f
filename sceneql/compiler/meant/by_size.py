"""Help for quantities of a whole thing where what a square or cubic meter of it has is asked for: 0.3 kg of a cloth.

``reader`` is the `Reader` (`sceneql.compiler.read`) that met the value.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from math import prod
from typing import Any

from pydantic import BaseModel

from sceneql import kinds
from sceneql.compiler import values
from sceneql.compiler.annotations import quantities
from sceneql.compiler.meant.own_values import in_si
from sceneql.kinds.word import read_default
from sceneql.language.tree import Node, Scalar
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.dimension import LENGTH, Dimension
from sceneql.quantities.units import format_quantity

FLAT = 2
"""Sides of a box in the plane."""
SIZE = "size"
"""The field that tells how large a thing is along its axes."""
PARABOLA = re.compile(r"y\*\(0\.4 - y\)")
"""What comes in by height in the manual's example, of a box 0.4 m high."""


def in_own_box(reader: Any, written: Mapping[str, Node], first: int) -> None:
    """Let the helps from error number ``first`` on that show what comes in by height do so for the box's own."""
    size = in_si(written[SIZE].span.text) if SIZE in written else []
    for k, one in enumerate(reader.found.found[first:], first) if len(size) == FLAT and "corner" not in written else ():
        if one.help is not None and PARABOLA.search(one.help):
            own = PARABOLA.sub(f"y*({size[1]:g} - y)", one.help)
            reader.found.found[k] = replace(one, help=own)


def by_own_size(reader: Any, written: Mapping[str, Node], cls: type[BaseModel], name: str, first: int) -> None:
    """Let the help of error number ``first`` divide a field's value by the area or volume of the `size` beside it."""
    errors, node = reader.found.found, written[name]
    info = _field_of(cls, name)
    wanted = next((one.dimension for one in quantities(info) if one.dimension is not None and not one.shape), None)
    size = _field_of(cls, SIZE)
    if len(errors) <= first or errors[first].code != "dimension-mismatch" or wanted is None or size is None:
        return
    sides = _sides(reader, written, size)
    value = _constant(reader, node, wanted * LENGTH ** len(sides))
    if sides and value is not None and min(sides) > 0:
        amount = format_quantity(float(f"{value / prod(sides):.6g}"), wanted)
        told = " x ".join(f"{side:g}" for side in sides)
        what = "area" if len(sides) == 2 else "volume"
        help = f"it is that of the whole {what}, {told} m: write `{name}: {amount}`"
        errors[first] = replace(errors[first], help=help)


def _field_of(cls: type[BaseModel], name: str) -> Any:
    return next((info for key, info in cls.model_fields.items() if kinds.written_name(key) == name), None)


def _sides(reader: Any, written: Mapping[str, Node], size: Any) -> tuple[float, ...]:
    """The two or three numbers of a size [m], its default where none is written; none where they are not known."""
    mark = next((one for one in quantities(size) if one.shape in ((2,), (3,))), None)
    if mark is None or mark.dimension != LENGTH:
        return ()
    if SIZE not in written:
        default: Any = (size.json_schema_extra or {}).get("default")
        return tuple(read_default(size)) if isinstance(default, str) else ()
    value = values.read_value(written[SIZE], mark, SIZE, reader.names, Diagnostics())
    return tuple(value.number()) if value is not None and value.constant else ()


def _constant(reader: Any, node: Node, dimension: Dimension) -> float | None:
    """A constant value of a dimension in SI; None for another."""
    names = replace(reader.names, found=Diagnostics())
    mark = kinds.Quantity(dimension)
    value = values.read_value(node, mark, "", names, names.found) if isinstance(node, Scalar) else None
    return float(value.number()) if value is not None and value.constant else None
