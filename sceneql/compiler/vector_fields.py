"""Help for a vector that is written as fields: by times, by the sides of a box, from a place to another."""

from __future__ import annotations

import re

from sceneql.compiler.meant.by_clock import interpolated
from sceneql.language.tree import Mapping, Sequence
from sceneql.quantities.dimension import ANGLE, Dimension
from sceneql.quantities.literal import vector_meant
from sceneql.quantities.units import unit_of

SIDES = (("width", "w", "breadth"), ("height", "h"), ("depth", "d", "length", "l"))
"""Names of the sides of a box along x, y and z."""


TIMES, PAIR = {"time", "t", "at", "frame"}, ("time", "value")
_SECONDS = re.compile(r"[\d.]+\s*(?:s|ms|min|h)")
SHOWN, FRAMES = 120, 30.0
"""Longest list of keys that a message repeats, and frames a second of a film that says nothing else."""
TURN = 6.3
"""[rad] A whole turn, rounded up."""
PLACES = ("position", "pos", "at", "center", "place", "location", "coordinates")
"""Names of a place."""


def vector_meant_by(node: Mapping, what: str) -> str | None:
    """The help for fields that stand in place of a vector's components; None where nothing is known of them.

    ``what``: the vector's own field.
    """
    if (keys := interpolated(node)) is not None:
        return f"write `{what}: {keys}`"
    return timed(node) or _polar(node) or _by_side(node) or _from_to(node) or _placed(node, what.rpartition(".")[2])


def _placed(node: Mapping, what: str) -> str | None:
    """The help where a place stands inside with other fields: ``point: {position: 0 1 0 m, radius: 0.6 m}``."""
    places = [key for key in node.entries if key in PLACES]
    if len(places) != 1:
        return None
    others = ", ".join(f"`{key}: {one.span.text}`" for key, one in node.entries.items() if key != places[0])
    return f"write `{what}: {node.entries[places[0]].span.text}`" + (f", and {others} beside it" if others else "")


def _polar(node: Mapping) -> str | None:
    """The help where a vector is told by its size and a direction, or an angle."""
    texts = {key.lower(): one.span.text for key, one in node.entries.items()}
    size = next((texts[key] for key in ("speed", "magnitude", "size", "strength", "length") if key in texts), None)
    way = next((texts[key] for key in ("direction", "dir", "axis", "along") if key in texts), None)
    angle = next((texts[key] for key in ("angle", "theta", "elevation") if key in texts), None)
    if size is not None and way is not None:
        numbers = ", ".join(way.strip("[]").replace(",", " ").split())
        return f"write `{size}*normalize([{numbers}])`"
    if size is None or angle is None:
        return None
    zero = re.sub(r"^[-+.\d]+(e[-+]?\d+)?", "0", size)
    return f"write `[{size}*cos({angle}), {size}*sin({angle}), {zero}]`"


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
    times = [key if key.strip("-+.0123456789") else f"{key} s" for key in node.entries]
    told = ", ".join(f"{key}: {one.span.text}" for key, one in zip(times, node.entries.values(), strict=True))
    told = told if len(told) <= SHOWN else f"{told[:SHOWN].rpartition(', ')[0]}, ..."
    frames = max((float(key) for key in node.entries if key.isdecimal()), default=0.0)
    by_frame = f"; frame {frames:g} of 30 a second stands at `{frames / FRAMES:.4g} s`" if frames >= FRAMES / 2 else ""
    return f"write `{{keys: {{{told}}}}}`{by_frame}: `sceneql words keys`"


def keys_meant(node: Sequence) -> str | None:
    """The help for a list of pairs of a time and a value, or of `time` and `value`; None of other lists."""
    pairs: list[tuple[str, str]] = []
    for item in node.items:
        if isinstance(item, Sequence) and len(item.items) == len(PAIR):
            pairs.append((item.items[0].span.text, item.items[1].span.text))
        elif isinstance(item, Mapping) and len(item.entries) == len(PAIR) and TIMES & {*item.entries}:
            time = next(key for key in item.entries if key in TIMES)
            pairs.append(
                (item.entries[time].span.text, next(o.span.text for k, o in item.entries.items() if k != time))
            )
    if not pairs or len(pairs) < len(node.items) or not all(_SECONDS.fullmatch(time) for time, _ in pairs):
        return None
    return f"values at times stand under `keys`: write `{{keys: {{{', '.join(f'{t}: {v}' for t, v in pairs)}}}}}`"
