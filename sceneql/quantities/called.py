"""Calls of functions of other languages, with their own arguments in what is written here: for messages alone."""

from __future__ import annotations

import re
from collections.abc import Sequence
from colorsys import hsv_to_rgb

_SIMPLE = re.compile(r"[\w.]+|\w+\([^()]*\)|\([^()]*\)")
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_BLANK = re.compile(r"\{(\d)(!|-\d|\*\w+)?\}")
_ZERO = re.compile(r"0(?:\.0*)?\s*[^\W\d]*")
_SUM = re.compile(r"[-+<>=]")
HSV, TURN = ("hsv", "hsb", "hsv2rgb", "hsv_to_rgb"), 360.0
_CALLS = (
    ("if iif ifelse if_else select cond ternary", 3, "where({0}, {1}, {2})"),
    ("pow power", 2, "{0!}^{1!}"),
    ("sqr square", 1, "{0!}^2"),
    ("cbrt", 1, "{0!}^(1/3)"),
    ("frac fract", 1, "mod({0}, 1)"),
    ("fmod rem remainder modulo", 2, "mod({0}, {1})"),
    ("log2", 1, "log({0})/log(2)"),
    ("log", 2, "log({0})/log({1})"),
    ("atan arctan", 2, "atan2({0}, {1})"),
    ("saturate clamp01", 1, "clamp({0}, 0, 1)"),
    ("saturate constrain", 3, "clamp({0}, {1}, {2})"),
    ("lerp interpolate linear_interpolate", 3, "mix({0}, {1}, {2})"),
    ("map remap map_range maprange linmap rescale fit", 5, "mix({3}, {4}, clamp({0-1}/{2-1}, 0, 1))"),
    ("deg2rad degtorad radians deg_to_rad", 1, "{0*deg}"),
    ("rad2deg radtodeg degrees rad_to_deg", 1, "{0*rad}"),
    ("sind", 1, "sin({0*deg})"),
    ("cosd", 1, "cos({0*deg})"),
    ("tand", 1, "tan({0*deg})"),
    ("uniform rand_range random_range randf_range randint randrange random.range", 2, "mix({0}, {1}, random(1))"),
    ("dist", 2, "distance({0}, {1})"),
    ("mag magnitude", 1, "length({0})"),
)
"""(names in small letters, how many arguments, what is written in place). `{0!}`: in brackets unless it is simple;
`{0*deg}`: as a quantity of that unit; `{0-1}`: the difference of two of them, in brackets unless it is simple."""
_TEXTS = {(name, count): text for names, count, text in _CALLS for name in names.split()}


def rewritten(name: str, args: Sequence[str]) -> str | None:
    """The call of a function of another language as it is written here; None where that is not known."""
    name = name.lower()
    if name in HSV and len(args) == 3 and all(map(_NUMBER.fullmatch, args)):
        return _color(*map(float, args))
    text = _TEXTS.get((name, len(args))) or _TEXTS.get((name.rpartition(".")[2], len(args)))
    if text is None or not all(args):
        return None

    def fill(blank: re.Match[str]) -> str:
        own, how = args[int(blank[1])].strip(), blank[2] or ""
        closed = own if _SIMPLE.fullmatch(own) or not how else f"({own})"
        if how.startswith("-"):
            less = args[int(how[1:])].strip()
            if _ZERO.fullmatch(less):
                return own if _SIMPLE.fullmatch(own) else f"({own})"
            return f"({own} - ({less}))" if _SUM.search(less) else f"({own} - {less})"
        if how.startswith("*"):
            return f"{own} {how[1:]}" if _NUMBER.fullmatch(own) else f"{closed}*(1 {how[1:]})"
        return closed

    return _BLANK.sub(fill, text)


def _color(hue: float, saturation: float, value: float) -> str:
    """The three numbers of a color by its hue, in turns or degrees, its saturation and value, in parts or percent."""
    hue = hue / TURN if hue > 1 else hue
    saturation, value = (one / 100 if one > 1 else one for one in (saturation, value))
    return f"[{', '.join(f'{one:.3g}' for one in hsv_to_rgb(hue, saturation, value))}]"
