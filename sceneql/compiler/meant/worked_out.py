"""Help for fields of other programs whose value here is worked out: a lens, a cone, an arrow from place to place."""

from __future__ import annotations

import re
from collections.abc import Collection
from collections.abc import Sequence as Sequenced
from math import atan, degrees, tau

from sceneql.compiler.meant.other_shapes import prism
from sceneql.compiler.meant.own_values import in_si, numbers_with_unit
from sceneql.language.tree import Mapping, Sequence

LENSES, FILM = ("focal_length", "lens", "focallength"), 24.0
"""Fields of other programs for a lens, and the height of its film [mm]."""
LEAST, MOST = 4.0, 2000.0
"""Shortest and longest lens that there is [mm]."""
CONE = (
    ("radius_top", "top_radius", "radiustop", "r2"),
    ("radius_bottom", "bottom_radius", "radiusbottom", "r1"),
)
"""Fields of other programs for a cone's radii at the top and at the bottom."""
THIN = 0.01
"""Factor of a taper to a point."""
TIPS, TAILS = ("to", "end", "head", "tip"), ("from", "start", "begin", "origin", "tail", "at")
"""Fields of other programs for the ends of an arrow."""
AWAY = ("distance", "radius", "dist")
"""Fields of other programs for how far a camera stays behind what it follows."""
PLACES = ("center", "centre", "position", "pos", "at", "location", "point")
"""Fields of other programs for the place of a ball."""
WAYS, SIZES = ("direction", "dir", "axis"), ("length", "magnitude", "size", "len")
"""Fields of other programs for an arrow's direction and length."""
WHIRLS = ("speed", "velocity", "rate", "strength", "angular_velocity", "omega")
"""Fields of other programs for how fast a vortex turns."""
FACETS = ("$fn", "sides", "segments", "radialsegments", "radial_segments", "vertices")
"""Fields of other programs for how many sides a cylinder has."""
HEIGHTS = ("z", "y", "height", "function", "formula", "f", "x")
_COORDINATE = re.compile(r"\b[xyz]\b")
"""Fields of other programs for a height by place."""
FED = ("feed", "kill", "f", "k", "feed_rate", "kill_rate", "du", "dv")
"""Fields of other programs for the equations of Gray and Scott."""
MODULI = {
    "mu": ("mu", "g", "shear", "shear_modulus", "shearmodulus"),
    "lambda": ("lambda", "lam", "lame", "first_lame", "lambda_"),
    "bulk": ("k", "bulk", "bulk_modulus", "bulkmodulus", "kappa"),
    "nu": ("nu", "poisson", "poisson_ratio", "v"),
}
"""Fields of other programs for elastic constants."""
HALF = 0.5
GRAY_SCOTT = (("feed", "f", "feed_rate"), "0.03"), (("kill", "k", "kill_rate"), "0.06")
PRESSURES = ((1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa"))
LASTING = ("duration", "time", "seconds", "period")
"""Fields of other programs for how long a motion takes."""
GRAVITATION = 6.6743e-11
"""[m^3/(kg s^2)] (CODATA 2018)."""
ABOVE = 0.2
"""How much higher than what it follows a camera stands, in parts of its distance."""


def worked_out(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for an unknown field whose value here follows from what is written."""
    told = _lens(name, node, known) or _cone(name, unknown, node, known) or _arrow(name, unknown, node, known)
    told = told or _balls(name, node, known) or _pointing(name, unknown, node, known) or _colors(name, node, known)
    if told is None and name in FACETS and {"radius", "height"} <= {*known}:
        told = prism(node.entries, name)
    if told is None and {"shows", "paint"} <= {*known} and name in HEIGHTS:
        told = _height(node)
    if told is None and {"of", "because"} <= {*known}:
        told = _measured(name, node)
    if told is None and name.lower() in FED and "species" in known and "species" not in node.entries:
        told = _fed(node)
    told = told or _moduli(name, unknown, node, known)
    told = told or _whirling(name, node, known)
    return told or _progress(name, node, known) or _followed(name, node, known) or _pulling(name, node, known)


def _lens(name: str, node: Mapping, known: Collection[str]) -> str | None:
    """The help for a focal length in place of an angle of view, in a camera whose picture is 24 mm high."""
    length = numbers_with_unit(node.entries[name].span.text)
    if name not in LENSES or "field_of_view" not in known or length is None or length[1] not in ("", "mm"):
        return None
    if not LEAST <= length[0][0] <= MOST:
        return None  # it is in meters
    angle = degrees(2.0 * atan(FILM / 2.0 / length[0][0]))
    return f"a lens of {length[0][0]:g} mm sees, upright, `field_of_view: {angle:.3g} deg`: write that"


def _cone(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for the two radii of a cone beside the fields of a cylinder."""
    top, bottom = (next((one for one in unknown if one.lower() in ends), None) for ends in CONE)
    if top is None or bottom is None or name not in (top, bottom) or "radius" in node.entries:
        return None
    upper, lower = (numbers_with_unit(node.entries[one].span.text) for one in (top, bottom))
    if upper is None or lower is None or upper[1] != lower[1] or lower[0][0] <= 0.0:
        return None
    rest = "".join(f", {one}: {value.span.text}" for one, value in node.entries.items() if one in known)
    inner = f"{{cylinder: {{radius: {node.entries[bottom].span.text}{rest}}}}}"
    factor = max(upper[0][0] / lower[0][0], THIN)
    return f"a cone is a cylinder that is tapered: write `{{taper: {{of: {inner}, factor: {factor:.3g}}}}}`"


def _arrow(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for the two ends of an arrow, which has one and a vector."""
    if not {"at", "vector"} <= {*known} or "vector" in node.entries or name not in (*TIPS, *TAILS):
        return None
    tip, tail = (next((one for one in ends if one in node.entries), None) for ends in (TIPS, TAILS))
    if tip is None or tail is None:
        return None
    first, last = node.entries[tail].span.text, node.entries[tip].span.text
    ends = [numbers_with_unit(text) for text in (first, last)]
    vector = f"{last} - {first}"
    if ends[0] is not None and ends[1] is not None and len(ends[0][0]) == len(ends[1][0]):
        if ends[0][1] != ends[1][1]:
            return None
        vector = " ".join(f"{b - a:.6g}" for a, b in zip(ends[0][0], ends[1][0], strict=True))
        vector = f"{vector} {ends[0][1]}".rstrip()
    elif not all(text.replace(".", "_").isidentifier() for text in (first, last)):
        return None
    return f"it goes from `at` by a vector: write `at: {first}, vector: {vector}`"


def _followed(name: str, node: Mapping, known: Collection[str]) -> str | None:
    """The help for how far a camera stays behind what it follows."""
    away = in_si(node.entries[name].span.text)
    if name not in AWAY or not {"follow", "from"} <= {*known} or "follow" not in node.entries or len(away) != 1:
        return None
    text = f"from: 0 {ABOVE * away[0]:.6g} {away[0]:.6g} m"
    return f"its place as seen from what it follows is `from`: write `{text}`"


def _balls(name: str, node: Mapping, known: Collection[str]) -> str | None:
    """The help for balls one by one, each with its place and radius, where lists have them."""
    value = node.entries[name]
    items = value.items if isinstance(value, Sequence) else []
    inner = [one.entries for one in items if isinstance(one, Mapping)]
    if not {"points", "radius"} <= {*known} or "points" in node.entries or not items or len(inner) < len(items):
        return None
    lists: dict[str, list[str]] = {}
    for one in inner:
        for key, each in one.items():
            lists.setdefault("points" if key in PLACES else key, []).append(each.span.text)
    if not {"points"} <= {*lists} <= {*known} or any(len(each) < len(items) for each in lists.values()):
        return None
    told = {key: ", ".join(each) for key, each in lists.items()}
    return f"write `{', '.join(f'{key}: [{each}]' for key, each in told.items())}`"


def _pointing(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for an arrow's direction and its length, which its vector has."""
    way, size = (next((one for one in unknown if one in names), None) for names in (WAYS, SIZES))
    if way is None or size is None or name not in (way, size) or "vector" not in known or "vector" in node.entries:
        return None
    numbers = in_si(node.entries[way].span.text)
    if not numbers:
        return None
    told = f"{node.entries[size].span.text}*normalize([{', '.join(f'{one:g}' for one in numbers)}])"
    return f"write `vector: {told}`"


def _colors(name: str, node: Mapping, known: Collection[str]) -> str | None:
    """The help for two colors in a list, which have a field each."""
    value = node.entries[name]
    items = [one.span.text for one in value.items] if isinstance(value, Sequence) else []
    if not {"color", "other"} <= {*known} or name not in ("colors", "colours") or len(items) != 2:
        return None
    return f"write `color: {items[0]}, other: {items[1]}`"


def _whirling(name: str, node: Mapping, known: Collection[str]) -> str | None:
    """The help for the speed of a vortex, 1 m off its axis."""
    speed = in_si(node.entries[name].span.text)
    if name not in WHIRLS or "circulation" not in known or len(speed) != 1:
        return None
    told = f"`circulation: {tau * speed[0]:.3g} m^2/s`"
    return f"it falls off from the axis: {speed[0]:g} m/s at a distance of 1 m is {told}: write that"


def _moduli(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for other pairs of elastic constants: of Lame, or the moduli of shear and of volume."""
    if not {"modulus", "poisson"} <= {*known} or name not in unknown:
        return None
    given = {
        ours: (in_si(node.entries[one].span.text) or [0.0])[0]
        for ours, names in MODULI.items()
        for one in node.entries
        if one in names or one.lower() in names
    }
    mu, first, bulk, nu = (given.get(one, 0.0) for one in ("mu", "lambda", "bulk", "nu"))
    if mu > 0 and (first > 0 or bulk > 0):
        first = first or bulk - 2.0 * mu / 3.0
        modulus, nu = mu * (3.0 * first + 2.0 * mu) / (first + mu), first / (2.0 * (first + mu))
    elif mu > 0 and 0 < nu < HALF:
        modulus = 2.0 * mu * (1.0 + nu)
    elif bulk > 0 and 0 < nu < HALF:
        modulus = 3.0 * bulk * (1.0 - 2.0 * nu)
    else:
        return None
    scale, unit = next((one for one in PRESSURES if modulus >= one[0]), (1.0, "Pa"))
    return f"write `modulus: {modulus / scale:.4g} {unit}, poisson: {nu:.4g}`"


def _height(node: Mapping) -> str | None:
    """The help for a height as a formula of two coordinates, whose ends may be told, as an implicit surface."""
    texts = {one: node.entries[one].span.text.strip("'\"") for one in HEIGHTS if one in node.entries}
    name, formula = next(((one, text) for one, text in texts.items() if _COORDINATE.search(text)), ("", ""))
    across = "y" if name == "z" or not re.search(r"\bz\b", formula) else "z"
    formula = re.sub(r"(?<![\w.])y\b", "z", formula) if across == "y" else formula
    ends = [in_si(node.entries[one].span.text) if one in node.entries else [] for one in ("x", across)]
    if "\n" in formula or not _COORDINATE.search(formula):
        return None
    (left, right), (back, front) = (one if len(one) == 2 else [-3.0, 3.0] for one in ends)
    box = f"[{left:g} -1 {back:g}, {right:g} 1 {front:g}]"
    told = f'{{implicit: {{field: "y - ({formula})", bounds: {{box: {box}}}}}}}'
    return f"a height above x and z is a formula: write `{told}`"


def _measured(name: str, node: Mapping) -> str | None:
    """The help for what is measured as a field's name, ``final(x): 1 m``, and for an instant beside it."""
    text = node.entries[name].span.text
    of = node.entries.get("of")
    if of is not None and name in ("at", "time", "when") and re.fullmatch(r"[\w.]+", of.span.text):
        told = f'of: "at({of.span.text}, {text})"'
        return f"the instant stands in what is measured: write `{told}`"
    if of is None and re.fullmatch(r"\w+\([\w., ]+\)|\w+(?:\.\w+)+", name) and "\n" not in text:
        name = f'"{name}"' if "," in name else name
        return f"write `of: {name}, value: {text}, because: exact`, or another reason"
    return None


def _fed(node: Mapping) -> str:
    """The help for the numbers of the equations of Gray and Scott, which are written out, with a spot in the middle."""
    given = {one.lower(): value.span.text for one, value in node.entries.items()}
    feed, kill = (next((given[one] for one in names if one in given), usual) for names, usual in GRAY_SCOTT)
    size = in_si(given.get("size", "")) or [1.0, 1.0]
    spot = " + ".join(f"({axis} - {side / 2:g})^2" for axis, side in zip("xyz", size, strict=False))
    first = f"u: {{coefficient: {given.get('du', '2e-5')}, initial: 1, rate: -u*v^2 + {feed}*(1 - u)}}"
    second = f"initial: 0.5*exp(-({spot})/{(0.1 * max(size)) ** 2:.3g}), rate: u*v^2 - ({feed} + {kill})*v"
    told = f"species: {{{first}, v: {{coefficient: {given.get('dv', '1e-5')}, {second}}}}}"
    return f"what is fed and dies stands in the rates: write `{told}`"


def _progress(name: str, node: Mapping, known: Collection[str]) -> str | None:
    """The help for how long a way takes."""
    text = node.entries[name].span.text
    if name not in LASTING or not {"along", "progress"} <= {*known} or len(in_si(text)) != 1:
        return None
    text = f"({text})" if " " in text else text
    return f"how far it has come is a part of the way: write `progress: time/{text}`"


def _pulling(name: str, node: Mapping, known: Collection[str]) -> str | None:
    """The help for a mass that pulls, of which the strength is told."""
    text = node.entries[name].span.text
    mass = in_si(text) if text.rstrip().endswith("g") else []  # kg, g
    if name.lower() not in ("mass", "m") or {"strength", "position"} - {*known} or len(mass) != 1:
        return None
    return f"its strength is G times the mass: write `strength: {GRAVITATION * mass[0]:.6g} m^3/s^2`"
