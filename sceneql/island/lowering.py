"""Operations on vectors and rotations, and derived ones on numbers, expressed by scalar operations.

``do(op, *operands)`` applies a scalar operation (component by component); an operand is a result of ``do``, a list of
such results, or a float.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial, reduce
from typing import Any

Do = Callable[..., Any]
AXES = {"x": [1.0, 0.0, 0.0], "y": [0.0, 1.0, 0.0], "z": [0.0, 0.0, 1.0]}


def total(do: Do, a: list[Any]) -> Any:
    """Sum of the components."""
    return reduce(partial(do, "add"), a)


def mean(do: Do, a: list[Any]) -> Any:
    """Arithmetic mean of the components."""
    return do("div", total(do, a), float(len(a)))


def dot(do: Do, a: list[Any], b: list[Any]) -> Any:
    """Scalar product."""
    return total(do, do("mul", a, b))


def length(do: Do, a: list[Any]) -> Any:
    """Euclidean norm."""
    return do("sqrt", dot(do, a, a))


def distance(do: Do, a: list[Any], b: list[Any]) -> Any:
    """Norm of the difference."""
    return length(do, do("sub", a, b))


def hypot(do: Do, a: Any, b: Any) -> Any:
    """sqrt(a^2 + b^2)."""
    return length(do, [a, b])


def normalize(do: Do, a: list[Any]) -> Any:
    """The unit vector."""
    return do("div", a, length(do, a))


def cross(do: Do, a: list[Any], b: list[Any]) -> Any:
    """Vector product."""
    return [do("sub", do("mul", a[i], b[j]), do("mul", a[j], b[i])) for i, j in ((1, 2), (2, 0), (0, 1))]


def step(do: Do, edge: Any, x: Any) -> Any:
    """0 below the edge, 1 from it on."""
    return do("ge", x, edge)


def clamp(do: Do, x: Any, low: Any, high: Any) -> Any:
    """x limited to [low, high]."""
    return do("min", do("max", x, low), high)


def mix(do: Do, a: Any, b: Any, s: Any) -> Any:
    """a + (b - a) s."""
    return do("add", a, do("mul", do("sub", b, a), s))


def smoothstep(do: Do, a: Any, b: Any, x: Any) -> Any:
    """0 below a, 1 above b, 3 s^2 - 2 s^3 between."""
    s = clamp(do, do("div", do("sub", x, a), do("sub", b, a)), 0.0, 1.0)
    return do("mul", do("mul", s, s), do("sub", 3.0, do("mul", 2.0, s)))


def ease(do: Do, x: Any) -> Any:
    """Smoothstep from 0 to 1."""
    return smoothstep(do, 0.0, 1.0, x)


def about(do: Do, axis: list[Any], angle: Any) -> Any:
    """The unit quaternion of a rotation by an angle [rad] about an axis."""
    half = do("div", angle, 2.0)
    return [do("cos", half), *do("mul", normalize(do, axis), do("sin", half))]


def turn(do: Do, a: list[Any], b: list[Any]) -> Any:
    """Hamilton's product a b of quaternions: the rotation b, then a."""
    scalar = do("sub", do("mul", a[0], b[0]), dot(do, a[1:], b[1:]))
    vector = do("add", do("mul", a[0], b[1:]), do("mul", b[0], a[1:]))
    return [scalar, *do("add", vector, cross(do, a[1:], b[1:]))]


def euler(order: str, do: Do, angles: list[Any]) -> Any:
    """The quaternion of intrinsic rotations by angles [rad] about the axes in this order."""
    first, second, third = (about(do, AXES[axis], angle) for axis, angle in zip(order, angles, strict=True))
    return turn(do, turn(do, first, second), third)


def noise(do: Do, p: Any) -> Any:
    """Gradient noise of a number, of a vector of 2 or 3, or of each of a list of these."""
    if not isinstance(p, list):
        return do("noise_line", p, 0.0)
    return [noise(do, each) for each in p] if isinstance(p[0], list) else do("noise_space", *[*p, 0.0][:3], 0.0)


LOWERINGS: Mapping[str, Callable[..., Any]] = {
    "sum": total,
    "norm": length,
    **{f.__name__: f for f in (mean, dot, length, distance, hypot, normalize, cross, about, turn)},
    **{f.__name__: f for f in (step, clamp, mix, smoothstep, ease, noise)},
    **{f"euler_{order}": partial(euler, order) for order in ("xyz", "xzy", "yxz", "yzx", "zxy", "zyx")},
}
"""The lowering of each operation, by its name in quantities.operations."""
