"""Keyframes: the value of a curve through keys at a time, in plain Python and in numpy."""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from typing import Any

from sceneql.quantities.expression import Keys

CURVES = ("step", "linear", "smooth", "cubic")


@dataclass(frozen=True, slots=True)
class Table:
    """Keys as numbers: what a compiled evaluator needs too."""

    times: tuple[float, ...]
    """(k,) [s], increasing."""
    values: tuple[tuple[float, ...], ...]
    """(k, c) components."""
    slopes_in: tuple[tuple[float, ...], ...]
    """(k, c) slope that a cubic arrives with at each key."""
    slopes_out: tuple[tuple[float, ...], ...]
    """(k, c) slope that it leaves with."""
    curve: int
    """Index into CURVES."""
    cycle: float
    """Period [s]; 0 for none."""
    rotation: bool
    """Components are a quaternion: spherical interpolation."""


def keys_table(keys: Keys) -> Table:
    """The numbers of keyframes whose times and values are constant. Raises KeyError where one is not."""
    from sceneql.quantities.evaluate import evaluate

    def vector(expr: Any) -> tuple[float, ...]:
        value = evaluate(expr, {})
        return value if isinstance(value, tuple) else (value,)

    times = tuple(float(evaluate(key.time, {})) for key in keys.keys)
    values = tuple(vector(key.value) for key in keys.keys)
    rotation = keys.type.shape == (4,)
    if rotation:
        values = _shortest(values)
    last = len(times) - 1

    def slope(k: int, expr: Any) -> tuple[float, ...]:
        if expr is not None:
            return vector(expr)
        a, b = max(k - 1, 0), min(k + 1, last)
        span = times[b] - times[a]
        return tuple((q - p) / span if span > 0 else 0.0 for p, q in zip(values[a], values[b], strict=True))

    slopes_in = tuple(slope(k, key.slope_in) for k, key in enumerate(keys.keys))
    slopes_out = tuple(slope(k, key.slope_out) for k, key in enumerate(keys.keys))
    cycle = 0.0 if keys.cycle is None else float(evaluate(keys.cycle, {}))
    return Table(times, values, slopes_in, slopes_out, CURVES.index(keys.curve), cycle, rotation)


def _shortest(values: tuple[tuple[float, ...], ...]) -> tuple[tuple[float, ...], ...]:
    """Unit quaternions, each on the side of the sphere nearest to the one before (q and -q turn alike)."""
    result: list[tuple[float, ...]] = []
    for value in values:
        size = math.hypot(*value) or 1.0
        unit = tuple(c / size for c in value)
        if result and sum(a * b for a, b in zip(result[-1], unit, strict=True)) < 0:
            unit = tuple(-c for c in unit)
        result.append(unit)
    return tuple(result)


def evaluate_keys(keys: Keys, at: Any, np: Any = None) -> Any:
    """The curve's value at ``at`` (with ``np`` an array of instants may be given; the components come last)."""
    table = keys_table(keys)
    scalar = not keys.type.shape
    if np is not None:
        rows = [value_at(table, float(t)) for t in np.ravel(at)]
        shape = np.shape(at) if scalar else (*np.shape(at), len(table.values[0]))
        return np.array(rows).reshape(shape)
    value = value_at(table, at)
    return value[0] if scalar else value


def value_at(table: Table, t: float) -> tuple[float, ...]:
    """The components (c,) at a time; held before the first and after the last key."""
    times = table.times
    if math.isnan(t):
        return tuple(math.nan for _ in table.values[0])
    if table.cycle > 0:
        t = times[0] + (t - times[0]) % table.cycle
    if t <= times[0]:
        # At the very key of a curve with a jump in slope the value is the same from both sides.
        return table.values[0]
    if t >= times[-1]:
        return table.values[-1]
    k = bisect_right(times, t) - 1
    a, b = table.values[k], table.values[k + 1]
    span = times[k + 1] - times[k]
    s = (t - times[k]) / span
    curve = CURVES[table.curve]
    if curve == "step":
        return a
    if table.rotation:
        return _slerp(a, b, s if curve == "linear" else s * s * (3 - 2 * s))
    if curve == "linear":
        return tuple(p + (q - p) * s for p, q in zip(a, b, strict=True))
    if curve == "smooth":
        s = s * s * (3 - 2 * s)
        return tuple(p + (q - p) * s for p, q in zip(a, b, strict=True))
    return tuple(
        _hermite(s, span, p, q, u, v)
        for p, q, u, v in zip(a, b, table.slopes_out[k], table.slopes_in[k + 1], strict=True)
    )


def _hermite(s: float, span: float, a: float, b: float, slope_a: float, slope_b: float) -> float:
    """The cubic with these values and slopes at the ends of a span."""
    r = 1 - s
    return a * r * r * (1 + 2 * s) + b * s * s * (3 - 2 * s) + span * s * r * (slope_a * r - slope_b * s)


def _slerp(a: tuple[float, ...], b: tuple[float, ...], s: float) -> tuple[float, ...]:
    """Constant angular speed between unit quaternions (Shoemake 1985)."""
    cosine = min(1.0, sum(p * q for p, q in zip(a, b, strict=True)))
    angle = math.acos(max(-1.0, cosine))
    if angle < 1e-8:
        return tuple(p + (q - p) * s for p, q in zip(a, b, strict=True))
    u, v = math.sin((1 - s) * angle) / math.sin(angle), math.sin(s * angle) / math.sin(angle)
    return tuple(u * p + v * q for p, q in zip(a, b, strict=True))
