# mypy: ignore-errors
"""First-order enclosures of skeletons' densities on many ray segments at once, in float32.

For each part u = 1 - s, s the least |x - p|^2/R(p)^2 over its points p, is enclosed by a parabola a0 + a1 tau - a2
tau^2 +- e along the segment. In a group the largest u counts; K(s) times the weight is added up over the groups.
"""

from sceneql.compiled.kernels import inlined, lean
from sceneql.compiled.lanes_kernels import below, bits_below, first_bit, root, spread
from sceneql.field.packets import packet_density_kernels as density
from sceneql.field.packets import packet_rows as rows
from sceneql.field.packets.packet_curve_kernels import LESS, by_three
from sceneql.field.packets.packet_density_kernels import GROW, HALF, INFINITE, ONE, PAD, TINY, TWO, VECTOR, ZERO, F
from sceneql.field.packets.packet_falloff_kernels import fallen
from sceneql.field.packets.packet_kernels import SKELETON_LANES
from sceneql.field.packets.packet_near_kernels import lanes_within, off_box
from sceneql.field.packets.packet_triangle_kernels import triangle
from sceneql.field.skeleton import skeleton_parts_kernels as part
from sceneql.field.skeleton.falloff_kernels import WYVILL

COARSE = F(8.0)
"""A simpler part is close enough where |u|^2 is at least so many times R times its deviation."""
NONE = F(-1.0)
"""No group."""


@inlined
def nearest_anchor(parts, k, bits, first, x, y, z, rival):
    """(x, y, z, 1/R, |p - x|) of the anchor p with the least |p - x|/R: ``rival``, or one of ``bits`` in k's group."""
    group = parts[rows.GROUP, k + 1]
    bx, by, bz, inverse, away = rival
    while bits != 0:
        k = first + first_bit(bits)
        if parts[rows.GROUP, k + 1] != group:
            break
        bits &= bits - 1
        ax, ay, az = parts[rows.ANCHOR_X, k], parts[rows.ANCHOR_Y, k], parts[rows.ANCHOR_Z, k]
        per = parts[rows.ANCHORED, k]
        wx, wy, wz = x - ax, y - ay, z - az
        r = root(wx * wx + wy * wy + wz * wz)
        one, other = r * per, away * inverse
        bx, by, bz = below(one, other, ax, bx), below(one, other, ay, by), below(one, other, az, bz)
        inverse, away = below(one, other, per, inverse), below(one, other, r, away)
    return bx, by, bz, inverse, away


@inlined
def beaten(parts, k, px, py, pz, ux, uy, uz, speed, way, loose, rival):
    """Bit mask of the lanes in all of which part k has no point with |x - p|/R as low as the rival's.

    The part lies in a ball of radius g about its anchor a: to be shown is |x - a| - g > m |x - b|, b the rival's
    anchor, m the ratio of radii; the difference of both squares is linear in tau but for (1 - m^2) |u|^2 tau^2.
    """
    bx, by, bz, inverse, away = rival
    ratio = parts[rows.FAR, k + 1] * inverse * GROW
    m2 = ratio * ratio
    wx, wy, wz = px - parts[rows.ANCHOR_X, k], py - parts[rows.ANCHOR_Y, k], pz - parts[rows.ANCHOR_Z, k]
    vx, vy, vz = px - bx, py - by, pz - bz
    own, other = wx * wx + wy * wy + wz * wz, m2 * (vx * vx + vy * vy + vz * vz)
    slope = TWO * (ux * (wx - m2 * vx) + uy * (wy - m2 * vy) + uz * (wz - m2 * vz))
    bend = speed * (m2 - ONE)
    least = own - other - abs(slope) - below(bend, ZERO, ZERO, bend)
    g = parts[rows.AWAY, k] + (loose + TWO * parts[rows.BLUR, k]) * (ONE + ratio)
    most = g * (TWO * ratio * (away + way) + g) + F(4.0) * PAD * (own + other + speed * (ONE + m2))
    return bits_below(most * GROW, least)


@inlined
def part_parabola(parts, k, px, py, pz, ux, uy, uz, speed, way, loose):
    """1 - s of part k at p + u tau +- loose, tau in [-1, 1]: a0 + a1 tau - a2 tau^2 +- the last of the four."""
    shape = parts[rows.SHAPE, k + 1]
    if shape == F(part.TRIANGLE):
        return triangle(parts, k, px, py, pz, ux, uy, uz, speed, way, loose)
    # The simpler part deviates by this much wherever it is within reach, where |p - x| < R.
    even, cone = parts[rows.EVEN, k + 1], parts[rows.CONE, k + 1]
    rough = COARSE * parts[rows.RADIUS, k]
    if bits_below(speed, rough * even) == 0:
        return density.around(parts, k, px, py, pz, ux, uy, uz, speed, way, loose + even)
    straight = shape != F(part.CURVE) or bits_below(speed, rough * cone) == 0
    if straight:
        loose = loose + cone
    return by_three(parts, k, straight, px, py, pz, ux, uy, uz, speed, way, loose)


@inlined
def coarse(parts, k, off, ball):
    """As ``part_parabola`` for segments of length R or more: an upper bound of u suffices, as u < 0 has no density."""
    r = root(off) - (ball + TWO * parts[rows.BLUR, k])
    r = below(r, ZERO, ZERO, r) * (LESS / parts[rows.FAR, k + 1])
    most = HALF * (ONE - r * r)
    return most - HALF, spread(ZERO), spread(ZERO), abs(most) + (HALF + PAD)


@inlined
def larger(a, b):
    """The maximum of two parabolas: b + the chord of max(a - b, 0), as in affine_kernels.larger_of."""
    a0, a1, a2, ea = a
    b0, b1, b2, eb = b
    d0 = a0 - b0
    reach = abs(a1 - b1) + abs(a2 - b2) + (ea + eb)
    reach = reach * GROW + PAD * (abs(a0) + abs(b0) + abs(a1) + abs(b1) + a2 + b2) + TINY
    s = HALF + HALF * d0 / reach
    s = below(s, ZERO, ZERO, below(ONE, s, ONE, s))
    t = ONE - s
    high, low = (d0 + reach) * t, (reach - d0) * s
    gap = below(high, low, low, high)
    gap = HALF * below(gap, ZERO, ZERO, gap)
    error = (s * ea + t * eb + gap) * GROW + PAD * (abs(a0) + abs(b0) + abs(a1) + abs(b1) + a2 + b2)
    return s * a0 + t * b0 + gap, s * a1 + t * b1, s * a2 + t * b2, error


@lean(SKELETON_LANES, inner=True)
def skeleton_lanes(parts, start, stop, x, y, z, out, n):
    """Enclosure of the density of the skeleton in columns start..stop-1 at the point enclosed in x, y, z, into ``out``.

    ``parts`` are laid out as in packet_rows.
    """
    for i in range(0, n, VECTOR):
        px, py, pz, ux, uy, uz, box, way, loose = density.looked_at(x, y, z, i)
        speed = ux * ux + uy * uy + uz * uz
        none = spread(ZERO)
        sums = none, none, none, none, none
        best = none, none, none, none
        added = ZERO
        ball = way + loose
        nobody = none, none, none, spread(ONE), spread(INFINITE)
        rival, fresh = nobody, True
        group, kernel, weight = NONE, ZERO, ZERO
        first = start
        bits = density.near_box(parts, first, stop, box)
        while True:
            while bits == 0 and first + VECTOR < stop:
                first += VECTOR
                fresh = True
                bits = density.near_box(parts, first, stop, box)
            last = bits == 0
            k = 0 if last else first + first_bit(bits)
            if last or parts[rows.GROUP, k + 1] != group:
                if group != NONE:
                    g0, g1, g2, ge = best
                    if kernel == F(WYVILL):
                        sums = density.weighed(weight, density.cubed(g0, g1, g2, ge), sums)
                    else:
                        sums = density.weighed(weight, fallen(kernel, g0, g1, g2, ge), sums)
                    added += ONE
                    group = NONE
            if last:
                break
            if fresh or group == NONE:
                rival = nearest_anchor(parts, k, bits, first, px, py, pz, rival if group != NONE else nobody)
                fresh = False
            bits &= bits - 1
            off = off_box(parts, k, px, py, pz)
            near = lanes_within(off, parts[rows.FAR, k + 1] + ball)
            if near & ~beaten(parts, k, px, py, pz, ux, uy, uz, speed, way, loose, rival) == 0:
                continue
            if bits_below(ball, parts[rows.RADIUS, k]) == 0:
                found = coarse(parts, k, off, ball)
            else:
                found = part_parabola(parts, k, px, py, pz, ux, uy, uz, speed, way, loose)
            best = found if group == NONE else larger(found, best)
            group, kernel, weight = parts[rows.GROUP, k + 1], parts[rows.KERNEL, k + 1], parts[rows.WEIGHT, k]
        density.summed(out, i, sums, added, loose)
