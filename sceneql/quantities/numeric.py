"""What the operations do to numbers: floats as IEEE 754 has them (no exception ever escapes), tuples, arrays."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from functools import reduce
from typing import Any

Tuple = tuple[float, ...]
MASK = (1 << 64) - 1


def guarded(function: Callable[[float], float]) -> Callable[[float], float]:
    """NaN in place of a domain or overflow error."""

    def call(x: float) -> float:
        try:
            return function(x)
        except (ValueError, OverflowError):
            return math.nan

    return call


def floor(x: float) -> float:
    """Largest whole number not above x, as a float."""
    return x if math.isinf(x) else float(math.floor(x))


def ceil(x: float) -> float:
    """Smallest whole number not below x, as a float."""
    return x if math.isinf(x) else float(math.ceil(x))


def rounded(x: float) -> float:
    """Nearest whole number, halves to even."""
    return x if math.isinf(x) else float(round(x))


def divide(a: float, b: float) -> float:
    """a/b, with inf and NaN at b = 0."""
    if b != 0:
        return a / b
    if a == 0 or math.isnan(a):
        return math.nan
    return math.copysign(math.inf, a) * math.copysign(1.0, b)


def modulo(a: float, b: float) -> float:
    """a - b*floor(a/b), of the sign of b."""
    return math.nan if b == 0 or math.isinf(a) or math.isnan(a) else a % b


def power(a: float, b: float) -> float:
    """a^b; NaN for a fractional power of a negative number."""
    try:
        result = a**b
    except OverflowError:
        odd = a < 0 and b % 2 == 1
        return -math.inf if odd else math.inf
    except ZeroDivisionError:
        return math.copysign(math.inf, a) if b % 2 == 1 else math.inf
    return math.nan if isinstance(result, complex) else result


def exp(x: float) -> float:
    """e^x, inf where it overflows."""
    try:
        return math.exp(x)
    except OverflowError:
        return math.inf


def sinh(x: float) -> float:
    """Hyperbolic sine, infinite where it overflows."""
    try:
        return math.sinh(x)
    except OverflowError:
        return math.copysign(math.inf, x)


def cosh(x: float) -> float:
    """Hyperbolic cosine, infinite where it overflows."""
    try:
        return math.cosh(x)
    except OverflowError:
        return math.inf


def log(x: float) -> float:
    """Natural logarithm; -inf at 0, NaN below."""
    return math.log(x) if x > 0 else -math.inf if x == 0 else math.nan


def log10(x: float) -> float:
    """Decimal logarithm; -inf at 0, NaN below."""
    return math.log10(x) if x > 0 else -math.inf if x == 0 else math.nan


def sign(x: float) -> float:
    """-1, 0 or 1."""
    return math.nan if math.isnan(x) else float((x > 0) - (x < 0))


def clamp(x: float, low: float, high: float) -> float:
    """X kept within low and high."""
    return min(max(x, low), high)


def smoothstep(a: float, b: float, x: float) -> float:
    """0 below a, 1 above b, 3s^2 - 2s^3 between."""
    s = clamp(divide(x - a, b - a), 0.0, 1.0)
    return s * s * (3 - 2 * s)


def smoothstep_arrays(np: Any, a: Any, b: Any, x: Any) -> Any:
    """Smoothstep of arrays."""
    s = np.clip((x - a) / np.subtract(b, a), 0.0, 1.0)
    return s * s * (3 - 2 * s)


def ease(x: float) -> float:
    """Smoothstep from 0 to 1."""
    return smoothstep(0.0, 1.0, x)


def as_float(name: str) -> Callable[..., Any]:
    """A comparison of arrays that gives 0 and 1."""
    return lambda np, a, b: 1.0 * getattr(np, name)(a, b)


def fold(function: Callable[[Any, Any], Any], items: Iterable[Any]) -> Any:
    """A function of two arguments over many."""
    return reduce(function, items)


# --- chance: the same in Python and in numpy -------------------------------------------------------------------------


def _mixed(key: int) -> int:
    """The finalizer of SplitMix64 (Steele, Lea and Flood 2014)."""
    key = (key + 0x9E3779B97F4A7C15) & MASK
    key = ((key ^ (key >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    key = ((key ^ (key >> 27)) * 0x94D049BB133111EB) & MASK
    return key ^ (key >> 31)


def random(i: float, j: float = 0.0) -> float:
    """A number in [0, 1) for the whole parts of i and j; the same for the same pair, everywhere."""
    if not (math.isfinite(i) and math.isfinite(j)):
        return math.nan
    key = _mixed(_mixed(int(math.floor(i)) & MASK) ^ (int(math.floor(j)) & MASK))
    return (key >> 11) * 2.0**-53


def random_arrays(np: Any, i: Any, j: Any = 0.0) -> Any:
    """Random of arrays."""
    return np.vectorize(random, otypes=[float])(i, j)


# --- nested tuples ---------------------------------------------------------------------------------------------------


def flat(value: Any) -> Iterator[float]:
    """The floats of nested tuples in order."""
    if isinstance(value, tuple):
        for item in value:
            yield from flat(item)
    else:
        yield value


def mean(values: Iterable[float]) -> float:
    """Arithmetic mean; NaN of nothing."""
    items = list(values)
    return math.fsum(items) / len(items) if items else math.nan


def component(a: Any, k: float) -> Any:
    """Component k of a vector or of every vector of a list."""
    return tuple(component(item, k) for item in a) if a and isinstance(a[0], tuple) else a[int(k)]


def _spread(function: Callable[..., Any]) -> Callable[..., Any]:
    """Of vectors, or for each of lists of them."""

    def call(*args: Any) -> Any:
        lists = [isinstance(a, tuple) and bool(a) and isinstance(a[0], tuple) for a in args]
        if not any(lists):
            return function(*args)
        count = len(args[lists.index(True)])
        rows = [args[k] if lists[k] else (args[k],) * count for k in range(len(args))]
        return tuple(function(*row) for row in zip(*rows, strict=True))

    return call


@_spread
def dot(a: Tuple, b: Tuple) -> float:
    """Scalar product."""
    return sum(x * y for x, y in zip(a, b, strict=True))


@_spread
def cross(a: Tuple, b: Tuple) -> Tuple:
    """Vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@_spread
def length(a: Tuple) -> float:
    """Euclidean norm."""
    return math.hypot(*a)


@_spread
def minus(a: Tuple, b: Tuple) -> Tuple:
    """Difference of vectors."""
    return tuple(x - y for x, y in zip(a, b, strict=True))


@_spread
def normalize(a: Tuple) -> Tuple:
    """The unit vector along a; NaN for a zero vector."""
    size = math.hypot(*a)
    return tuple(divide(x, size) for x in a)


def normalize_arrays(np: Any, a: Any) -> Any:
    """Unit vectors."""
    return np.asarray(a) / np.linalg.norm(a, axis=-1, keepdims=True)


# --- quaternions [w, x, y, z] ----------------------------------------------------------------------------------------


def about(axis: Tuple, angle: float) -> Tuple:
    """The turn by an angle [rad] about an axis, right-handed."""
    size = math.hypot(*axis)
    if size == 0 or not math.isfinite(angle):
        return (math.nan,) * 4
    s = math.sin(angle / 2) / size
    return math.cos(angle / 2), axis[0] * s, axis[1] * s, axis[2] * s


def quaternion_product(a: Tuple, b: Tuple) -> Tuple:
    """The turn b, then the turn a (Hamilton's product)."""
    (w, x, y, z), (p, q, r, s) = a, b
    return (
        w * p - x * q - y * r - z * s,
        w * q + x * p + y * s - z * r,
        w * r - x * s + y * p + z * q,
        w * s + x * r - y * q + z * p,
    )


def euler(order: str) -> Callable[[Tuple], Tuple]:
    """Intrinsic turns about the axes in this order, by the angles (3,) [rad] in this order."""
    axes = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}

    def turn(angles: Tuple) -> Tuple:
        first, second, third = (about(axes[axis], angle) for axis, angle in zip(order, angles, strict=True))
        return quaternion_product(quaternion_product(first, second), third)

    return turn


def hue(h: float) -> Tuple:
    """A saturated sRGB color (3,) for a place on the color circle: 0 red, 1/3 green, 2/3 blue, periodic, smooth."""
    return tuple(0.5 + 0.45 * math.cos(math.tau * (h - k / 3)) if math.isfinite(h) else math.nan for k in range(3))


def by_tuple(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function of tuples used on arrays."""

    def call(np: Any, *args: Any) -> Any:
        return np.array(function(*(tuple(a) if np.ndim(a) else float(a) for a in map(np.asarray, args))))

    return call


def no_series(*args: Any) -> Any:
    """An operation on a quantity over time where there is none."""
    raise TypeError("this operation needs a quantity over time; it belongs in 'expect'")
