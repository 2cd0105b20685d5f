# mypy: ignore-errors
"""Cones and quadratic Bezier curves in lanes of float32: 1 - s along a segment, s the least |x - p|^2/R(p)^2.

s is the minimum of parabolas in tau, one for each p: minus the steepest of their quadratic terms it is concave, and so
above its chord; and it is below each of the parabolas. That needs s at both ends and in the middle. Where the best p is
known only approximately, the excess of s is bounded by the slope along the part and the growth of that slope.
"""

from sceneql.compiled.kernels import inlined
from sceneql.compiled.lanes_kernels import below, bits_below, spread
from sceneql.field.packets import packet_rows as rows
from sceneql.field.packets.packet_density_kernels import HALF, INFINITE, ONE, PAD, THREE, TINY, TWO, ZERO, F

FOUR, SIX, EIGHT = F(4.0), F(6.0), F(8.0)
MORE, LESS = F(1.0 + 4.0e-6), F(1.0 - 4.0e-6)
QUARTER, SIXTH = F(0.25), F(1.0 / 6.0)
TURNS = 2
"""Newton steps; the error left is bounded."""
LOSS, FINEST = F(1.0e-3), F(1.0 / 16.0)
"""Error of s above which a curve is subdivided, and its shortest piece in q."""


@inlined
def held(q):
    """q clamped to [0, 1]; NaN becomes 0."""
    return below(ZERO, q, below(q, ONE, q, ONE), ZERO)


@inlined
def positive(a):
    """max(a, 0); NaN is propagated."""
    return below(a, ZERO, ZERO, a)


@inlined
def least_of(a, b):
    """min(a, b)."""
    return below(a, b, a, b)


@inlined
def larger_of(a, b):
    """max(a, b)."""
    return below(a, b, b, a)


@inlined
def cone_place(parts, k, wx, wy, wz):
    """(vector from the best point of cone k to a + w, 1/R^2 there, bound of the error of s)."""
    sx, sy, sz = parts[rows.SX, k], parts[rows.SY, k], parts[rows.SZ, k]
    ra = parts[rows.RADIUS_A, k + 1]
    r = parts[rows.RADIUS_B, k + 1] - ra
    length2 = sx * sx + sy * sy + sz * sz
    along = wx * sx + wy * sy + wz * sz
    d2 = wx * wx + wy * wy + wz * wz
    # R^3/2 ds/dq = q den - num, as in skeleton_kernels.
    den = length2 * ra + along * r
    num = along * ra + r * d2
    blur = FOUR * PAD * (length2 * ra + abs(along) * (ra + abs(r)) + abs(r) * d2) + TINY
    ratio = ra / parts[rows.RADIUS_B, k + 1]
    end = below((d2 - TWO * along + length2) * (ratio * ratio), d2, ONE, ZERO)
    q = below(blur, den, held(num / den), end)
    radius = ra + q * r
    # NaN at the best point must make the error NaN too.
    lost = EIGHT * parts[rows.CUBE, k + 1] * blur * below(blur, den, blur / den, ONE) + ZERO * (den + num)
    return wx - q * sx, wy - q * sy, wz - q * sz, ONE / (radius * radius), lost


@inlined
def on_piece(h0, h1, h2, h3, h4, begin, width):
    """Coefficients of the polynomial in t, q = begin + width t."""
    g3, g2 = h3 + (FOUR * begin) * h4, h2 + (THREE * begin) * h3 + (SIX * begin * begin) * h4
    g1 = h1 + (TWO * begin) * h2 + (THREE * begin * begin) * h3 + (FOUR * begin * begin * begin) * h4
    g0 = (((begin * h4 + h3) * begin + h2) * begin + h1) * begin + h0
    two = width * width
    return g0, g1 * width, g2 * two, g3 * (two * width), h4 * (two * two)


@inlined
def root_on(g0, g1, g2, g3, g4, blur):
    """For the slope g of s: (its approximate root t in [0, 1], bound of |g| from t to the root, bound of that way).

    Where g rises, a place with value g is at most g/rise from the root; elsewhere the bounds are max |g| and 1.
    """
    b1 = g0 + QUARTER * g1
    b2 = g0 + HALF * g1 + SIXTH * g2
    b3 = g0 + F(0.75) * g1 + HALF * g2 + QUARTER * g3
    b4 = g0 + g1 + g2 + g3 + g4
    rise = least_of(least_of(b1 - g0, b2 - b1), least_of(b3 - b2, b4 - b3))
    rise = FOUR * rise - F(16.0) * blur
    t = below(g0, ZERO, below(ZERO, b4, held(g0 / (g0 - b4)), ONE), ZERO)
    for _ in range(TURNS):
        g = (((t * g4 + g3) * t + g2) * t + g1) * t + g0
        slope = ((t * (FOUR * g4) + THREE * g3) * t + TWO * g2) * t + g1
        slope = below(slope, rise, rise, slope)
        t = held(t - g / below(slope, TINY, TINY, slope))
    g = (((t * g4 + g3) * t + g2) * t + g1) * t + g0
    # At an end of the interval s can only fall inward.
    g = below(ZERO, t, below(t, ONE, abs(g), positive(g)), positive(-ONE * g)) + blur
    most = larger_of(abs(g0), larger_of(larger_of(abs(b1), abs(b2)), larger_of(abs(b3), abs(b4)))) + blur
    return t, below(ZERO, rise, g, most), below(ZERO, rise, below(g, rise, g / rise, ONE), ONE)


@inlined
def control(parts, k):
    """(u, v, r0, r1, r2) of curve k: p(q) = a + q u + q^2 v, R(q) = r0 + q r1 + q^2 r2."""
    r0, rc = parts[rows.RADIUS_A, k + 1], parts[rows.RADIUS_C, k + 1]
    return (
        TWO * parts[rows.CX, k + 1], TWO * parts[rows.CY, k + 1], TWO * parts[rows.CZ, k + 1],
        parts[rows.VX, k + 1], parts[rows.VY, k + 1], parts[rows.VZ, k + 1],
        r0, TWO * (rc - r0), r0 - TWO * rc + parts[rows.RADIUS_B, k + 1]
    )  # fmt: skip


@inlined
def stationary(curve, wx, wy, wz):
    """(h0..h4, error bound) of h(q) = R^3/2 ds/dq at a + w, as in curve_kernels."""
    ux, uy, uz, vx, vy, vz, r0, r1, r2 = curve
    uv, n4 = ux * vx + uy * vy + uz * vz, vx * vx + vy * vy + vz * vz
    n0 = wx * wx + wy * wy + wz * wz
    m0 = ZERO - (wx * ux + wy * uy + wz * uz)
    m1 = (ux * ux + uy * uy + uz * uz) - TWO * (wx * vx + wy * vy + wz * vz)
    h0 = m0 * r0 - n0 * r1
    h1 = m1 * r0 - m0 * r1 - n0 * (TWO * r2)
    h2 = THREE * (uv * r0 - m0 * r2)
    h3 = (TWO * n4 * r0 + uv * r1) - m1 * r2
    h4 = n4 * r1 - uv * r2
    size = abs(wx) + abs(wy) + abs(wz) + (abs(ux) + abs(uy) + abs(uz) + abs(vx) + abs(vy) + abs(vz))
    blur = size * size * (F(16.0) * PAD * (abs(r0) + abs(r1) + abs(r2))) + TINY
    return h0, h1, h2, h3, h4, blur + ZERO * (h0 + h1 + h2 + h3 + h4)  # NaN where a coefficient overflows


@inlined
def place_at(curve, wx, wy, wz, q):
    """(vector from the curve's point at q to a + w, R there)."""
    ux, uy, uz, vx, vy, vz, r0, r1, r2 = curve
    return wx - q * (ux + q * vx), wy - q * (uy + q * vy), wz - q * (uz + q * vz), r0 + q * (r1 + q * r2)


@inlined
def look_at_piece(curve, least_radius, h, wx, wy, wz, begin, width, state):
    """Update ``state`` (best q, lower bound of s, least s) by one more piece of the curve."""
    best, bottom, least = state
    g0, g1, g2, g3, g4, blur = h
    if width < ONE:
        g0, g1, g2, g3, g4 = on_piece(g0, g1, g2, g3, g4, begin, width)
    t, fall, way = root_on(g0, g1, g2, g3, g4, blur)
    q = begin + width * t
    dx, dy, dz, radius = place_at(curve, wx, wy, wz, q)
    s = (dx * dx + dy * dy + dz * dz) / (radius * radius)
    # R varies by no more than its steepest slope.
    slope = MORE * max(abs(curve[7]), abs(curve[7] + TWO * curve[8]))
    small = larger_of(radius - (slope * width) * way, spread(least_radius))
    cube = small * small * small
    lost = (TWO * MORE * width) * fall * way / cube + ZERO * cube  # NaN where the cube overflows
    return below(s, least, q, best), least_of(bottom, s - lost), least_of(s, least)


@inlined
def unsettled(state):
    """Whether the lower bound of s is too loose in a lane where the density may not vanish."""
    _, bottom, least = state
    return bits_below(bottom, ONE) & bits_below(LOSS, least - bottom) != 0


@inlined
def on_curve(parts, k, wx, wy, wz, ux, uy, uz):
    """(s of curve k at a + w - u, at a + w + u, at a + w, its slope there along u, error bound of the first two).

    The curve is subdivided where the bounds need it. The three points are independent, for instruction parallelism.
    """
    curve, small = control(parts, k), parts[rows.RADIUS, k] * LESS
    ax, ay, az, bx, by, bz = wx - ux, wy - uy, wz - uz, wx + ux, wy + uy, wz + uz
    one, two, three = stationary(curve, ax, ay, az), stationary(curve, bx, by, bz), stationary(curve, wx, wy, wz)
    none = spread(ZERO), spread(INFINITE), spread(INFINITE)
    width = ONE
    while True:
        first = last = middle = none
        begin = ZERO
        while begin < ONE:
            first = look_at_piece(curve, small, one, ax, ay, az, begin, width, first)
            last = look_at_piece(curve, small, two, bx, by, bz, begin, width, last)
            middle = look_at_piece(curve, small, three, wx, wy, wz, begin, width, middle)
            begin += width
        if width <= FINEST or not (unsettled(first) or unsettled(last)):
            break
        width *= QUARTER
    dx, dy, dz, radius = place_at(curve, wx, wy, wz, middle[0])
    inverse = ONE / (radius * radius)
    lost = larger_of(first[2] - positive(first[1]), last[2] - positive(last[1])) + ZERO * (one[5] + two[5] + three[5])
    return first[2], last[2], middle[2], TWO * inverse * (dx * ux + dy * uy + dz * uz), positive(lost)


@inlined
def on_cone(parts, k, wx, wy, wz, ux, uy, uz):
    """As ``on_curve``, for a cone."""
    ax, ay, az, inverse, lost = cone_place(parts, k, wx - ux, wy - uy, wz - uz)
    low = (ax * ax + ay * ay + az * az) * inverse
    ax, ay, az, inverse, more = cone_place(parts, k, wx + ux, wy + uy, wz + uz)
    high = (ax * ax + ay * ay + az * az) * inverse
    ax, ay, az, inverse, _ = cone_place(parts, k, wx, wy, wz)
    middle = (ax * ax + ay * ay + az * az) * inverse
    return low, high, middle, TWO * inverse * (ax * ux + ay * uy + az * uz), larger_of(lost, more)


@inlined
def by_three(parts, k, straight, px, py, pz, ux, uy, uz, speed, way, loose):
    """1 - s at p + u tau +- loose, tau in [-1, 1], for cone or curve k: a0 + a1 tau - a2 tau^2 +- the last one."""
    wx, wy, wz = px - parts[rows.AX, k], py - parts[rows.AY, k], pz - parts[rows.AZ, k]
    if straight:
        low, high, middle, tangent, lost = on_cone(parts, k, wx, wy, wz, ux, uy, uz)
    else:
        low, high, middle, tangent, lost = on_curve(parts, k, wx, wy, wz, ux, uy, uz)
    steep = speed * (MORE * parts[rows.INVERSE, k])
    slope = HALF * (high - low)
    bottom = HALF * (low + high) - steep - lost
    gap = positive(middle - bottom)
    per = parts[rows.RADIUS, k] * parts[rows.INVERSE, k]
    off = (loose + parts[rows.BLUR, k]) * (MORE * per)
    # sqrt(s) has the Lipschitz constant 1/(least R); near a place with s < 1 it is at most 1 + 2 way/R.
    error = HALF * (gap + abs(tangent - slope)) + off * (TWO + FOUR * per * way + THREE * off)
    error = error * MORE + PAD * (low + high + TWO * middle + steep + ONE)
    return ONE - HALF * (bottom + middle), -HALF * (slope + tangent), steep, error
