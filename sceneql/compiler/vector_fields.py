"""Help for a vector that is written as fields: by times, by the sides of a box, from a place to another."""

from __future__ import annotations

from sceneql.language.tree import Mapping
from sceneql.quantities.dimension import ANGLE, Dimension
from sceneql.quantities.literal import vector_meant
from sceneql.quantities.units import unit_of

SIDES = (("width", "w", "breadth"), ("height", "h"), ("depth", "d", "length", "l"))
"""Names of the sides of a box along x, y and z."""


TURN = 6.3
"""[rad] A whole turn, rounded up."""
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


ENDS = (("lower", "min", "low", "minimum", "least", "from", "start"), ("upper", "max", "high", "maximum", "to", "end"))
"""Names of the two ends of a range."""


def pair_meant(node: Mapping, dimension: Dimension | None) -> str | None:
    """The help where the two ends of a range have names; numbers without a unit get that of the dimension."""
    ends = [next((key for key in node.entries if key.lower() in names), None) for names in ENDS]
    texts = [node.entries[key].span.text for key in ends if key is not None]
    if len(texts) != len(ENDS):
        return None
    try:
        bare = [abs(float(text)) for text in texts]
    except ValueError:
        return f"write `{vector_meant(', '.join(texts)) or f'[{chr(44).join(texts)}]'}`, the least and the greatest"
    unit = "" if dimension is None or dimension.plain else f" {unit_of(dimension)}"
    if dimension is not None and dimension.kind == ANGLE.kind:
        unit = " rad" if max(bare) <= TURN else " deg"
    return f"write `{' '.join(texts)}{unit}`, the least and the greatest"


def timed(node: Mapping) -> str | None:
    """The help where times and values stand without `keys` around them."""
    if not node.entries or not all(key[:1].isdigit() for key in node.entries):
        return None
    first = next(iter(node.entries))
    return f"write `{{keys: {{{first}: {node.entries[first].span.text}, ...}}}}`: `sceneql words keys`"
