# mypy: ignore-errors
"""A trilinear interpolant along a piece of a ray: a cubic, by its Bernstein coefficients."""

import numpy as np

from renderers.tracing.scene_kernels import part

HALVINGS = 60
"""Most steps of a bracketed root; a few suffice where the cubic is not flat."""
CLOSE = 1e-14
"""Length of a bracket that counts as a root."""


@part
def trilinear(r, node, up, deep, u, v, w):
    """The interpolant of the cell whose first node is ``node`` at a place from 0 to 1."""
    near = (1.0 - v) * ((1.0 - u) * r[node] + u * r[node + 1])
    near += v * ((1.0 - u) * r[node + up] + u * r[node + up + 1])
    node += deep
    far = (1.0 - v) * ((1.0 - u) * r[node] + u * r[node + 1])
    far += v * ((1.0 - u) * r[node + up] + u * r[node + up + 1])
    return (1.0 - w) * near + w * far


@part
def inner(x):
    """A place in a cell, clamped to it against rounding."""
    return min(max(x, 0.0), 1.0)


@part
def bernstein(r, node, up, deep, u, v, w, x, y, z):
    """Coefficients (4) of the interpolant from the place (u, v, w) to (x, y, z) of a cell.

    They are means of its values at the corners of the box between the two places (Ramshaw 1989, Blossoms Are Polar
    Forms), so the cubic has no sign that the cell's corners do not have.
    """
    u, v, w, x, y, z = inner(u), inner(v), inner(w), inner(x), inner(y), inner(z)
    one = trilinear(r, node, up, deep, x, v, w) + trilinear(r, node, up, deep, u, y, w)
    one += trilinear(r, node, up, deep, u, v, z)
    two = trilinear(r, node, up, deep, x, y, w) + trilinear(r, node, up, deep, x, v, z)
    two += trilinear(r, node, up, deep, u, y, z)
    return trilinear(r, node, up, deep, u, v, w), one / 3.0, two / 3.0, trilinear(r, node, up, deep, x, y, z)


@part
def cubic(a, b, c, d, t):
    """The cubic of Bernstein coefficients at t, exactly a and d at 0 and 1."""
    s = 1.0 - t
    return s * s * (s * a + 3.0 * t * b) + t * t * (3.0 * s * c + t * d)


@part
def turning(a, b, c, d):
    """The two turning points of the cubic, in order; infinity where there are none."""
    p, q, r = b - a, c - b, d - c  # the slope's coefficients, over 3
    lead, half = p - 2.0 * q + r, q - p
    rest = half * half - lead * p
    if not rest > 0.0:
        return np.inf, np.inf
    big = -(half + np.copysign(np.sqrt(rest), half))
    first, second = (big / lead if lead != 0.0 else np.inf), p / big
    return min(first, second), max(first, second)


@part
def first_root(a, b, c, d, start, negative):
    """Where in [start, 1] the cubic's sign first differs from ``negative``, or 2: between turns it has one root."""
    if start == 0.0 and (a < 0.0) != negative:
        return 0.0
    if negative and a < 0.0 and b < 0.0 and c < 0.0 and d < 0.0:
        return 2.0
    if not negative and a >= 0.0 and b >= 0.0 and c >= 0.0 and d >= 0.0:
        return 2.0
    first, second = turning(a, b, c, d)
    low = start
    for piece in range(3):
        high = 1.0 if piece == 2 else (first if piece == 0 else second)
        if not low < high <= 1.0:
            continue
        if (cubic(a, b, c, d, high) < 0.0) != negative:
            return bracketed(a, b, c, d, low, high, negative)
        low = high
    return 2.0


@part
def bracketed(a, b, c, d, low, high, negative):
    """The root between ``low``, where the sign is ``negative``, and ``high``: by secants (Dowell & Jarratt 1971).

    The end that is returned has the other sign, so that a search from there does not find this root again.
    """
    f, g = cubic(a, b, c, d, low), cubic(a, b, c, d, high)
    side = 0
    for _ in range(HALVINGS):
        if high - low < CLOSE:
            break
        t = (f * high - g * low) / (f - g) if f != g else 0.5 * (low + high)
        if not low < t < high:
            t = 0.5 * (low + high)
        value = cubic(a, b, c, d, t)
        if (value < 0.0) == negative:
            low, f = t, value
            g = 0.5 * g if side == 1 else g
            side = 1
        else:
            high, g = t, value
            f = 0.5 * f if side == 2 else f
            side = 2
    return high
