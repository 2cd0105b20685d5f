"""Help for a capsule of other programs: the tube between two points that it is here."""

from __future__ import annotations

from sceneql.compiler.meant.own_values import numbers_with_unit
from sceneql.language.tree import Mapping, Node

CAPSULES = ("capsule", "pill", "capsulegeometry")
HEIGHTS, PLACES = ("height", "length"), ("position", "pos", "center", "location", "translation")
USUAL_RADIUS, USUAL_HEIGHT = 0.5, 2.0
"""Of other programs' capsules [m]."""
LEAST = 0.01
"""Part of the radius that the middle has at least."""


def capsule(word: str, fields: Node | None) -> str | None:
    """The help for an object called a capsule, upright, of a height that its round ends are part of; None for others.

    A capsule is a tube.
    """
    if word.lower() not in CAPSULES:
        return None
    given = fields.entries if isinstance(fields, Mapping) else {}
    numbers = {name: numbers_with_unit(node.span.text) for name, node in given.items()}
    radius = next((one for name in ("radius",) if (one := numbers.get(name))), ([USUAL_RADIUS], "m"))
    height = next((one for name in HEIGHTS if (one := numbers.get(name))), ([USUAL_HEIGHT], "m"))
    place = next((one for name in PLACES if (one := numbers.get(name))), ([0.0, 0.0, 0.0], "m"))
    units = {one[1] or "m" for one in (radius, height, place)}
    if len(units) > 1 or len(place[0]) != 3:
        return "a capsule is a tube of two points: write `{tube: {through: [0 0 0 m, 0 1 0 m], radius: 0.2 m}}`"
    (unit,) = units
    half = max(height[0][0] / 2.0 - radius[0][0], LEAST * radius[0][0])
    x, y, z = place[0]
    ends = ", ".join(f"{x:g} {0.0 + y + side:.6g} {z:g} {unit}" for side in (-half, half))
    known = {*HEIGHTS, *PLACES, "radius"}
    rest = "".join(f", {name}: {node.span.text}" for name, node in given.items() if name not in known)
    told = f"{{tube: {{through: [{ends}], radius: {radius[0][0]:g} {unit}{rest}}}}}"
    return f"a capsule is a tube of two points: write `{told}`; a model moves it in a group"
