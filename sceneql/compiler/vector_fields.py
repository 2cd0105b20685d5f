"""Help for a vector that is written as fields: by times, by the sides of a box, from a place to another."""

from __future__ import annotations

from sceneql.language.tree import Mapping

SIDES = (("width", "w", "breadth"), ("height", "h"), ("depth", "d", "length", "l"))
"""Names of the sides of a box along x, y and z."""


PLACES = ("position", "pos", "at", "center", "place", "location", "coordinates")
"""Names of a place."""


def vector_meant_by(node: Mapping, what: str) -> str | None:
    """The help for fields that stand in place of a vector's components; None where nothing is known of them.

    ``what``: the vector's own field.
    """
    return timed(node) or _by_side(node) or _from_to(node) or _placed(node, what.rpartition(".")[2])


def _placed(node: Mapping, what: str) -> str | None:
    """The help where a place stands inside with other fields: ``point: {position: 0 1 0 m, radius: 0.6 m}``."""
    places = [key for key in node.entries if key in PLACES]
    if len(places) != 1:
        return None
    others = ", ".join(f"`{key}: {one.span.text}`" for key, one in node.entries.items() if key != places[0])
    return f"write `{what}: {node.entries[places[0]].span.text}`" + (f", and {others} beside it" if others else "")


def _by_side(node: Mapping) -> str | None:
    """The help where the sides of a box have names: width, height and depth."""
    sides = [next((key for key in node.entries if key.lower() in names), None) for names in SIDES]
    if None in sides or len(node.entries) != len(SIDES):
        return None
    return f"write `[{', '.join(node.entries[side].span.text for side in sides if side)}]`, along x, y and z"


def _from_to(node: Mapping) -> str | None:
    """The help where a value goes from one to another."""
    ends = [node.entries[key].span.text for key in ("from", "to") if key in node.entries]
    return f"write `{{keys: {{0 s: {ends[0]}, 2 s: {ends[1]}}}}}`: `sceneql words keys`" if len(ends) == 2 else None


def timed(node: Mapping) -> str | None:
    """The help where times and values stand without `keys` around them."""
    if not node.entries or not all(key[:1].isdigit() for key in node.entries):
        return None
    first = next(iter(node.entries))
    return f"write `{{keys: {{{first}: {node.entries[first].span.text}, ...}}}}`: `sceneql words keys`"
