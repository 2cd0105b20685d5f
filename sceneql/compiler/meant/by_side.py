"""Help for parts of a solid that are told by the names of sides: the formula by the box of the solid.

``reader`` is the `Reader` (`sceneql.compiler.read`) that met the value.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import Any

from pydantic import BaseModel

from sceneql import kinds
from sceneql.compiler.meant.values_elsewhere import quantities_fitting
from sceneql.compiler.passes.fillings import Beginning
from sceneql.compiler.passes.overlaps import UNKNOWN
from sceneql.compiler.problems import Unreadable
from sceneql.graph import Task
from sceneql.language.tree import Mapping, Node, Scalar, Sequence
from sceneql.quantities.diagnostic import Diagnostics, same_as

SIDES = {"left": (0, 0), "right": (0, 1), "bottom": (1, 0), "top": (1, 1), "back": (2, 0), "front": (2, 1)}
"""Names of sides: the number of the axis, and whether it is that of the low or the high end."""
NEAR = 0.02
"""Part of the box's size that counts as its side."""


def part_at_side(reader: Any, node: Node, cls: Any) -> str | None:
    """The help for a name of a side in place of the fields of a part of a solid: ``{where: x < 3.08}``."""
    if not isinstance(node, Scalar) or not _told_by_place(cls):
        return None
    formula = _formula(reader, node.text)
    return None if formula is None else f"write `{{where: {formula}}}`"


def parts_at_sides(reader: Any, node: Node, item: Any, what: str) -> str | None:
    """The help for names of sides in place of parts of a solid by names: ``hold: left``."""
    items = node.items if isinstance(node, Sequence) else [node]
    if not _told_by_place(item) or not all(isinstance(one, Scalar) for one in items):
        return None
    names = [one.text for one in items if isinstance(one, Scalar)]
    told = [(name, _formula(reader, name)) for name in names]
    if not told or any(formula is None for _, formula in told):
        return _at_end(reader, node, item, what)
    inner = ", ".join(f"{name}: {{where: {formula}}}" for name, formula in told)
    return f"write `{what}: {{{inner}}}`"


def _at_end(reader: Any, node: Node, item: Any, what: str) -> str | None:
    """The help for one value in place of parts of a solid that have it: at the right end, ``loads: 0 -5 0 N``."""
    fitting = quantities_fitting(reader, node, item.model_fields) if isinstance(node, Scalar) else {}
    formula = _formula(reader, "right") if len(fitting) == 1 else None
    if formula is None:
        return None
    field = kinds.written_name(next(iter(fitting)))
    inner = f"{{right: {{where: {formula}, {field}: {node.span.text}}}}}"
    return f"it is told with its place: write `{what}: {inner}`, or where else it is"


def _told_by_place(cls: Any) -> bool:
    """Whether a record is a part of a solid."""
    known = cls.model_fields if isinstance(cls, type) and issubclass(cls, BaseModel) else {}
    return {"where", "near", "object"} <= {*known}


def _formula(reader: Any, name: str) -> str | None:
    """The formula of what lies at a side of the model's solid, by the solid's box; None of another name."""
    side = same_as(name.lower(), SIDES)
    box = None if side is None else _box(reader)
    if side is None or box is None:
        return None
    axis, high = SIDES[side]
    low_end, high_end = box[0][axis], box[1][axis]
    away = NEAR * (high_end - low_end)
    letter = "xyz"[axis]
    return f"{letter} > {high_end - away:.4g}" if high else f"{letter} < {low_end + away:.4g}"


def _box(reader: Any) -> tuple[list[float], list[float]] | None:
    """Low and high corner [m] of the object that the reader's model is of; None where the script does not tell."""
    entry = reader.names.parts.get(reader.owner.partition(".")[0])
    node = entry.fields.entries.get("of") if entry is not None and isinstance(entry.fields, Mapping) else None
    word, fields, span = "", node, None if node is None else node.span
    if isinstance(node, Scalar) and node.text in reader.names.parts:
        own = reader.names.parts[node.text]
        word, fields, span = own.word, own.fields, own.span
    elif isinstance(node, Mapping) and len(node.entries) == 1:
        word, fields = next(iter(node.entries.items()))
    cls = reader.names.catalogue.load("objects", word) if word else None
    if cls is None:
        return None
    nothing = Diagnostics()
    trial = replace(
        reader, found=nothing, names=replace(reader.names, found=nothing), refer=lambda node, mark, name: None, files=[]
    )
    with suppress(Unreadable, *UNKNOWN):
        import numpy as np

        kind: kinds.Object = trial.record(fields, cls, span, word)
        moment: Any = Beginning({word: Task(word, word, kind, span)})
        low, high = kind.extent(np.eye(3, 4), moment)
        if np.isfinite([low, high]).all() and (np.asarray(high) > np.asarray(low)).all():
            return [float(one) for one in low], [float(one) for one in high]
    return None
