# mypy: ignore-errors
"""The exact rotation of a rigid body without torque over any time, in closed form.

In units where |L| = 1 let a, b, c be the inverse moments about the axes 1, 2, 3 of the body (b lies between the others,
axis 3 is the one farthest from b), p = a - b, r = b - c, d = a - c, and (m1, m2, m3) = L in these axes at the start:
Euler's equations are m1' = -r m2 m3, m2' = d m1 m3, m3' = -p m1 m2. With A1^2 = m1^2 + (r/d) m2^2 and
A3^2 = m3^2 + (p/d) m2^2, which are constant, let

    S' = g1 g3,  g1' = -d r A3^2 S g3,  g3' = -d p A1^2 S g1,  S(0) = 0,  g1(0) = g3(0) = 1:

Jacobi's sn, cn and dn over a time, in an order that depends on the sign of r m3^2 - p m1^2. Their addition theorem
gives m after a time h by S, g1, g3 there, without the phase at the start:

    m1(h) = (m1 g1 - r m2 m3 S g3)/D,  m2(h) = (m2 g1 g3 + d m1 m3 S)/D,  m3(h) = (m3 g3 - p m1 m2 S g1)/D,
    D = 1 - p r m2^2 S^2 = g1^2 + d r m3^2 S^2,

the same at, below and above the separatrix, without a sum that cancels. The body's rotation is T turn(psi) B(m): B the
least rotation that takes m to axis 3, turn(psi) about axis 3, T constant; psi' = b - r m3 + p m1^2/(1 + m3). Its
integral is one of the third kind from phase 0, by Carlson's R_J, and by its addition theorem the angle of a complex
number, algebraic in m(0), m(h) and S.

Source: van Zon & Schofield, J. Comput. Phys. 225 (2007) 145; Celledoni, Fasso, Safstrom & Zanna, SIAM J. Sci. Comput.
30 (2008) 2084; R_J: Carlson, Numer. Algorithms 10 (1995) 13, and NIST's Digital Library of Mathematical Functions,
19.36; addition theorems: there 22.8 and 19.11. That the formulas need no phase at the start, and their form near
the separatrix, are of our own.
"""

import math

import numpy as np
from numba import types

from sceneql.compiled.kernels import lean

F = types.float64
LEAST = 1.0e-140
"""Least complementary modulus: below, the motion is taken as on the separatrix."""
FARTHEST = 320.0
"""Argument of sn, cn and dn beyond which none of these changes on the separatrix by more than underflow."""


@lean(types.UniTuple(F, 4)(F, F), inner=True)
def jacobi(v, k):
    """(sn, cn, dn, n) of v less n times the half period 2 K, |v - 2 n K| <= K, and complementary modulus ``k`` > 0.

    By Gauss's transformation; as sums without cancellation, so that cn and dn keep their digits where they are small.
    """
    if 1.0 - k < 2.5e-16:  # rounding of the next k is below
        n = np.floor(v / math.pi + 0.5)
        sign = 1.0 - 2.0 * (n % 2.0)
        return sign * math.sin(v), sign * math.cos(v), 1.0, n
    s, c, d, n = jacobi(0.5 * (1.0 + k) * v, 2.0 * math.sqrt(k) / (1.0 + k))
    below = (1.0 + k) + (1.0 - k) * s * s
    return 2.0 * s / below, (1.0 + k) * c * d / below, (2.0 * k + (1.0 - k) * c * c) / below, n


@lean(F(F, F, F, F), inner=True)
def third_kind(x, y, p, delta):
    """Carlson's R_J(x, y, 1, p), x and y >= 0 and not both 0, p >= 1, ``delta`` = (p - x)(p - y)(p - 1) >= 0."""
    z = 1.0
    total = 0.0
    share = 1.0
    while True:
        mean = 0.2 * (x + y + z + 2.0 * p)
        if max(abs(mean - x), abs(mean - y), abs(mean - z), abs(mean - p)) < 0.012 * mean:
            break
        rx, ry, rz, rp = math.sqrt(x), math.sqrt(y), math.sqrt(z), math.sqrt(p)
        below = (rp + rx) * (rp + ry) * (rp + rz)
        e = delta / (below * below)
        if e < 1.0e-3:
            arc = 1.0 - e * (1.0 / 3.0 - e * (0.2 - e * (1.0 / 7.0 - e * (1.0 / 9.0 - e / 11.0))))
        else:
            arc = math.atan(math.sqrt(e)) / math.sqrt(e)
        total += share * arc / below
        move = rx * (ry + rz) + ry * rz
        x, y, z, p = 0.25 * (x + move), 0.25 * (y + move), 0.25 * (z + move), 0.25 * (p + move)
        share *= 0.25
        delta *= 1.0 / 64.0
    x, y, z = (mean - x) / mean, (mean - y) / mean, (mean - z) / mean
    p = -0.5 * (x + y + z)
    xyz = x * y * z
    e2 = x * y + y * z + z * x - 3.0 * p * p
    e3 = xyz + 2.0 * e2 * p + 4.0 * p * p * p
    e4 = (2.0 * xyz + e2 * p + 3.0 * p * p * p) * p
    e5 = xyz * p * p
    series = (
        1.0 - 3.0 / 14.0 * e2 + e3 / 6.0 + 9.0 / 88.0 * e2 * e2 - 3.0 / 22.0 * e4 - 9.0 / 52.0 * e2 * e3
        + 3.0 / 26.0 * e5 - e2 * e2 * e2 / 16.0 + 3.0 / 40.0 * e3 * e3 + 3.0 / 20.0 * e2 * e4
        + 45.0 / 272.0 * e2 * e2 * e3 - 9.0 / 68.0 * (e3 * e4 + e2 * e5)
    )  # fmt: skip
    return share * series / (mean * math.sqrt(mean)) + 6.0 * total


@lean(types.UniTuple(F, 4)(*[F] * 8), inner=True)
def turned(m1, m2, m3, a, b, p, r, t):
    """The rotation (w, x, y, z) over the time ``t``, in the axes of the file's text, of a body with |m| = 1.

    w is given less 1: a small rotation keeps its digits.
    """
    d = p + r
    a1 = m1 * m1 + (r / d if d != 0.0 else 0.5) * m2 * m2
    a3 = m3 * m3 + (p / d if d != 0.0 else 0.5) * m2 * m2
    lower = p * d * a1
    upper = r * d * a3
    about = upper >= lower  # the vector L circles axis 3, else axis 1
    flip = -1.0 if (m3 if about else m1) < 0.0 else 1.0
    m1 *= flip
    m3 *= flip
    most = max(upper, lower)
    speed = math.sqrt(most)
    s, g1, g3, n, late, least = t, 1.0, 1.0, 0.0, 0.0, 1.0
    if speed > 1.0e-150:
        least = math.sqrt(abs(d * (r * m3 * m3 - p * m1 * m1)) / most)
        v = speed * t
        if least < LEAST:
            least = LEAST
            near = max(-FARTHEST, min(FARTHEST, v))
            late = (v - near) / speed
            v = near
        sn, cn, dn, n = jacobi(v, min(1.0, least))
        s = sn / speed
        g1, g3 = (cn, dn) if about else (dn, cn)
        if sn * sn < 0.5:
            g1 = math.sqrt(1.0 - upper * s * s)
            g3 = math.sqrt(1.0 - lower * s * s)
    # The integral of the third kind, psi = a t - integral - angle(g1 + i d A3 s) from phase 0.
    integral = 0.0
    beta = p * d * a3
    if p != 0.0:
        ss = s * s
        whole = p * d * d * a3 / 3.0
        delta = beta * (p * d) * (d * d * a3)
        integral = s * ss * third_kind(g1 * g1, g3 * g3, 1.0 + beta * ss, delta * ss * ss * ss)
        if n != 0.0:
            ss = 1.0 / most
            rim = least * least
            x, y = (0.0, rim) if about else (rim, 0.0)
            integral += 2.0 * n * ss / speed * third_kind(x, y, 1.0 + beta * ss, delta * ss * ss * ss)
        integral = whole * integral + 3.0 * whole * late * s * s / (1.0 + beta * s * s)
    odd = n % 2.0 == 1.0
    if odd:
        s = -s
        if about:
            g1 = -g1
        else:
            g3 = -g3
    # m after the time, and its change.
    ss = s * s
    rest = g1 * g1 + r * d * m3 * m3 * ss
    if g1 > 0.0 and g3 > 0.0:
        scale = s / rest
        u1 = r * scale * (s * m1 * (p * m2 * m2 * g1 - d * m3 * m3) / (1.0 + g1) - m2 * m3 * g3)
        u2 = d * scale * (m1 * m3 - s * m2 * (p * m1 * m1 * g1 + r * m3 * m3 * g3) / (g1 + g3))
        u3 = p * scale * (s * m3 * (r * m2 * m2 * g3 - d * m1 * m1) / (1.0 + g3) - m1 * m2 * g1)
    else:
        u1 = (m1 * g1 - r * m2 * m3 * s * g3) / rest - m1
        u2 = (m2 * g1 * g3 + d * m1 * m3 * s) / rest - m2
        u3 = (m3 * g3 - p * m1 * m2 * s * g1) / rest - m3
    n1, n2, n3 = m1 + u1, m2 + u2, m3 + u3
    # The angle about L.
    if p == 0.0:
        angle = -r * m3 * t
    else:
        angle = 0.0
    w0, w1 = 1.0 + m3, 1.0 + n3
    f = 0.5 * p * s * m2
    br = n1 - f * (w1 - (n1 * n1 - n2 * n2) / w1)
    bi = -n2 - f * (2.0 * n1 * n2 / w1)
    zz = m1 * m1 + m2 * m2
    turn = d * math.sqrt(a3) * s
    if p != 0.0:
        if zz < 1.0e-30:
            re, im = g1, -turn
            zr, zi = 1.0, 0.0
            br, bi = re, im
        else:
            re = zz + m1 * u1 + m2 * u2 - f * (m1 * w1 - (m1 * (n1 * n1 - n2 * n2) + 2.0 * m2 * n1 * n2) / w1)
            im = m2 * u1 - m1 * u2 - f * (m2 * w1 - (m2 * (n1 * n1 - n2 * n2) - 2.0 * m1 * n1 * n2) / w1)
            zr, zi = m1, m2
        if about and (n != 0.0 or re <= 0.0):
            angle = math.atan2(im * g1 + re * turn, re * g1 - im * turn)
            if odd:
                angle -= math.atan2(-turn, -g1)
            else:
                angle -= math.atan2(turn, g1)
            angle -= n * math.pi
        elif re > 0.0:
            angle = math.atan2(im, re)
        else:
            angle = math.atan2(zi, zr) + math.atan2(bi, br)
    half = 0.5 * (a * t - integral + angle)
    cosine, sine = math.cos(half), math.sin(half)
    by = 0.5 / math.sqrt(w0 * w1)
    x = by * (cosine * (w0 * u2 - m2 * u3) + sine * (w0 * n1 + w1 * m1))
    y = by * (cosine * (m1 * u3 - w0 * u1) + sine * (w0 * n2 + w1 * m2))
    z = by * (cosine * (m2 * u1 - m1 * u2) + sine * (w0 * w1 - m1 * n1 - m2 * n2))
    w = by * (cosine * (w0 * w1 + m1 * n1 + m2 * n2) + sine * (m2 * u1 - m1 * u2))
    less = w - 1.0
    if w > 0.0:
        less = -(x * x + y * y + z * z) / (1.0 + w)
    return less, flip * x, y, flip * z


@lean(types.UniTuple(F, 4)(*[F] * 11))
def rotated(qw, qx, qy, qz, lx, ly, lz, i1, i2, i3, h):
    """The unit quaternion (w, x, y, z) after ``h`` seconds, of any sign and length, without torque: exact to rounding.

    ``q`` turns the body's principal axes to the world; ``l`` [kg m^2/s] is the angular momentum in the world, and may
    be 0; ``i1, i2, i3`` [kg m^2] are the principal moments, all above 0, in any order, equal or not. About a point of
    the body that is fixed in the world the same holds with the moments and the angular momentum about that point.
    """
    size = math.sqrt(lx * lx + ly * ly + lz * lz)
    # L in the body's axes.
    tx, ty, tz = qy * lz - qz * ly, qz * lx - qx * lz, qx * ly - qy * lx
    m1 = lx - 2.0 * (qw * tx - (qy * tz - qz * ty))
    m2 = ly - 2.0 * (qw * ty - (qz * tx - qx * tz))
    m3 = lz - 2.0 * (qw * tz - (qx * ty - qy * tx))
    length = math.sqrt(m1 * m1 + m2 * m2 + m3 * m3)
    if length == 0.0:
        return qw, qx, qy, qz
    m1, m2, m3 = m1 / length, m2 / length, m3 / length
    # Axis 3 is the one across from the two moments that are nearest each other.
    a, b, c = 1.0 / i1, 1.0 / i2, 1.0 / i3
    ab, bc, ca = (i2 - i1) * a * b, (i3 - i2) * b * c, (i1 - i3) * c * a
    least = min(abs(ab), abs(bc), abs(ca))
    cycle = 0 if abs(ab) == least else 1 if abs(bc) == least else 2
    if cycle == 1:
        m1, m2, m3, a, b, ab, bc, ca = m2, m3, m1, b, c, bc, ca, ab
    elif cycle == 2:
        m1, m2, m3, a, b, ab, bc, ca = m3, m1, m2, c, a, ca, ab, bc
    if ab * bc < 0.0:
        w, y, x, z = turned(m2, -m1, m3, b, a, -ab, -ca, size * h)
        x = -x
    else:
        w, x, y, z = turned(m1, m2, m3, a, b, ab, bc, size * h)
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
