# mypy: ignore-errors
"""First roots of polynomials along a single ray: the counterpart of ``polynomial_search_kernels`` for bundles.

On the searched piece of a ray p is an exact polynomial in tau of [-1, 1], whose float64 coefficients the tape gives
with a bound of their rounding. Quadratic enclosures of it reject or cut segments; a quadratic g of max(p, g) first
clips the piece by its roots. Cases that rounding leaves open are UNDECIDED, for ``isolation_kernels.isolate``.
"""

import numpy as np

from sceneql.compiled.kernels import kernel, lean_inlined
from sceneql.field.enclose.moved_kernels import moved_4, moved_6, moved_8
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.plans import CLIP, DEGREES, MOST_DEGREE, OWN, RADIUS
from sceneql.field.tape.powers_kernels import enclosed_4, enclosed_6, enclosed_8

UNIT = 1.2e-16
MOST = 64
"""Enclosures after which a ray is left undecided."""
LEAST, BLUR, LESS = 1.0e-8, 4.0e-16, 1.0 - 1.0e-14
"""Width of a segment that is left undecided; rounding of places; rounding of a ratio."""
SHORTER = 0.25
"""Part of a segment that is examined next where a cut did not bring its begin much nearer to a root."""
BEFORE = 1.0e-5
"""How far before the end of a segment, relative to half of it, the inside is tested: a clip vanishes at the end."""
TURNS, SETTLED = 12, 1.0e-14
"""Newton steps at most, and the change of a root at which they end."""
TOLD = 1.0e-9
"""Change of a root at the last step, or gap in the proved bounds of a clip, above which a ray is undecided."""


@lean_inlined
def multiply(work, a, da, b, db, out):
    """The product of polynomials of degrees da and db, given by their offsets in ``work``."""
    if da < db:
        a, da, b, db = b, db, a, da
    if db == 0:
        number = work[b]
        for k in range(da + 1):
            work[out + k] = number * work[a + k]
        return
    if da == 1:
        a0, a1, b0, b1 = work[a], work[a + 1], work[b], work[b + 1]
        work[out], work[out + 1], work[out + 2] = a0 * b0, a0 * b1 + a1 * b0, a1 * b1
        return
    if da == 2 and db == 2:
        a0, a1, a2, b0, b1, b2 = work[a], work[a + 1], work[a + 2], work[b], work[b + 1], work[b + 2]
        work[out], work[out + 1], work[out + 2] = a0 * b0, a0 * b1 + a1 * b0, a0 * b2 + a1 * b1 + a2 * b0
        work[out + 3], work[out + 4] = a1 * b2 + a2 * b1, a2 * b2
        return
    for k in range(da + db + 1):
        total = 0.0
        for m in range(max(k - db, 0), min(k, da) + 1):
            total += work[a + m] * work[b + k - m]
        work[out + k] = total


@lean_inlined
def add(work, a, da, b, db, sign, out):
    """a + sign b, given by their offsets in ``work``."""
    for k in range(min(da, db) + 1):
        work[out + k] = work[a + k] + sign * work[b + k]
    for k in range(db + 1, da + 1):
        work[out + k] = work[a + k]
    for k in range(da + 1, db + 1):
        work[out + k] = sign * work[b + k]


@lean_inlined
def expand(code, constants, plan, work, origin, way, middle, half, far):
    """Coefficients of all rows on a piece of a ray; then of each row its norm, the sum of absolute coefficients, and
    the error of the coefficients in that norm, in UNIT: the norm of a product is at most the product of the norms."""
    count = (plan.shape[0] - DEGREES) // 2
    for k in range(count):
        degree = plan[DEGREES + k]
        if degree < 0:
            continue
        out = plan[DEGREES + count + k]
        op, left, right = code[k, 0], code[k, 1], code[k, 2]
        if op == ops.CONSTANT:
            work[out] = constants[left]
            off = 0.0
        elif op >= ops.X and op <= ops.Z:
            o, d = origin[op - ops.X], way[op - ops.X]
            work[out] = o + middle * d
            work[out + 1] = half * d
            off = 4.0 * (abs(o) + 2.0 * far * abs(d))
        else:
            a, da = plan[DEGREES + count + left], plan[DEGREES + left]
            off = work[a + da + 2]
            if op == ops.MUL or op == ops.SQUARE or op == ops.ADD or op == ops.SUB:
                right = left if op == ops.SQUARE else right
                b, db = plan[DEGREES + count + right], plan[DEGREES + right]
                if op == ops.ADD or op == ops.SUB:
                    add(work, a, da, b, db, 1.0 if op == ops.ADD else -1.0, out)
                    off += work[b + db + 2] + work[a + da + 1] + work[b + db + 1]
                else:
                    multiply(work, a, da, b, db, out)
                    size = work[b + db + 1]
                    off = off * size + work[a + da + 1] * (work[b + db + 2] + (degree + 2.0) * size)
            else:
                for m in range(degree + 1):
                    work[out + m] = -work[a + m] if op == ops.NEG else work[a + m]
        norm = UNIT * off
        for m in range(degree + 1):
            norm += abs(work[out + m])
        work[out + degree + 1] = norm
        work[out + degree + 2] = off


@lean_inlined
def rounding(work, at, degree):
    """Bounds of the errors of a polynomial and of its derivative, also after a shift to another middle.

    Moved to another middle m by Horner's scheme, a coefficient is off by 2 d units of the sum of |c_j| |m|^(j - k), and
    |m| and the half length together are at most 1.
    """
    return 2.0 * UNIT * (work[at + degree + 2] + (8.0 * degree + 20.0) * work[at + degree + 1]) * degree


@lean_inlined
def enclosed(c, degree, a, b):
    """(q0, q1, q2, e, bound of the derivative) of c on [a, b], as powers_kernels has them."""
    m, h = 0.5 * (a + b), 0.5 * (b - a) + BLUR
    h2 = h * h
    if degree <= 4:
        c0, c1, c2, c3, c4 = moved_4(c[0], c[1], c[2], c[3], c[4], m)
        return enclosed_4(c0, h * c1, h2 * c2, h * h2 * c3, h2 * h2 * c4)
    h3, h4 = h * h2, h2 * h2
    if degree <= 6:
        c0, c1, c2, c3, c4, c5, c6 = moved_6(c[0], c[1], c[2], c[3], c[4], c[5], c[6], m)
        return enclosed_6(c0, h * c1, h2 * c2, h3 * c3, h4 * c4, h2 * h3 * c5, h3 * h3 * c6)
    c0, c1, c2, c3, c4, c5, c6, c7, c8 = moved_8(c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8], m)
    return enclosed_8(c0, h * c1, h2 * c2, h3 * c3, h4 * c4, h2 * h3 * c5, h3 * h3 * c6, h3 * h4 * c7, h4 * h4 * c8)


@lean_inlined
def march(c, degree, off, a, end, anywhere):
    """(status, from, to) of the first entry into {c < 0} in [a, end], or with ``anywhere`` of any place in it, ``to``.

    INSIDE: a is in it already. In the bracket of a HIT c falls.
    """
    b = end
    late = BEFORE if anywhere else 0.0
    sigma = 1.0 - late
    for _ in range(MOST):
        q0, q1, q2, e, steep = enclosed(c, degree, a, b)
        e += off
        width = b - a
        low = q0 - e
        flat = abs(q1)
        # The parabola has its minimum at an end, or between them at low - q1^2/(4 q2).
        dips = q2 + q2 > flat and 4.0 * q2 * low * LESS <= q1 * q1
        if low + q2 - flat > 0.0 and not dips:
            if b >= end:
                return ops.MISS, end, end
            a = b
            b = min(b + 2.0 * width, end)
            continue
        if q0 + e - q1 + q2 < 0.0:
            return ops.INSIDE, a, a
        inside = q0 + e + sigma * (q1 + sigma * q2) < 0.0
        left = low - q1 + q2
        start = a
        if left > 0.0:
            slope = q1 - 2.0 * q2
            part = 4.0 * q2 * left
            square = slope * slope - part
            square += 1.0e-14 * (slope * slope + abs(part))
            down = np.sqrt(max(square, 0.0)) - slope
            if down > 0.0:
                start = min(max(a + width * (left / down) * LESS - BLUR, a), b)
        if inside:
            end = b
            if anywhere or steep + off < 0.0:
                return ops.HIT, start, b - 0.5 * late * width
        a = start
        if b - a <= LEAST:
            break
        if inside or b - a > 0.5 * width:
            b = a + SHORTER * (b - a)
    return ops.UNDECIDED, a, b


@lean_inlined
def value(c, degree, x):
    """(c, its derivative) at x."""
    p, s = c[degree], 0.0
    for k in range(degree - 1, -1, -1):
        s = p + x * s
        p = c[k] + x * p
    return p, s


@lean_inlined
def polished(c, degree, a, b):
    """(root in [a, b], where c falls; its change at the last step) by Newton's method."""
    x, change = a, np.inf
    for _ in range(TURNS):
        p, s = value(c, degree, x)
        root = min(max(x - p / s, a), b)
        change = abs(root - x)
        x = root
        if change <= SETTLED:
            break
    return x, change


@lean_inlined
def between(c0, c1, c2, slack):
    """(low, high) of the interval where a convex parabola is below ``slack``, a little wider; low > high: nowhere."""
    part = 4.0 * (c0 - slack) * c2
    square = c1 * c1 - part + 1.0e-14 * (c1 * c1 + abs(part))
    if square < 0.0:
        return 1.0, -1.0
    root = np.sqrt(square)
    room = 1.0e-14 * (abs(c1) + root)
    return (-c1 - root - room) / (2.0 * c2), (-c1 + root + room) / (2.0 * c2)


@kernel(
    f"Tuple((int64, float64))({ops.TAPE}, int32[::1], float64, float64, float64, float64, float64, float64, float64,"
    " float64, float64, boolean)",
    _nrt=False,
)
def polynomial_root(code, constants, parts, scratch, plan, ox, oy, oz, dx, dy, dz, t0, t1, sign, anywhere):
    """(status, t) as ``isolation_kernels.isolate``, and INSIDE for the way out (sign < 0) of a ray already outside.

    ``plan`` is that of ``plans.ray_plan``. For UNDECIDED t means nothing, and for a HIT ``anywhere`` it only means that
    the ray is outside before t.
    """
    work = scratch.reshape(scratch.size)
    middle, half = 0.5 * (t0 + t1), 0.5 * (t1 - t0)
    expand(code, constants, plan, work, (ox, oy, oz), (dx, dy, dz), middle, half, max(abs(t0), abs(t1)))
    count = (plan.shape[0] - DEGREES) // 2
    degree = plan[DEGREES + plan[OWN]]
    at = plan[DEGREES + count + plan[OWN]]
    off = rounding(work, at, degree)
    for k in range(MOST_DEGREE + 1):
        work[k] = sign * work[at + k] if k <= degree else 0.0
    low, high, first, last = -1.0, 1.0, -2.0, 2.0
    g0, g1, g2, slack = -1.0, 0.0, 0.0, 0.0
    if plan[CLIP] >= 0:
        g = plan[DEGREES + count + plan[CLIP]]
        if plan[RADIUS] >= 0:
            square = constants[plan[RADIUS]] ** 2
            work[g] -= square
            work[g + 3] += square
        g0, g1, g2, slack = work[g], work[g + 1], work[g + 2], rounding(work, g, 2)
        if not g2 > slack:
            return ops.UNDECIDED, t0
        low, high = between(g0, g1, g2, slack)
        if low > high or low >= 1.0 or high <= -1.0:
            return (ops.MISS if sign > 0.0 else ops.UNDECIDED), t0
        first, last = between(g0, g1, g2, -slack)
        # Outside of low..high the clip is proved positive, in first..last negative.
        if first > last or first - low > TOLD or high - last > TOLD:
            return ops.UNDECIDED, t0
        low, high = max(low, -1.0), min(high, 1.0)
    if sign < 0.0 and first > -1.0:
        return ops.UNDECIDED, t0
    status, a, b = march(work, degree, off, low, high, anywhere)
    if sign < 0.0:
        if (status == ops.MISS and high == 1.0) or status == ops.INSIDE:
            return status, t0
        if status == ops.HIT:
            b, change = polished(work, degree, a, b)
            status = ops.HIT if change <= TOLD else ops.UNDECIDED
        elif status == ops.MISS:
            status, b = ops.HIT, last
        return status, middle + half * min(b, last)
    if status == ops.MISS or status == ops.UNDECIDED:
        return status, t0
    if status == ops.INSIDE:
        b = max(first, -1.0)
        told = value(work, degree, b)[0] + off < 0.0 and b <= min(last, 1.0)
        return (ops.HIT if told else ops.UNDECIDED), (t0 if low == -1.0 else middle + half * b)
    if not anywhere:
        b, change = polished(work, degree, a, b)
        if not change <= TOLD:
            return ops.UNDECIDED, t0
    told = g0 + b * (g1 + b * g2) + slack < 0.0
    return (ops.HIT if told else ops.UNDECIDED), middle + half * (a if anywhere else b)
