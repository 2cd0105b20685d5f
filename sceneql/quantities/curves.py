"""Keyframe curves: interpolation through keys, over floats, arrays or expressions alike."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from sceneql.quantities.composites import dot, ease, mix, normalize
from sceneql.quantities.expression import Expr, Keys

CURVES = ("step", "linear", "smooth", "cubic")
Components = tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """Keyframes as numbers, which compiled evaluators take too."""

    times: tuple[float, ...]
    """(k,) [s], increasing."""
    values: tuple[Components, ...]
    """(k, c) components."""
    slopes_in: tuple[Components, ...]
    """(k, c) slopes before each key, for cubic curves."""
    slopes_out: tuple[Components, ...]
    """(k, c) slopes after each key."""
    curve: int
    """Index into CURVES."""
    cycle: float
    """Period [s]; 0 for none."""
    rotation: bool
    """Whether the components are a quaternion, which is interpolated spherically."""


def table_of(o: Any, keys: Keys, number: Callable[[Expr], float], components: Callable[[Expr], Components]) -> Table:
    """The table of keyframes over an arithmetic ``o``: times by ``number``, values and slopes by ``components``.

    A slope that is not given is that of the chord between the neighbors (Catmull & Rom 1974, for uneven times), at
    an end that of the last chord; where the cycle joins the last key to the first, both have the same neighbors.
    """
    times = tuple(number(key.time) for key in keys.keys)
    values = tuple(components(key.value) for key in keys.keys)
    if keys.type.shape == (4,):
        values = _shortest(o, values)
    cycle = 0.0 if keys.cycle is None else number(keys.cycle)
    rotation = keys.type.shape == (4,)
    slopes = _chords(o, times, values, closed=cycle > 0.0 and math.isclose(times[-1] - times[0], cycle))
    slopes_in = tuple(
        s if k.slope_in is None else components(k.slope_in) for k, s in zip(keys.keys, slopes, strict=True)
    )
    slopes_out = tuple(
        s if k.slope_out is None else components(k.slope_out) for k, s in zip(keys.keys, slopes, strict=True)
    )
    return Table(times, values, slopes_in, slopes_out, CURVES.index(keys.curve), cycle, rotation)


def _shortest(o: Any, values: tuple[Components, ...]) -> tuple[Components, ...]:
    """Unit quaternions, each with the sign nearest to the one before: q and -q are the same rotation."""
    result = [normalize(o, values[0])]
    for value in values[1:]:
        unit = normalize(o, value)
        side = o.where(o.lt(dot(o, result[-1], unit), 0.0), -1.0, 1.0)
        result.append(tuple(o.mul(side, c) for c in unit))
    return tuple(result)


def _chords(o: Any, times: tuple[float, ...], values: tuple[Components, ...], closed: bool) -> list[Components]:
    last = len(times) - 1

    def chord(*pairs: tuple[int, int]) -> Components:
        span = sum(times[b] - times[a] for a, b in pairs)
        rises = [[o.sub(q, p) for p, q in zip(values[a], values[b], strict=True)] for a, b in pairs]
        whole = rises[0] if len(rises) == 1 else [o.add(p, q) for p, q in zip(*rises, strict=True)]
        return tuple(o.div(rise, span) for rise in whole)

    if last == 0:
        return [tuple(0.0 for _ in values[0])]
    inner = [chord((k - 1, k + 1)) for k in range(1, last)]
    if closed:
        joint = chord((last - 1, last), (0, 1))
        return [joint, *inner, joint]
    return [chord((0, 1)), *inner, chord((last - 1, last))]


def interpolate(
    o: Any, table: Table, t: Any, find: Callable[[Any, tuple[float, ...]], int] | None = None
) -> Components:
    """The components of the curve at ``t``, over an arithmetic ``o``.

    ``find(t, times)`` returns the index of the last key not after t, where it can be computed; else all pieces are
    selected by `where`.
    """
    times, last = table.times, len(table.times) - 1
    if table.cycle > 0.0:
        t = o.add(times[0], o.mod(o.sub(t, times[0]), table.cycle))
    t = o.max(t, times[0])
    if find is not None:
        return _piece(o, table, min(max(find(t, times), 0), last), t)
    result = _piece(o, table, 0, t)
    for k in range(1, last + 1):
        after = o.ge(t, times[k])
        result = tuple(o.where(after, new, old) for new, old in zip(_piece(o, table, k, t), result, strict=True))
    return result


def _piece(o: Any, table: Table, k: int, t: Any) -> Components:
    """The components between key k and the next one."""
    curve, a = CURVES[table.curve], table.values[k]
    if curve == "step" or k == len(table.times) - 1:
        return a
    b = table.values[k + 1]
    span = table.times[k + 1] - table.times[k]
    s = o.div(o.sub(t, table.times[k]), span)
    if table.rotation:
        return slerp(o, a, b, s if curve == "linear" else ease(o, s))
    if curve == "cubic":
        rises = zip(table.slopes_out[k], table.slopes_in[k + 1], strict=True)
        return tuple(hermite(o, s, span, p, q, m, n) for p, q, (m, n) in zip(a, b, rises, strict=True))
    return tuple(mix(o, p, q, s if curve == "linear" else ease(o, s)) for p, q in zip(a, b, strict=True))


def hermite(o: Any, s: Any, span: float, a: Any, b: Any, slope_a: Any, slope_b: Any) -> Any:
    """Cubic Hermite interpolation: values and slopes at both ends of a span, at s from 0 to 1."""
    r = o.sub(1.0, s)
    from_a = o.mul(o.mul(o.mul(a, r), r), o.add(1.0, o.mul(2.0, s)))
    from_b = o.mul(o.mul(o.mul(b, s), s), o.sub(3.0, o.mul(2.0, s)))
    swing = o.mul(o.mul(o.mul(span, s), r), o.sub(o.mul(slope_a, r), o.mul(slope_b, s)))
    return o.add(o.add(from_a, from_b), swing)


def slerp(o: Any, a: Components, b: Components, s: Any) -> Components:
    """Interpolate unit quaternions at most pi/2 apart with constant angular speed, s from 0 to 1 (Shoemake 1985)."""
    angle = o.acos(o.min(1.0, dot(o, a, b)))
    still = o.lt(angle, 1e-8)
    u = o.div(o.sin(o.mul(o.sub(1.0, s), angle)), o.sin(angle))
    v = o.div(o.sin(o.mul(s, angle)), o.sin(angle))
    return tuple(o.where(still, mix(o, p, q, s), o.add(o.mul(u, p), o.mul(v, q))) for p, q in zip(a, b, strict=True))
