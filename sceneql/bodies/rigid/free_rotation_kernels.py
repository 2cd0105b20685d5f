# mypy: ignore-errors
"""The exact rotation of a rigid body without torque over any time, in closed form.

Where |L| = 1 let a, b, c be the inverse moments about the axes 1, 2, 3 of the body (b lies between the others, axis 3
is the one farthest from b), p = a - b, r = b - c, d = a - c, and (m1, m2, m3) = L in these axes at the start. Euler's
equations are m1' = -r m2 m3, m2' = d m1 m3, m3' = -p m1 m2. With A1^2 = m1^2 + (r/d) m2^2 and A3^2 = m3^2 + (p/d) m2^2,
which are constant, let

    S' = g1 g3,  g1' = -d r A3^2 S g3,  g3' = -d p A1^2 S g1,  S(0) = 0,  g1(0) = g3(0) = 1:

Jacobi's sn, cn and dn over a time, in an order that depends on the sign of r m3^2 - p m1^2. Their addition theorem
gives m after a time h by S, g1, g3 there, without the phase at the start:

    m1(h) = (m1 g1 - r m2 m3 S g3)/D,  m2(h) = (m2 g1 g3 + d m1 m3 S)/D,  m3(h) = (m3 g3 - p m1 m2 S g1)/D,
    D = 1 - p r m2^2 S^2 = g1^2 + d r m3^2 S^2,

the same below, at and above the separatrix, where the last sum does not cancel. The rotation is T turn(psi) B(m): B the
least one that takes m to axis 3, turn(psi) about axis 3, T constant; psi' = b - r m3 + p m1^2/(1 + m3). From phase 0
its integral is one of the third kind, by Carlson's R_J; what the phase adds is, by an addition theorem again, the angle
of a complex number that is algebraic in m(0), m(h) and S.

Source: van Zon & Schofield, J. Comput. Phys. 225 (2007) 145, and Celledoni, Fasso, Safstrom & Zanna, SIAM J. Sci.
Comput. 30 (2008) 2084, who find the phase by an elliptic integral; Carlson, Numer. Algorithms 10 (1995) 13; NIST
Digital Library of Mathematical Functions 19.8, 19.11, 19.36, 22.7 and 22.8.
"""

import math

import numpy as np
from numba import types

from sceneql.compiled.kernels import lean

F = types.float64
LEAST = 1.0e-140
"""Least complementary modulus: below, the motion is taken as on the separatrix."""
FARTHEST = 320.0
"""Argument of sn, cn and dn on the separatrix beyond which they stay: cn and dn are below 1e-138."""
ON_AXIS = 1.0e-30
"""m1^2 + m2^2 below which their direction is taken as along axis 1; what that changes is of the order of this."""


@lean(types.UniTuple(F, 4)(F, F), inner=True)
def jacobi(v, k):
    """(sn, cn, dn, n) of v less n times the half period 2 K, |v - 2 n K| <= K, and complementary modulus ``k``, 0 to 1.

    By Gauss's transformation, in sums that do not cancel: cn and dn keep their digits where they are small.
    """
    if not 1.0 - k > 2.5e-16:  # closer to 1 the next k can be the same one
        n = np.floor(v / math.pi + 0.5)
        sign = 1.0 - 2.0 * (n % 2.0)
        return sign * math.sin(v), sign * math.cos(v), 1.0, n
    s, c, d, n = jacobi(0.5 * (1.0 + k) * v, 2.0 * math.sqrt(k) / (1.0 + k))
    below = (1.0 + k) + (1.0 - k) * s * s
    return 2.0 * s / below, (1.0 + k) * c * d / below, (2.0 * k + (1.0 - k) * c * c) / below, n


@lean(F(F, F, F, F), inner=True)
def third_kind(x, y, p, product):
    """Carlson's R_J(x, y, 1, p), 0 <= x, y <= 1, not both 0, 1 <= p <= 2; ``product`` = (p - x)(p - y)(p - 1)."""
    z, mean, total, share = 1.0, 1.0, 0.0, 1.0
    for _ in range(40):  # 4 to 6 for most, 20 for the least x and y; a NaN ends
        mean = 0.2 * (x + y + z + 2.0 * p)
        if max(abs(mean - x), abs(mean - y), abs(mean - z), abs(mean - p)) < 0.012 * mean:
            break
        rx, ry, rz, rp = math.sqrt(x), math.sqrt(y), math.sqrt(z), math.sqrt(p)
        below = (rp + rx) * (rp + ry) * (rp + rz)
        e = product / (below * below)
        if e < 1.0e-3:
            arc = 1.0 - e * (1.0 / 3.0 - e * (0.2 - e * (1.0 / 7.0 - e * (1.0 / 9.0 - e / 11.0))))
        else:
            arc = math.atan(math.sqrt(e)) / math.sqrt(e)
        total += share * arc / below
        more = rx * (ry + rz) + ry * rz
        x, y, z, p = 0.25 * (x + more), 0.25 * (y + more), 0.25 * (z + more), 0.25 * (p + more)
        share *= 0.25
        product *= 1.0 / 64.0
    x, y, z = (mean - x) / mean, (mean - y) / mean, (mean - z) / mean
    p = -0.5 * (x + y + z)
    e2 = x * y + y * z + z * x - 3.0 * p * p
    e3 = x * y * z + 2.0 * e2 * p + 4.0 * p * p * p
    e4 = (2.0 * x * y * z + e2 * p + 3.0 * p * p * p) * p
    e5 = x * y * z * p * p
    series = (
        1.0 - 3.0 / 14.0 * e2 + e3 / 6.0 + 9.0 / 88.0 * e2 * e2 - 3.0 / 22.0 * e4 - 9.0 / 52.0 * e2 * e3
        + 3.0 / 26.0 * e5 - e2 * e2 * e2 / 16.0 + 3.0 / 40.0 * e3 * e3 + 3.0 / 20.0 * e2 * e4
        + 45.0 / 272.0 * e2 * e2 * e3 - 9.0 / 68.0 * (e3 * e4 + e2 * e5)
    )  # fmt: skip
    return share * series / (mean * math.sqrt(mean)) + 6.0 * total


@lean(types.UniTuple(F, 4)(*[F] * 8), inner=True)
def turned(m1, m2, m3, a, p, r, gap, t):
    """The rotation (w - 1, x, y, z) over the time ``t`` in the axes of the file's text; ``gap`` = r m3^2 - p m1^2.

    Without the 1, and with all else in changes, a small rotation keeps its digits, and many of them add no more.
    """
    d = p + r
    part = p / d if d != 0.0 else 0.5
    a3 = m3 * m3 + part * m2 * m2
    upper, lower = r * d * a3, p * (d * m1 * m1 + r * m2 * m2)
    about = d * gap >= 0.0  # L circles axis 3, else axis 1
    # Half a turn about axis 2 makes m3, or m1, positive for good.
    flip = -1.0 if (m3 if about else m1) < 0.0 else 1.0
    m1, m3 = flip * m1, flip * m3

    most = max(upper, lower)
    speed = math.sqrt(most)
    s, g1, g3, n, rest, least = t, 1.0, 1.0, 0.0, 0.0, 1.0
    if speed > 1.0e-150:
        least = math.sqrt(abs(d * gap) / most)
        v = speed * t
        if least < LEAST:
            least = LEAST
            rest = v - max(-FARTHEST, min(FARTHEST, v))
            v -= rest
            rest /= speed
        sn, cn, dn, n = jacobi(v, min(1.0, least))
        s = sn / speed
        if sn * sn < 0.5:
            g1, g3 = math.sqrt(1.0 - upper * s * s), math.sqrt(1.0 - lower * s * s)
        else:
            g1, g3 = (cn, dn) if about else (dn, cn)

    # From phase 0: psi = a t - integral - the angle of g1 + i d A3 S.
    integral = 0.0
    if p != 0.0:
        beta = p * d * a3
        slope = p * d * d * a3
        product = beta * (p * d) * (d * d * a3)
        ss = s * s
        integral = slope / 3.0 * s * ss * third_kind(g1 * g1, g3 * g3, 1.0 + beta * ss, product * ss * ss * ss)
        if n != 0.0:
            ss = 1.0 / most
            x, y = (0.0, least * least) if about else (least * least, 0.0)
            whole = slope / 3.0 * ss / speed * third_kind(x, y, 1.0 + beta * ss, product * ss * ss * ss)
            integral += 2.0 * n * whole
        integral += rest * slope * s * s / (1.0 + beta * s * s)

    sign = 1.0 - 2.0 * (n % 2.0)
    s *= sign
    if about:
        g1 *= sign
    else:
        g3 *= sign
    ss = s * s
    below = g1 * g1 + r * d * m3 * m3 * ss
    if g1 > 0.0 and g3 > 0.0:
        q = s / below
        u1 = r * q * (s * m1 * (p * m2 * m2 * g1 - d * m3 * m3) / (1.0 + g1) - m2 * m3 * g3)
        u2 = d * q * (m1 * m3 - s * m2 * (p * m1 * m1 * g1 + r * m3 * m3 * g3) / (g1 + g3))
        u3 = p * q * (s * m3 * (r * m2 * m2 * g3 - d * m1 * m1) / (1.0 + g3) - m1 * m2 * g1)
    else:
        u1 = (m1 * g1 - r * m2 * m3 * s * g3) / below - m1
        u2 = (m2 * g1 * g3 + d * m1 * m3 * s) / below - m2
        u3 = (m3 * g3 - p * m1 * m2 * s * g1) / below - m3
    n1, n2, n3 = m1 + u1, m2 + u2, m3 + u3
    w0, w1 = 1.0 + m3, 1.0 + n3

    # What the phase adds is the angle of (re + i im) (g1 + i d A3 S), less whole turns.
    if p == 0.0:
        angle = -r * m3 * t
    else:
        turn = d * math.sqrt(a3) * s
        f = 0.5 * p * s * m2
        across, along = m1 * m1 + m2 * m2, n1 * n1 - n2 * n2
        re = across + m1 * u1 + m2 * u2 - f * (m1 * w1 - (m1 * along + 2.0 * m2 * n1 * n2) / w1)
        im = m2 * u1 - m1 * u2 - f * (m2 * w1 - (m2 * along - 2.0 * m1 * n1 * n2) / w1)
        if across < ON_AXIS:
            re, im = g1, -turn
        if about and (n != 0.0 or re <= 0.0):
            angle = math.atan2(im * g1 + re * turn, re * g1 - im * turn) - math.atan2(sign * turn, sign * g1)
            angle -= n * math.copysign(math.pi, d)
        elif re > 0.0:
            angle = math.atan2(im, re)
        else:
            angle = math.atan2(m2, m1) + math.atan2(m1 * im - m2 * re, m1 * re + m2 * im)

    half = 0.5 * (a * t - integral + angle)
    size = 0.5 / math.sqrt(w0 * w1)
    c, s = size * math.cos(half), size * math.sin(half)
    x = c * (w0 * u2 - m2 * u3) + s * (w0 * n1 + w1 * m1)
    y = c * (m1 * u3 - w0 * u1) + s * (w0 * n2 + w1 * m2)
    z = c * (m2 * u1 - m1 * u2) + s * (w0 * w1 - m1 * n1 - m2 * n2)
    w = c * (w0 * w1 + m1 * n1 + m2 * n2) + s * (m2 * u1 - m1 * u2)
    change = -(x * x + y * y + z * z) / (1.0 + w) if w > 0.0 else w - 1.0
    return change, flip * x, y, flip * z


@lean(types.UniTuple(F, 4)(*[F] * 11))
def rotated(qw, qx, qy, qz, lx, ly, lz, i1, i2, i3, h):
    """The unit quaternion (w, x, y, z) after ``h`` seconds, of any sign and length, without torque: exact to rounding.

    ``q`` turns the body's principal axes to the world; ``l`` [kg m^2/s] is the angular momentum in the world, and may
    be 0; ``i1, i2, i3`` [kg m^2] are the principal moments, all above 0, in any order, equal or not. About a point of
    the body that is fixed in the world the same holds, with the moments and the angular momentum about that point.

    The sign of q is that of the continuous motion. The error, in radians, is below 1e-15 (1 + the angle turned), plus
    what changes of q, l and the moments in their last digit make: much where a body passes near its middle axis.
    """
    # L in the body's axes.
    tx, ty, tz = 2.0 * (qy * lz - qz * ly), 2.0 * (qz * lx - qx * lz), 2.0 * (qx * ly - qy * lx)
    m1 = lx - qw * tx + (qy * tz - qz * ty)
    m2 = ly - qw * ty + (qz * tx - qx * tz)
    m3 = lz - qw * tz + (qx * ty - qy * tx)
    square = m1 * m1 + m2 * m2 + m3 * m3
    if square == 0.0:
        return qw, qx, qy, qz
    length = math.sqrt(square)
    # Axis 3 is the one across from the two inverse moments that are nearest each other.
    ab, bc, ca = (i2 - i1) / (i1 * i2), (i3 - i2) / (i2 * i3), (i1 - i3) / (i3 * i1)
    nearest = min(abs(ab), abs(bc), abs(ca))
    cycle = 0 if abs(ab) == nearest else 1 if abs(bc) == nearest else 2
    if cycle == 1:
        m1, m2, m3, i1, i2, ab, bc, ca = m2, m3, m1, i2, i3, bc, ca, ab
    elif cycle == 2:
        m1, m2, m3, i1, i2, ab, bc, ca = m3, m1, m2, i3, i1, ca, ab, bc
    swap = ab * bc < 0.0  # axis 2 becomes the one between by a quarter turn about axis 3
    if swap:
        m1, m2, i1, ab, bc = m2, -m1, i2, -ab, -ca
    # By m as it is, in as few operations: the period near the separatrix hangs on the last digit.
    gap = (bc * (m3 * m3) - ab * (m1 * m1)) / square
    time = math.sqrt(lx * lx + ly * ly + lz * lz) * h
    w, x, y, z = turned(m1 / length, m2 / length, m3 / length, 1.0 / i1, ab, bc, gap, time)
    if swap:
        x, y = -y, x
    if cycle == 1:
        x, y, z = z, x, y
    elif cycle == 2:
        x, y, z = y, z, x
    nw = qw + (qw * w - qx * x - qy * y - qz * z)
    nx = qx + (qw * x + qx * w + qy * z - qz * y)
    ny = qy + (qw * y - qx * z + qy * w + qz * x)
    nz = qz + (qw * z + qx * y - qy * x + qz * w)
    scale = 1.0 / math.sqrt(nw * nw + nx * nx + ny * ny + nz * nz)
    return nw * scale, nx * scale, ny * scale, nz * scale
