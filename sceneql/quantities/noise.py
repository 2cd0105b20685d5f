"""Gradient noise (Perlin 2002, Improving noise): smooth, zero at whole numbers, with its derivatives of every order.

Each lattice point (whole coordinates) has a linear function with a random gradient. Between lattice points these are
blended by the weight 6 f^5 - 15 f^4 + 10 f^3, whose first and second derivatives vanish at both ends. The arithmetic
``m`` provides ``floor``, ``where``, and ``word`` (a whole number modulo 2^32).
"""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

from sceneql.quantities.chance import philox, unit

FADE = (0.0, 0.0, 0.0, 10.0, -15.0, 6.0, 0.0)
"""Coefficients of the fade by powers of f."""
BY_X, BY_Y, BY_Z = 1.0, 8.0, 64.0
"""The order of a mixed derivative is the sum of these, one for each derivative along the axis; at most 7 along each."""
MOST_ORDER = 512


def _word(whole: float) -> int:
    return int(whole % 2**32)


FLOATS = SimpleNamespace(floor=math.floor, where=lambda condition, a, b: a if condition else b, word=_word)


def noise_line(x: float, order: float) -> float:
    """Noise of one number within -1..1, or its derivative of an order (see `line`); NaN where x is not finite."""
    return float(line(FLOATS, x, int(order))) if math.isfinite(x) and 0.0 <= order < MOST_ORDER else math.nan


def noise_space(x: float, y: float, z: float, order: float) -> float:
    """Noise of three numbers, or its derivative of an order (see `space`); NaN where one of them is not finite."""
    finite = math.isfinite(x) and math.isfinite(y) and math.isfinite(z)
    return float(space(FLOATS, x, y, z, int(order))) if finite and 0.0 <= order < MOST_ORDER else math.nan


def line(m: Any, x: Any, order: int) -> Any:
    """The derivative of given order of noise in one dimension; slopes at whole numbers are uniform in -2..2."""
    below = m.floor(x)
    (_, near), (_, far) = _weights(x - below, order)
    first, second = (4.0 * unit(*philox(m.word(below + k), m.word(0.0), m.word(0.0))) - 2.0 for k in (0.0, 1.0))
    return first * near + second * far


def space(m: Any, x: Any, y: Any, z: Any, order: int) -> Any:
    """A derivative of noise in three dimensions; ``order``: along x + 8 along y + 64 along z."""
    corner = [m.floor(p) for p in (x, y, z)]
    along = [
        _weights(p - below, order // 8**axis % 8) for axis, (p, below) in enumerate(zip((x, y, z), corner, strict=True))
    ]
    words = [(m.word(below), m.word(below + 1.0)) for below in corner]
    total: Any = 0.0
    for k in range(2):
        for j in range(2):
            for i in range(2):
                (a, u), (b, v), (c, w) = along[0][i], along[1][j], along[2][k]
                chosen, _ = philox(words[0][i], words[1][j], words[2][k])
                total = total + _sloped(m.where, chosen & 15, u * b * c, a * v * c, a * b * w)
    return total


def _sloped(where: Any, chosen: Any, x: Any, y: Any, z: Any) -> Any:
    """The scalar product with one of Perlin's gradients: towards the twelve edges of a cube, four of them twice."""
    first = where(chosen < 8, x, y)
    second = where(chosen < 4, y, where((chosen == 12) | (chosen == 14), x, z))
    return where(chosen & 1, -first, first) + where(chosen & 2, -second, second)


def _weights(f: Any, order: int) -> tuple[tuple[Any, Any], tuple[Any, Any]]:
    """Derivatives, for the corners at f = 0 and f = 1, of the weight w and of w times the offset from the corner."""
    fade, faded = f * 0.0, f * 0.0  # of the fade s(f), and of f s(f)
    for power in range(6, order - 1, -1):
        steep = float(math.perm(power, order))
        fade, faded = fade * f + steep * FADE[power], faded * f + steep * FADE[power - 1]
    one, way = (1.0 if order == 0 else 0.0), (f if order == 0 else 1.0 if order == 1 else 0.0)
    return (one - fade, way - faded), (fade, faded - fade)
