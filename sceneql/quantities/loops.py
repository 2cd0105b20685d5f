"""Lists that loops of other languages make, item by item: for messages alone."""

from __future__ import annotations

import re

_LIST = re.compile(r"\[(.+)\s+for\s+(\w+)\s+in\s+(?:np\.|numpy\.)?(?:range|arange)\(\s*([-\d,\s]+)\)\s*\]")
NONE = "values have no loops"
MOST, LONGEST = 16, 480
"""Largest number of items that a message writes out, and of their characters."""


def _components(text: str) -> list[str]:
    """The pieces of a text between commas outside of brackets."""
    pieces, depth = [""], 0
    for character in text:
        depth += (character in "([") - (character in ")]")
        pieces, rest = ([*pieces, ""], "") if character == "," and depth == 0 else (pieces, character)
        pieces[-1] += rest
    return pieces


def written_out(text: str) -> str | None:
    """The help for ``[2*i for i in range(3)]``: its items one by one, or how many there are; None of other texts."""
    found = _LIST.search(text) if len(text) <= 1000 else None
    numbers = [] if found is None else [int(one) for one in found[3].split(",") if one.strip().lstrip("-").isdecimal()]
    if found is None or not 1 <= len(numbers) <= 3 or (len(numbers) == 3 and numbers[2] == 0):
        return None
    counted = range(*numbers)
    place = found[1].strip()
    if place.startswith("[") and place.endswith("]") and len(numbers) == 1:
        point = ", ".join(f'"{one.strip()}"' if "(" in one else one.strip() for one in _components(place[1:-1]))
        whole = f"[{{repeat: {{count: {numbers[0]}, as: {found[2]}}}, point: [{point}]}}]"
        return f"{NONE}: places that are computed stand in a list as `{whole}`"
    items = [re.sub(rf"(?<![\w.]){found[2]}\b", str(k), found[1].strip()) for k in counted[:MOST]]
    whole = f"[{', '.join(items)}]"
    if len(counted) <= MOST and len(whole) <= LONGEST:
        return f'{NONE}: write its items one by one, `"{whole}"`'
    shown = f"`{items[0]}`, `{items[1]}`, ..." if len(items) > 1 else f"`{whole}`"
    parts = f"of parts made by `repeat: {{count: {len(counted)}, as: {found[2]}}}` each has its own formula"
    return f"{NONE}: write all {len(counted)} items one by one, {shown}; {parts}: `sceneql words repeat`"
