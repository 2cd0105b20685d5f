# mypy: ignore-errors
"""The best point of a curve: the p of a quadratic Bezier curve with the least |x - p|/R(p), R quadratic too.

The derivative d/dq |x - p(q)|^2/R(q)^2 has the zeros of a polynomial of degree 4 in q, since its terms of degree 5
cancel. The sign changes of its Bernstein coefficients bound the number of roots in an interval, and differ from it by
an even number (Descartes; Lane & Riesenfeld 1981): the curve is halved until each piece has at most one root.
"""

import numpy as np
from numba import types

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.skeleton import skeleton_parts_kernels as part

F = types.float64
AT = (F[:, ::1], types.int64, F, F, F)
FINEST = 1.0 / 1024.0
"""Shortest piece of a curve, in q, that is still halved."""
NOTHING = 1.0e-14
"""Relative to the largest coefficient: smaller ones count as zero."""
MOST_TURNS = 60
CLOSE = 1.0e-13
"""Step of Newton's method after which it ends: the error left is about the square of it."""


@inlined
def control(parts, i, x, y, z):
    """(u, v, w, r0, r1, r2) of the part at row i: (x, y, z) - p(q) = w - q u - q^2 v, R(q) = r0 + q r1 + q^2 r2."""
    ax = parts[i, 0]
    ay = parts[i, 1]
    az = parts[i, 2]
    cx = parts[i + 1, 0]
    cy = parts[i + 1, 1]
    cz = parts[i + 1, 2]
    ra = parts[i, part.RADIUS]
    rb = parts[i + 1, part.RADIUS_B]
    rc = parts[i + 1, part.MIDDLE]
    return (
        2.0 * (cx - ax), 2.0 * (cy - ay), 2.0 * (cz - az),
        ax - 2.0 * cx + parts[i, 3], ay - 2.0 * cy + parts[i, 4], az - 2.0 * cz + parts[i, 5],
        x - ax, y - ay, z - az, ra, 2.0 * (rc - ra), ra - 2.0 * rc + rb,
    )  # fmt: skip


@inlined
def stationary(ux, uy, uz, vx, vy, vz, wx, wy, wz, r0, r1, r2):
    """(h0..h4) of h(q) = R^3/2 d/dq (|w - q u - q^2 v|^2/R^2), R = r0 + r1 q + r2 q^2."""
    n0 = wx * wx + wy * wy + wz * wz
    m0 = -(wx * ux + wy * uy + wz * uz)
    m1 = ux * ux + uy * uy + uz * uz - 2.0 * (wx * vx + wy * vy + wz * vz)
    m2 = 3.0 * (ux * vx + uy * vy + uz * vz)
    n4 = vx * vx + vy * vy + vz * vz
    h0 = m0 * r0 - n0 * r1
    h1 = m1 * r0 - m0 * r1 - 2.0 * n0 * r2
    h2 = m2 * r0 - 3.0 * m0 * r2
    h3 = 2.0 * n4 * r0 + m2 / 3.0 * r1 - m1 * r2
    h4 = n4 * r1 - m2 / 3.0 * r2
    return h0, h1, h2, h3, h4


@inlined
def of_bernstein(h0, h1, h2, h3, h4):
    """Coefficients in Bernstein's basis on [0, 1] of a polynomial of degree 4."""
    b1 = h0 + 0.25 * h1
    b2 = h0 + 0.5 * h1 + h2 / 6.0
    b3 = h0 + 0.75 * h1 + 0.5 * h2 + 0.25 * h3
    return h0, b1, b2, b3, h0 + h1 + h2 + h3 + h4


@inlined
def on_piece(h0, h1, h2, h3, h4, low, width):
    """Coefficients of the polynomial in s, where q = low + s width."""
    h3 += low * h4
    h2 += low * h3
    h1 += low * h2
    h0 += low * h1
    h3 += low * h4
    h2 += low * h3
    h1 += low * h2
    h3 += low * h4
    h2 += low * h3
    h3 += low * h4
    two = width * width
    return h0, h1 * width, h2 * two, h3 * two * width, h4 * two * two


@inlined
def rising_root(h0, h1, h2, h3, h4, first, last):
    """The last upward zero of a polynomial with h(0) = first, h(1) = last > 0 in [0, 1]: Newton's method, clamped."""
    low = 0.0
    high = 1.0
    s = first / (first - last) if first < 0.0 else 0.5
    for _ in range(MOST_TURNS):
        f = (((h4 * s + h3) * s + h2) * s + h1) * s + h0
        slope = ((4.0 * h4 * s + 3.0 * h3) * s + 2.0 * h2) * s + h1
        if f < 0.0:
            low = s
        else:
            high = s
        t = s - f / slope if slope > 0.0 else -1.0
        if not (low <= t and t <= high):
            t = 0.5 * (low + high)
        if abs(t - s) <= CLOSE:
            return t
        s = t
    return s


@inlined
def counted(changes, sign, b, zero):
    """(sign changes, last sign) after one more coefficient b; |b| <= zero counts as none."""
    if abs(b) <= zero:
        return changes, sign
    return changes + (1 if b * sign < 0.0 else 0), 1.0 if b > 0.0 else -1.0


@lean(types.UniTuple(F, 4)(*AT), inner=True)
def to_curve(parts, i, x, y, z):
    """(vector from the best point of the curve at row i to (x, y, z), its q from 0 at a to 1 at b)."""
    ux, uy, uz, vx, vy, vz, wx, wy, wz, ra, r1, r2 = control(parts, i, x, y, z)
    h0, h1, h2, h3, h4 = stationary(ux, uy, uz, vx, vy, vz, wx, wy, wz, ra, r1, r2)
    zero = NOTHING * (abs(h0) + abs(h1) + abs(h2) + abs(h3) + abs(h4))
    best = 0.0
    least = np.inf
    low = 0.0
    width = 1.0
    while low < 1.0:
        g0, g1, g2, g3, g4 = on_piece(h0, h1, h2, h3, h4, low, width)
        b0, b1, b2, b3, b4 = of_bernstein(g0, g1, g2, g3, g4)
        changes, sign = counted(0, 0.0, b0, zero)
        changes, sign = counted(changes, sign, b1, zero)
        changes, sign = counted(changes, sign, b2, zero)
        changes, sign = counted(changes, sign, b3, zero)
        changes, sign = counted(changes, sign, b4, zero)
        # A root at an end of the piece hides sign changes inside.
        hidden = changes == 1 and (abs(b0) <= zero or abs(b4) <= zero)
        if (changes > 1 or hidden) and width > FINEST:
            width *= 0.5
            continue
        # |x - p|/R has a minimum where h goes from negative to positive: at an end of the piece, or inside.
        begins = b0 >= -zero
        ends = b4 <= zero
        for k in range(3):
            q = low
            if k == 0 and begins:
                pass
            elif k == 1 and ends:
                q = low + width
            elif k == 2 and changes > 0 and b4 > 0.0:
                q = low + width * rising_root(g0, g1, g2, g3, g4, b0, b4)
            else:
                continue
            dx = wx - q * (ux + q * vx)
            dy = wy - q * (uy + q * vy)
            dz = wz - q * (uz + q * vz)
            radius = ra + q * (r1 + q * r2)
            s = (dx * dx + dy * dy + dz * dz) / (radius * radius)
            if s < least:
                least = s
                best = q
        low += width
        while width < 1.0 and np.floor(0.5 * low / width) * 2.0 * width == low:
            width *= 2.0
    return wx - best * (ux + best * vx), wy - best * (uy + best * vy), wz - best * (uz + best * vz), best


@lean(types.UniTuple(F, 2)(*AT, F), inner=True)
def curve_way(parts, i, x, y, z, off):
    """Bounds of how far the best point moves, and R there changes, while (x, y, z) moves by at most ``off``.

    The polynomial h of the best point changes by at most ``most`` then; where it rises by at least ``rise`` per step of
    q, its root moves by at most their quotient.
    """
    ux, uy, uz, vx, vy, vz, wx, wy, wz, ra, r1, r2 = control(parts, i, x, y, z)
    h0, h1, h2, h3, h4 = stationary(ux, uy, uz, vx, vy, vz, wx, wy, wz, ra, r1, r2)
    b0, b1, b2, b3, b4 = of_bernstein(h0, h1, h2, h3, h4)
    first = np.sqrt(ux * ux + uy * uy + uz * uz)
    last = np.sqrt((ux + 2.0 * vx) ** 2 + (uy + 2.0 * vy) ** 2 + (uz + 2.0 * vz) ** 2)
    speed = max(first, last)
    change = max(abs(r1), abs(r1 + 2.0 * r2))
    away = np.sqrt(wx * wx + wy * wy + wz * wz) + speed
    most = speed * part.largest_radius(parts, i) * off + change * (2.0 * away * off + off * off)
    size = abs(h0) + abs(h1) + abs(h2) + abs(h3) + abs(h4)
    rise = 4.0 * min(min(b1 - b0, b2 - b1), min(b3 - b2, b4 - b3)) - 1.0e-13 * size
    step = 1.0
    if most < rise:
        step = most / rise * (1.0 + 1.0e-12) + 1.0e-12
    # No chord is longer than the control polygon.
    return min(speed * step, 0.5 * (first + last)), change * step
