"""Help for fields that are one here: two ends, the sides of a box, an axis and its angle, frames of a clock."""

from __future__ import annotations

from collections.abc import Collection
from collections.abc import Sequence as Sequenced

from sceneql.language.tree import Mapping, Node, Scalar
from sceneql.quantities.diagnostic import same_as
from sceneql.quantities.literal import vector_meant

SIZES = ("width", "height", "depth", "length")
TURNS = ("rotation", "turn")
"""Fields that turn a part."""
FIRST, LAST = (
    ("frame_start", "start_frame", "first_frame"),
    ("frame_end", "end_frame", "last_frame", "frames", "nframes"),
)
"""Fields of other programs for the numbers of a film's first and last frame."""
USUAL = 30.0
"""Frames a second of a clock that says nothing else."""


def together(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for fields that are one here: ``from: a, to: b``, and items of a list without brackets."""
    if (told := _turned(name, unknown, node, known) or _by_frames(name, node, known)) is not None:
        return told
    ours = same_as(name, known)
    same = [other for other in unknown if same_as(other, known) == ours]
    if ours == "between" and len(same) == 2 and ours not in node.entries:
        return f"write `{ours}: [{', '.join(node.entries[other].span.text for other in same)}]`"
    sides = [other for other in SIZES if other in unknown]
    flat = "rotation" not in known or "cells" in known  # of a box there are three
    if name in sides and len(sides) > (1 if flat else 2) and "size" in known and "size" not in node.entries:
        texts = [node.entries[other].span.text for other in sides]
        if (size := vector_meant(", ".join(texts))) is not None:
            return f"write `size: {size}`"
    whole, _, part = name.rpartition(".")
    parts = [other for other in unknown if other.rpartition(".")[0] == whole and other[-1:] in "xyz"]
    if (whole or "position") in known and part in ("x", "y", "z"):
        values = (f"{each[-1]}: {node.entries[each].span.text}" for each in parts)
        return f"write `{whole or 'position'}: {{{', '.join(values)}}}`"
    names = list(node.entries)
    first = names.index(name)
    while first and names[first] not in known and _empty(node.entries[names[first]]):
        first -= 1
    items = [node.entries[names[first]].span.text, *names[first + 1 : names.index(name) + 1]]
    field = names[first] if names[first] in known else same_as(names[first], known)
    if len(items) > 1 and field is not None and isinstance(node.entries[names[first]], Scalar):
        return f"a list stands in brackets: write `{field}: [{', '.join(items)}]`"
    return None


def _empty(node: Node) -> bool:
    return isinstance(node, Scalar) and node.kind == "null" and not node.quoted


def _turned(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for an axis and an angle beside the other fields of what has a field for both."""
    field = next((one for one in TURNS if one in known), None)
    if field is None or name not in ("axis", "angle") or field in node.entries or not {"axis", "angle"} <= {*unknown}:
        return None
    axis, angle = (node.entries[one].span.text for one in ("axis", "angle"))
    axis = axis if axis.strip("-") in "xyz" else f"[{', '.join(axis.strip('[]').replace(',', ' ').split())}]"
    return f"write `{field}: {{about: {axis}, angle: {angle}}}`"


def _by_frames(name: str, node: Mapping, known: Collection[str]) -> str | None:
    """The help for the numbers of a film's frames in place of its length."""
    if not {"end", "fps"} <= {*known} or name not in (*FIRST, *LAST):
        return None
    if name in FIRST:
        return "a film begins at 0 s: leave it out"
    try:
        rate = float(node.entries["fps"].span.text) if "fps" in node.entries else USUAL
        frames = float(node.entries[name].span.text)
    except ValueError:
        return None
    return f"`end` is a time: for {frames:g} frames, {rate:g} of them a second, write `end: {frames / rate:.6g} s`"
