"""Help for words of other programs that are other words here, with the numbers that the author wrote worked out."""

from __future__ import annotations

import re
from collections.abc import Collection
from collections.abc import Mapping as Naming
from math import cos, pi

from sceneql.compiler.meant.own_values import in_si, numbers_with_unit
from sceneql.language.tree import Mapping, Node

CAPSULES = ("capsule", "pill", "capsulegeometry")
ELLIPSOIDS = ("ellipsoid", "egg", "spheroid")
CONES = ("cone", "pyramid", "frustum", "conegeometry")
LINES = ("line", "polyline", "segment", "linesegments", "rod", "stick", "beam", "edge")
EMITTERS = (
    "popnet", "pop", "emitter", "particle_system", "particlesystem", "particle_emitter", "dust", "sparks", "sparkles",
    "snow", "rain", "fireworks",
)  # fmt: skip
"""Words of other programs."""
HEIGHTS, PLACES = ("height", "length", "h"), ("position", "pos", "center", "location", "translation")
RADII, SIZES = ("radii", "semi_axes", "semiaxes", "half_axes"), ("size", "dimensions", "scale")
BOTTOMS = ("radius_bottom", "bottom_radius", "radiusbottom", "radius1", "r1", "radius", "r")
TOPS = ("radius_top", "top_radius", "radiustop", "radius2", "r2")
SPEEDS, LIVES = ("speed", "velocity", "initial_velocity", "start_speed"), ("lifetime", "life", "start_lifetime", "age")
RATES, COUNTS = ("rate", "emission_rate", "birth_rate", "birthrate", "emission"), ("count", "amount", "number", "max")
FROM = ("from", "position", "origin", "at", "source", "location")
"""Their fields."""
LOOKS = ("color", "material", "hidden")
USUAL_RADIUS, USUAL_HEIGHT, USUAL_LIFE = 0.5, 2.0, 2.0
"""Of other programs' capsules and cones [m], and of particles [s]."""
LEAST = 0.01
"""Part of the radius that a capsule's middle, and a cone's tip, have at least."""
SIDES = range(4, 13, 2)
"""Numbers of sides of the prisms that boxes make."""
_SPEED = re.compile(r"(\d+\.?\d*)\s*([^\W\d]\S*)?")
Numbers = tuple[list[float], str]


def other_word(word: str, family: str, fields: Node | None) -> str | None:
    """The help for a word of another program by its fields; None for other words."""
    given = fields.entries if isinstance(fields, Mapping) else {}
    named = word.lower()
    if family == "objects" and named in CAPSULES:
        return _capsule(given)
    if family == "objects" and named in ELLIPSOIDS:
        return _ellipsoid(given)
    if family == "objects" and named in LINES:
        return _line(given)
    if family == "objects" and named in CONES:
        return _cone(given)
    return _emitter(given) if family == "models" and named in EMITTERS else None


def prism(fields: Naming[str, Node], name: str) -> str | None:
    """The help for a number of facets so small that a prism is meant, in place of a cylinder; None for others."""
    count, radius, height = fields[name].span.text, _first(fields, ("radius",)), _first(fields, ("height",))
    if not count.isdecimal() or int(count) not in SIDES or radius is None or height is None or radius[1] != height[1]:
        return None
    sides, unit = int(count), f" {radius[1]}" if radius[1] else ""
    across = f"{2 * radius[0][0] * cos(pi / sides):.5g}"
    size = f"size: {across} {height[0][0]:g} {2 * radius[0][0]:g}{unit}"
    place = f", position: {fields['position'].span.text}" if "position" in fields else ""
    boxes = []
    for k in range(sides // 2):
        turn = f", rotation: {{about: y, angle: {360 * k / sides:g} deg}}" if k else ""
        boxes.append(f"{{box: {{{size}{place}{turn}}}}}")
    told = f"{{intersection: {{of: [{', '.join(boxes)}]{_looks(fields)}}}}}"
    return f"a cylinder is round; a prism of {sides} sides is what boxes have in common: write `{told}`"


def _first(given: Naming[str, Node], names: Collection[str]) -> Numbers | None:
    """The numbers of the first of some fields that has plain ones, and their unit."""
    lower = {key.lower(): node for key, node in given.items()}
    return next((one for name in names if name in lower and (one := numbers_with_unit(lower[name].span.text))), None)


def _text(given: Naming[str, Node], names: Collection[str]) -> str | None:
    lower = {key.lower(): node for key, node in given.items()}
    return next((lower[name].span.text for name in names if name in lower), None)


def _looks(given: Naming[str, Node]) -> str:
    return "".join(f", {name}: {given[name].span.text}" for name in LOOKS if name in given)


def _placed(given: Naming[str, Node]) -> str:
    text = _text(given, PLACES)
    return "" if text is None else f", position: {text}"


def _capsule(given: Naming[str, Node]) -> str:
    """A capsule, upright, of a height that its round ends are part of, as a tube."""
    radius = _first(given, ("radius", "r")) or ([USUAL_RADIUS], "m")
    height = _first(given, HEIGHTS) or ([USUAL_HEIGHT], "m")
    place = _first(given, PLACES) or ([0.0, 0.0, 0.0], "m")
    units = {one[1] or "m" for one in (radius, height, place)}
    if len(units) > 1 or len(place[0]) != 3:
        return "a capsule is a tube of two points: write `{tube: {through: [0 0 0 m, 0 1 0 m], radius: 0.2 m}}`"
    (unit,) = units
    half = max(height[0][0] / 2.0 - radius[0][0], LEAST * radius[0][0])
    x, y, z = place[0]
    ends = ", ".join(f"{x:g} {0.0 + y + side:.6g} {z:g} {unit}" for side in (-half, half))
    told = f"{{tube: {{through: [{ends}], radius: {radius[0][0]:g} {unit}{_looks(given)}}}}}"
    return f"a capsule is a tube of two points: write `{told}`; a model moves it in a group"


def _line(given: Naming[str, Node]) -> str | None:
    """A line from place to place, or through several, as a tube."""
    both = [_text(given, names) for names in (("from", "start", "p1", "a"), ("to", "end", "p2", "b"))]
    points = _text(given, ("points", "vertices", "path", "through"))
    points = points or (f"[{', '.join(filter(None, both))}]" if all(both) else None)
    if points is None or "\n" in points:
        return None
    radius = _text(given, ("radius", "r")) or "1 cm"
    told = f"{{tube: {{through: {points}, radius: {radius}{_looks(given)}}}}}"
    return f"a line is a thin tube: write `{told}`"


def _ellipsoid(given: Naming[str, Node]) -> str:
    """An ellipsoid by its half axes, or by its size, as a ball of 1 m that a group stretches."""
    half = 1.0
    axes = in_si(_text(given, RADII) or "")
    if len(axes) != 3:
        texts = [_text(given, names) or "" for names in (("rx", "a"), ("ry", "b"), ("rz", "c"))]
        axes = [number for text in texts for number in in_si(text)[:1]]
    if len(axes) != 3:
        axes, half = in_si(_text(given, SIZES) or ""), 0.5 if _text(given, SIZES[:2]) else 1.0
        radius = in_si(_text(given, ("radius", "r")) or "")
        axes = radius if len(radius) == 3 else [one * (radius or [1.0])[0] for one in axes]
        half = 1.0 if len(radius) == 3 else half
    scale = " ".join(f"{half * one:.6g}" for one in (axes if len(axes) == 3 else [1.0, 0.5, 1.0]))
    ball = f"{{sphere: {{radius: 1 m{_looks(given)}}}}}"
    told = f"{{group: {{children: [{ball}], scale: {scale}{_placed(given)}}}}}"
    return f"it is a ball of 1 m that a group stretches: write `{told}`"


def _cone(given: Naming[str, Node]) -> str:
    """A cone, or part of one, as a tapered cylinder."""
    lower, upper = _first(given, BOTTOMS), _first(given, TOPS)
    bottom = _text(given, BOTTOMS) or f"{USUAL_RADIUS:g} m"
    same = lower is not None and upper is not None and lower[1] == upper[1] and lower[0][0] > 0.0
    factor = max(upper[0][0] / lower[0][0], LEAST) if same and upper and lower else LEAST
    inner = f"radius: {bottom}, height: {_text(given, HEIGHTS) or f'{USUAL_HEIGHT:g} m'}{_placed(given)}"
    told = f"{{taper: {{of: {{cylinder: {{{inner}}}}}, factor: {factor:.3g}{_looks(given)}}}}}"
    return f"a cone is a cylinder that is tapered: write `{told}`"


def _emitter(given: Naming[str, Node]) -> str:
    """A particle system as particles that are born."""
    life = _text(given, LIVES) or f"{USUAL_LIFE:g} s"
    count, seconds = in_si(_text(given, COUNTS) or ""), in_si(life)
    rate = _text(given, RATES)
    if rate is None and len(count) == 1 and len(seconds) == 1 and seconds[0] > 0:
        rate = f"{count[0] / seconds[0]:.4g} /s"
    speed = _text(given, SPEEDS) or "0 3 0 m/s"
    if (one := _SPEED.fullmatch(speed.strip())) is not None:
        speed = f"0 {one[1]} 0 {one[2] or 'm/s'}"
    place = _text(given, FROM)
    at = "" if place is None else f"from: {place}, "
    size = _text(given, ("radius",))
    look = _looks({name: node for name, node in given.items() if name != "hidden"})
    more = f", radius: {size}{look}" if size is not None else look
    rate = rate if rate is None or not rate.replace(".", "").isdecimal() else f"{rate} /s"
    return (
        f"write `{{particles: {{emit: {{{at}rate: {rate or '100 /s'}, velocity: {speed}, lifetime: {life}}}{more}}}}}`"
    )
