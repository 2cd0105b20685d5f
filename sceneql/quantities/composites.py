"""Composite operations, written once over any arithmetic ``o``: floats, arrays or expressions.

``o.add(a, b)``, ``o.sin(a)``, ... are the primitive operations of the table; vectors are tuples of components and
quaternions are (w, x, y, z).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

Components = tuple[Any, ...]


def clamp(o: Any, x: Any, low: Any, high: Any) -> Any:
    """x, but not below ``low`` nor above ``high``."""
    return o.min(o.max(x, low), high)


def mix(o: Any, a: Any, b: Any, t: Any) -> Any:
    """a + (b - a) t."""
    return o.add(a, o.mul(o.sub(b, a), t))


def step(o: Any, edge: Any, x: Any) -> Any:
    """0 below the edge, 1 from it on."""
    return o.ge(x, edge)


def ease(o: Any, t: Any) -> Any:
    """3 t^2 - 2 t^3 between 0 and 1, held outside: starts and ends at rest."""
    u = clamp(o, t, 0.0, 1.0)
    return o.mul(o.mul(u, u), o.sub(3.0, o.mul(2.0, u)))


def smoothstep(o: Any, low: Any, high: Any, x: Any) -> Any:
    """``ease`` from 0 at ``low`` to 1 at ``high``."""
    return ease(o, o.div(o.sub(x, low), o.sub(high, low)))


def noise(o: Any, p: Any) -> Any:
    """Gradient noise (quantities.noise) of a number or a vector of 2 or 3; in a plane it is that of space at z = 0."""
    if not isinstance(p, tuple):
        return o.noise_line(p, 0.0)
    x, y, z = (*p, 0.0)[:3]
    return o.noise_space(x, y, z, 0.0)


def dot(o: Any, a: Components, b: Components) -> Any:
    """Sum of the products of the components."""
    return total(o, [o.mul(p, q) for p, q in zip(a, b, strict=True)])


def total(o: Any, items: Any) -> Any:
    """The sum of the items, from the first to the last; 0 of none."""
    if not items:
        return 0.0
    result = items[0]
    for item in items[1:]:
        result = o.add(result, item)
    return result


def cross(o: Any, a: Components, b: Components) -> Components:
    """The right-handed vector product."""
    return tuple(o.sub(o.mul(a[i], b[j]), o.mul(a[j], b[i])) for i, j in ((1, 2), (2, 0), (0, 1)))


def length(o: Any, a: Components) -> Any:
    """Euclidean length."""
    return o.sqrt(dot(o, a, a))


def normalize(o: Any, a: Components) -> Components:
    """a / |a|; NaN for the null vector."""
    size = length(o, a)
    return tuple(o.div(p, size) for p in a)


def distance(o: Any, a: Components, b: Components) -> Any:
    """|a - b|."""
    return length(o, tuple(o.sub(p, q) for p, q in zip(a, b, strict=True)))


def about(o: Any, axis: Components, angle: Any) -> Components:
    """The quaternion that turns by an angle about an axis of any length."""
    half = o.mul(0.5, angle)
    sine = o.sin(half)
    return (o.cos(half), *(o.mul(sine, p) for p in normalize(o, axis)))


def turn(o: Any, p: Components, q: Components) -> Components:
    """Hamilton's product: the rotation q, then p."""
    w = o.sub(o.mul(p[0], q[0]), dot(o, p[1:], q[1:]))
    turned = cross(o, p[1:], q[1:])
    xyz = (o.add(o.add(o.mul(p[0], b), o.mul(q[0], a)), c) for a, b, c in zip(p[1:], q[1:], turned, strict=True))
    return (w, *xyz)


def euler(order: str) -> Callable[..., Components]:
    """The function that gives the quaternion of three intrinsic Euler angles (3,) about the axes of ``order``."""

    def quaternion(o: Any, angles: Components) -> Components:
        turns = [about_axis(o, axis, angle) for axis, angle in zip(order, angles, strict=True)]
        return turn(o, turn(o, turns[0], turns[1]), turns[2])

    return quaternion


def about_axis(o: Any, axis: str, angle: Any) -> Components:
    """The quaternion of a turn about x, y or z."""
    half = o.mul(0.5, angle)
    sine = o.sin(half)
    return (o.cos(half), *(sine if axis == name else 0.0 for name in "xyz"))


def hue(o: Any, h: Any) -> Components:
    """sRGB color of a hue in turns: 0 red, 1/3 green, 2/3 blue, 1 red again; saturated, its slope continuous."""
    colors = []
    for shift in (0.0, 4.0, 2.0):
        around = o.mod(o.add(o.mul(6.0, h), shift), 6.0)
        colors.append(ease(o, o.sub(o.abs(o.sub(around, 3.0)), 1.0)))
    return tuple(colors)


def mean(o: Any, items: Any) -> Any:
    """Sum by count; NaN of none."""
    return o.div(total(o, items), float(len(items)))


def count(o: Any, items: Any) -> Any:
    """The number of items."""
    return float(len(items))


def norm(o: Any, items: Any) -> Any:
    """Root of the sum of squares."""
    return o.sqrt(total(o, [o.mul(item, item) for item in items]))


def extreme(name: str) -> Callable[[Any, Any], Any]:
    """The smallest (``min``) or largest (``max``) item; NaN of none."""

    def pick(o: Any, items: Any) -> Any:
        return getattr(o, name)(*items) if items else math.nan

    return pick
