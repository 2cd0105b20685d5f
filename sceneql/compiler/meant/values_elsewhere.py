"""Values that suit another field: several numbers where one stands, a quantity of another field's dimension.

``reader`` is the `Reader` (`sceneql.compiler.read`) that met the value.
"""

from __future__ import annotations

from collections.abc import Collection
from collections.abc import Mapping as Naming
from dataclasses import replace
from typing import Any

from sceneql import kinds
from sceneql.compiler import values
from sceneql.compiler.annotations import quantities
from sceneql.compiler.vector_fields import ENDS
from sceneql.language.tree import Mapping, Node, Sequence
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.dimension import VELOCITY
from sceneql.quantities.literal import vector_meant
from sceneql.quantities.spaced import mean_and_more, two_ends

AXES, PAIR = 3, 2
"""Components of a vector in space, and ends of a range."""


def first_of(name: str, node: Node) -> str | None:
    """The help for several values of a field that has one: the first, with its unit."""
    if isinstance(node, Sequence):
        first = node.items[0].span.text if node.items else ""
    else:
        first, *more = node.span.text.replace(",", " ").split() or ("",)
        first += f" {more[-1]}" if more and (more[-1][:1].isalpha() or more[-1] == "%") else ""
    several = isinstance(node, Sequence) and len(node.items) > 1
    others = ", and a part of its own for each of the others" if several else ""
    return f"it is one number: write `{name}: {first}`{others}" if first else None


def elsewhere(reader: Any, node: Node, info: Any, others: Naming[str, Any]) -> str | None:
    """The help for a wrong count of numbers: the one other field that takes them."""
    found = {name: mark for name, mark in quantities_fitting(reader, node, others).items() if mark.shape}
    if len(found) > 1:
        own = [mark.dimension for mark in quantities(info)]
        found = {name: mark for name, mark in found.items() if mark.dimension in own}
    if len(found) != 1:
        return None
    return f"that is what `{(name := kinds.written_name(*found))}` takes: write `{name}: {node.span.text}`"


def quantities_fitting(reader: Any, node: Node, fields: Naming[str, Any]) -> dict[str, kinds.Quantity]:
    """The fields of quantities that accept a value."""
    nothing = Diagnostics()
    names = replace(reader.names, found=nothing)
    marked = [(name, mark) for name, info in fields.items() for mark in quantities(info)]
    return {name: mark for name, mark in marked if values.read_value(node, mark, name, names, nothing) is not None}


def along_default(node: Node, info: Any) -> str | None:
    """The help for one number where a vector stands whose default is along an axis: as long as it, along that."""
    extra: Any = info.json_schema_extra or {}
    given = [mark.dimension for mark in quantities(info) if mark.shape == (AXES,)]
    usual = "1 0 0 m/s" if given == [VELOCITY] else ""
    *numbers, unit = str(extra.get("default") or usual).split() or [""]
    axes = [k for k, number in enumerate(numbers) if number.strip("-0.")]
    text = node.span.text.split()
    if len(numbers) != AXES or len(axes) != 1 or len(text) != 2 or text[1] != unit:
        return None
    own = text[0].lstrip("+-") if numbers[axes[0]].startswith("-") else text[0]
    whole = " ".join(own if k == axes[0] else "0" for k in range(AXES))
    return f"write `{whole} {unit}`, a number for each axis"


def middle_of_ends(name: str, node: Node, fields: Collection[str]) -> str | None:
    """The help for the two ends of a range where a field is one number: the mean, and what lets it vary, if any."""
    text = node.span.text.strip("\"'")
    if isinstance(node, Sequence) and len(node.items) == PAIR:
        text = vector_meant(", ".join(item.span.text for item in node.items)) or ""
    if isinstance(node, Mapping):
        text = _of_fields(node)
    if (about := mean_and_more(text)) is not None:
        middle, more, of = about
        text = f"{float(middle) - float(more):.6g} {float(middle) + float(more):.6g} {of}".strip()
    ends = two_ends(text) or (text if about or isinstance(node, Sequence | Mapping) else None)
    if ends is None or len(ends.split()) < PAIR:
        return None
    low, high, *unit = ends.split()
    mean, half = (float(low) + float(high)) / 2, (float(high) - float(low)) / 2
    varied = f", and `variation: {half / mean:.2g}` beside it" if "variation" in fields and mean > half >= 0 else ""
    return f"it is one number, as their mean: write `{name}: {' '.join([f'{mean:.6g}', *unit])}`{varied}"


def _of_fields(node: Mapping) -> str:
    """Two ends by names, ``{min: 1 s, max: 3 s}``, or a mean and a deviation, as a vector of two; empty for others."""
    texts = {key: value.span.text for key, value in node.entries.items()}
    pair = next((pair for pair in zip(*ENDS, strict=False) if {*pair} == {*texts}), None)
    return "" if pair is None else vector_meant(", ".join(texts[key] for key in pair)) or ""
