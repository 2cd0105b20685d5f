"""Warnings of keyed rotations that turn the other way than their angles say, or not at all: from 0 to 360 degrees."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise
from math import degrees, hypot, isclose, remainder
from typing import Any

from sceneql.compiler.meaning.facts import Facts
from sceneql.compiler.meaning.still_keys import all_keys
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Keys, Number

HALF, WHOLE = 180.0, 360.0
"""Degrees."""
ACROSS = 60.0
"""Degrees of a short way across half a turn, from -170 to 170, up to which it is meant."""
_FIELD = re.compile(r"(\w+):\s*$")
AXES: dict[tuple[float, ...], str] = {(1.0, 0.0, 0.0): "x", (0.0, 1.0, 0.0): "y", (0.0, 0.0, 1.0): "z"}
Turn = tuple[tuple[float, ...] | None, float, str]
"""An axis of any length, None of no turn; the angle about it [deg]; and the text of the angle."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of the first two neighbours of each such group of keys."""
    for keys in all_keys(facts):
        turns = [_turn(key.value) for key in keys.keys] if keys.curve != "step" else []
        known = [turn for turn in turns if turn is not None]
        axes = {turn[0] for turn in known} - {None}
        if len(known) < len(keys.keys) or len(axes) != 1:
            continue
        for (first, last), key in zip(pairwise(known), keys.keys[1:], strict=True):
            if abs(last[1] - first[1]) <= HALF + 1e-9 or _meant(first[1], last[1]):
                continue
            short = remainder(last[1] - first[1], WHOLE)
            way = f"turns by {short:.4g} deg" if abs(short) > 1e-9 else "does not turn"
            text = f"keys of a rotation go the short way: from {first[2]} to {last[2]} it {way}"
            help = f"write keys for the angle, `{_by_angle(keys, known, next(iter(axes)))}`"
            found.warning("short-way", text, key.value.span, help=help)
            break


def _meant(first: float, last: float) -> bool:
    """Whether two angles [deg] more than half a turn apart are most likely told for the short way between them."""
    short = remainder(last - first, WHOLE)
    if isclose(short, 0.0, abs_tol=1e-9):
        return False
    on = 0.0 <= last < first <= WHOLE  # from 270 to 0, which goes on to 360
    return on or (max(abs(first), abs(last)) <= HALF and abs(short) <= ACROSS)


def _turn(value: Expr) -> Turn | None:
    """A constant turn about one axis; None of others."""
    if not isinstance(value, Call):
        return None
    try:
        if value.op == "about":
            axis, angle = (_numbers(one) for one in value.args)
            size = hypot(*axis)
            return tuple(one / size for one in axis), degrees(angle), _angle(value.args[1], degrees(angle))
        if value.op.startswith("euler_"):
            angles = dict(zip(value.op[-3:], _numbers(value.args[0]), strict=True))
            around = [one for one, angle in angles.items() if angle]
            if len(around) > 1:
                return None
            number = degrees(angles[around[0]]) if around else 0.0
            axis = tuple(float(one in around) for one in "xyz") if around else None
            return axis, number, f"{number:.6g} deg"
    except (KeyError, TypeError, ValueError, ZeroDivisionError):
        return None
    return None


def _numbers(expr: Expr) -> Any:
    """The number or numbers of an expression that varies with nothing. Raises KeyError for others."""
    return evaluate(expr, {})


def _angle(expr: Expr, number: float) -> str:
    """An angle as the script has it, or in degrees where it is worked out."""
    text = expr.span.text.strip() if isinstance(expr, Number) and expr.span is not None else ""
    return text if re.fullmatch(r"[-+.\w]+ \w+", text) else f"{number:.6g} deg"


def _by_angle(keys: Keys, turns: list[Turn], axis: tuple[float, ...] | None) -> str:
    """The same keys for the angle alone, with their field, in one line."""
    assert keys.span is not None
    assert axis is not None
    source, text = keys.span.source, keys.span.text
    inside = all(one is not None and one.source is source and keys.span.start < one.start for one in _spans(keys))
    if text.startswith("{") and inside:
        for span, turn in reversed([*zip(_spans(keys), turns, strict=True)]):
            text = text[: span.start - keys.span.start] + turn[2] + text[span.end - keys.span.start :]
        text = " ".join(text.split())
    else:
        times = [f"{key.time.span.text if key.time.span else evaluate(key.time, {})}" for key in keys.keys]
        each = ", ".join(f"{time}: {turn[2]}" for time, turn in zip(times, turns, strict=True))
        curve = "" if keys.curve == "smooth" else f", curve: {keys.curve}"
        cycle = getattr(keys.cycle, "span", None)
        text = f"{{keys: {{{each}}}{curve}{'' if cycle is None else f', cycle: {cycle.text}'}}}"
    field = _FIELD.search(source.text[: keys.span.start])
    name = AXES.get(axis) or " ".join(f"{one:.6g}" for one in axis)
    return f"{'rotation' if field is None else field[1]}: {{about: {name}, angle: {text}}}"


def _spans(keys: Keys) -> Iterator[Any]:
    return (key.value.span for key in keys.keys)
