"""Help for times that are parts of the whole, as keys in percent, and for two lists of VRML: by the clock's end."""

from __future__ import annotations

import re

from sceneql.language.tree import Mapping, Node, Scalar, Sequence

_END = re.compile(r"^clock:[^#\n]*?(?:\n[ \t]+[^\n]*?)*?\bend:\s*(\d+\.?\d*)\s*(ms|s|min|h)\b", re.MULTILINE)
_PERCENT = re.compile(r"(\d+\.?\d*)\s*%")
FRACTIONS, VALUES = ("key", "keys", "times", "keytimes"), ("keyvalue", "keyvalues", "values", "value")
"""Fields of other programs for a list of times, as parts of the whole, and for the list of values at them."""
FIRST, LAST = {"from": 0.0, "start": 0.0}, {"to": 1.0, "end": 1.0}
"""Keys of CSS for the first and the last instant."""
USUAL = 1.0, "s"


def end_of(script: str) -> tuple[float, str]:
    """The number and the unit of the clock's end in a script's text; 1 s where none is found."""
    found = _END.search(script)
    return USUAL if found is None else (float(found[1]), found[2])


def in_parts(table: Mapping) -> str | None:
    """Keys in percent of the whole, as in CSS, at times until the clock's end; None for other keys."""
    end, unit = end_of(table.source.text)
    told = []
    known = {**FIRST, **LAST}
    if any(_PERCENT.fullmatch(name) for name in table.entries):
        known["0"] = 0.0
    for name, node in table.entries.items():
        percent = _PERCENT.fullmatch(name)
        part = float(percent[1]) / 100.0 if percent else known.get(name)
        if part is None:
            return None
        told.append(f"{part * end:.6g} {unit}: {node.span.text}")
    return f"{{{', '.join(told)}}}" if told else None


def interpolated(node: Mapping) -> str | None:
    """The keys that a list of times and a list of values are, ``key: [0, 1], keyValue: [0 0 0, 0 1 0]``, in braces.

    Times from 0 to 1 are parts of the clock's length. None for other fields.
    """
    named = {name.lower(): value for name, value in node.entries.items()}
    times = next((named[one] for one in FRACTIONS if one in named), None)
    values = next((named[one] for one in VALUES if one in named), None)
    ats, texts = _items(times), _items(values)
    if len(node.entries) != 2 or not ats or len(ats) != len(texts):
        return None
    end, unit = end_of(node.source.text)
    try:
        numbers = [float(one.removesuffix(" s")) for one in ats]
    except ValueError:
        return None
    parts = max(numbers) <= 1.0 and not any(one.endswith("s") for one in ats)
    scale, unit = (end, unit) if parts else (1.0, "s")
    told = ", ".join(f"{one * scale:.6g} {unit}: {text}" for one, text in zip(numbers, texts, strict=True))
    return f"{{keys: {{{told}}}, curve: linear}}"


def _items(node: Node | None) -> list[str]:
    """The texts of a list's items; none of another value."""
    if isinstance(node, Sequence) and all(isinstance(one, Scalar | Sequence) for one in node.items):
        return [one.span.text for one in node.items]
    return []
