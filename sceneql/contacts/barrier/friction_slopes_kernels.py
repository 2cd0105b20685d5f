# mypy: ignore-errors
"""The derivative of smooth Coulomb friction, which Newton's method follows through sticking and slipping.

Friction is load * coefficient * u / w(|u|) against the slip u, w = 1 / mobilized. Its own derivative
(1 - u w'^T / w) / w knows no stiffness along a slip beyond the smooth range, so that updates overshoot from there, and
without that part updates contract linearly. So the direction p of friction is an unknown of its own with w p = u, which
an update changes by (du - p w'^T du) / w + u / w - p: with p in place of u / w the derivative is as good as the secant
far from the solution, and the true one at it (Chan, Golub & Mulet 1999, SIAM J. Sci. Comput. 20, 1964). p is shortened
to 1, and the matrix made symmetric: it is positive then. Where an update turns the slip around, p is 0: from a slip in
its own direction p would never learn of sticking.
"""

import math

from sceneql.compiled.kernels import lean_inlined


@lean_inlined
def width(speed, slip):
    """w: speed over the part of friction that acts [m/s]."""
    return speed if speed >= slip else slip / (2.0 - speed / slip)


@lean_inlined
def width_rate(speed, slip):
    """The derivative of w by the speed; between 1/4 and 1."""
    if speed >= slip:
        return 1.0
    part = 1.0 / (2.0 - speed / slip)
    return part * part


@lean_inlined
def direction(u, v, w, slip):
    """The part of friction that acts against a slip, as a vector."""
    part = 1.0 / width(math.sqrt(u * u + v * v + w * w), slip)
    return part * u, part * v, part * w


@lean_inlined
def foreseen(p, q, r, u, v, w, x, y, z, slip):
    """The direction (p, q, r) after an update of the slip from (u, v, w) to (x, y, z), if there is one."""
    if u == x and v == y and w == z:
        return p, q, r
    if u * x + v * y + w * z < 0.0:
        return 0.0, 0.0, 0.0
    speed = math.sqrt(u * u + v * v + w * w)
    whole = width(speed, slip)
    along = 0.0
    if speed > 0.0:
        along = width_rate(speed, slip) / speed * (u * (x - u) + v * (y - v) + w * (z - w))
    p, q, r = (x - p * along) / whole, (y - q * along) / whole, (z - r * along) / whole
    size = math.sqrt(p * p + q * q + r * r)
    if not size < math.inf:
        return 0.0, 0.0, 0.0
    return (p / size, q / size, r / size) if size > 1.0 else (p, q, r)


@lean_inlined
def resistance(a, b, c, u, v, w, p, q, r, slip):
    """The derivative over the load [s/m], its entries xx, xy, xz, yy, yz, zz: at a normal, a slip and a direction."""
    speed = math.sqrt(u * u + v * v + w * w)
    scale = 1.0 / width(speed, slip)
    half = 0.5 * width_rate(speed, slip) / speed if speed > 0.0 else 0.0
    u, v, w = half * u, half * v, half * w
    return (
        scale * (1.0 - a * a - 2.0 * p * u),
        scale * (-a * b - p * v - q * u),
        scale * (-a * c - p * w - r * u),
        scale * (1.0 - b * b - 2.0 * q * v),
        scale * (-b * c - q * w - r * v),
        scale * (1.0 - c * c - 2.0 * r * w),
    )
