"""Help for unknown fields that are one field together, or a group of fields where they stand alone."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection
from collections.abc import Sequence as Sequenced

from sceneql.compiler.vector_fields import ENDS
from sceneql.language.tree import Mapping, Node, Scalar
from sceneql.language.tree import Sequence as SequenceNode
from sceneql.quantities.instead import instead
from sceneql.quantities.literal import vector_meant
from sceneql.quantities.span import Source

Renamed = Callable[[str, Node], tuple[bool, str]]
"""For a known field and a value: whether the field takes it, and the help that offers the field."""


def ends(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str], offer: Renamed) -> str | None:
    """The help for the two ends of a range beside the other fields of what has a field for both: ``min``, ``max``."""
    field = next((one for one in ("limits", "range") if one in known and one not in node.entries), None)
    both = next((pair for pair in zip(*ENDS, strict=False) if name in pair and {*pair} <= {*unknown}), None)
    if field is None or both is None:
        return None
    low, high = (node.entries[one].span.text for one in both)
    text = vector_meant(f"{low}, {high}") or f"[{low}, {high}]"
    return offer(field, Scalar(text, "text", False, Source("value", text), 0, len(text)))[1]


def flat(name: str, value: Node, known: Collection[str]) -> str | None:
    """The help for a group of fields that stand among the others here, or a group in it."""
    inner = next(iter(value.entries.values())) if isinstance(value, Mapping) and len(value.entries) == 1 else None
    if isinstance(inner, Mapping) and not {*value.entries} & {*known}:  # type: ignore[union-attr]
        return flat(name, inner, known)
    if not isinstance(value, Mapping) or not value.entries or not all(inner in known for inner in value.entries):
        return None
    told = ", ".join(f"{inner}: {node.span.text}" for inner, node in value.entries.items())
    return f"they stand among the other fields, without `{name}`: write `{told}`"


def of_inner(value: Node) -> str | None:
    """The help for a group of fields that stand in another part here."""
    inner = value.entries if isinstance(value, Mapping) else ()
    return next((help for one in inner if (help := instead("field", one)) is not None), None)


def numbered_alike(
    name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str], offer: Renamed
) -> str | None:
    """The help for fields with numbers behind them that one field lists: ``y1: a, y2: b``."""
    base = re.sub(r"_?\d+$", "", name)
    alike = [one for one in unknown if one != base and re.sub(r"_?\d+$", "", one) == base]
    values = [node.entries[one] for one in alike]
    field = base if base in known else f"{base}s" if f"{base}s" in known else ""
    if len(alike) < 2 or name not in alike or not field or field in node.entries:
        return None
    text = f"[{', '.join(one.span.text for one in values)}]"
    source = values[0].source
    fits, help = offer(field, SequenceNode(values, True, source, values[0].start, values[0].end))
    return f"write `{field}: {text}`" if fits else help
