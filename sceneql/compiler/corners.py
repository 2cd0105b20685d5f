"""Suggested text for a box that should be given by its corners and is written otherwise."""

from __future__ import annotations

import re

from sceneql.language.tree import Node

NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
MOST = 200
"""Largest length of a value in which numbers are looked for."""


def by_corners(node: Node, field: str, length: int) -> str | None:
    """The help for a field that takes a low and a high corner of ``length`` components each; None if unknown.

    With twice as many numbers, these are the corners as they stand; with ``length`` numbers, they are the size of a box
    about the origin.
    """
    text = node.span.source.text[node.span.start : node.span.end]
    numbers = NUMBER.findall(text) if len(text) <= MOST else []
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
