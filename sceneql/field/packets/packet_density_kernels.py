# mypy: ignore-errors
"""First-order enclosures of density fields on many ray segments at once, in float32.

With u = 1 - d^2/R^2 the density is max(u, 0)^3, whose second derivative is Lipschitz: it is enclosed by its Taylor
polynomial of degree 2 about the middle of the segment and a bound of the third derivative. Quadratic terms are summed
over the parts before they are bounded, too.
"""

import numpy as np

from sceneql.compiled.kernels import inlined
from sceneql.compiled.lanes_kernels import below, bits_below, first_bit, fma, least, load, most, spread, store
from sceneql.field.packets import packet_rows as rows

F = np.float32
LANES, VECTOR = 64, 16
C1, E, SPARE = LANES, 2 * LANES, 3 * LANES
"""Columns of a register; SPARE, which keeps the sine and cosine of an angle, is working memory for a density."""
PAD = F(5.0e-7)
GROW = F(1.0 + 4.0e-6)
TINY = F(1.0e-37)
ZERO, HALF, ONE, TWO, THREE = F(0.0), F(0.5), F(1.0), F(2.0), F(3.0)
INFINITE = F(np.inf)
THRICE = F(1.8e-7)
"""Three half units in the last place."""
ROUGH, ROUND = F(2.0e-6), F(2.0e-7)
"""Rounding of one part's density, and of adding it to the sum, relative to its maximum."""


@inlined
def extent(c0, c1, e):
    """Least and largest value enclosed in VECTOR lanes; NaN lanes are left out."""
    reach = (abs(c1) + e) * GROW
    low, high = c0 - reach, c0 + reach
    low = least(below(low, INFINITE, low, INFINITE))
    high = most(below(-INFINITE, high, high, -INFINITE))
    return low - PAD * abs(low), high + PAD * abs(high)


@inlined
def apart(low, high, first, last):
    """Distance between the intervals low..high and first..last, 0 where they overlap."""
    before, behind = low - last, first - high
    off = below(before, behind, behind, before)
    return below(off, ZERO, ZERO, off)


@inlined
def gap(parts, row, k, low, high):
    """Distance along one coordinate of low..high from the boxes of VECTOR parts from the kth on."""
    return apart(low, high, load(parts[row], k), load(parts[row + 1], k))


@inlined
def near_box(parts, k, stop, box):
    """Bit mask of those of VECTOR parts from the kth on, up to ``stop``, that may have a density in a box."""
    gx = gap(parts, rows.LOW_X, k, box[0], box[1])
    gy = gap(parts, rows.LOW_Y, k, box[2], box[3])
    gz = gap(parts, rows.LOW_Z, k, box[4], box[5])
    bits = bits_below(gx * gx + gy * gy + gz * gz, load(parts[rows.REACH], k))
    return bits & ((1 << min(stop - k, VECTOR)) - 1)


@inlined
def beside(parts, k, wx, wy, wz, ux, uy, uz, speed):
    """(w from the nearest point of segment k (3), middle and half width of the range of |dw/dtau|^2).

    The second derivative of d^2 to a convex set along a line lies between those of the set's features.
    """
    sx, sy, sz, shrink = parts[rows.SX, k], parts[rows.SY, k], parts[rows.SZ, k], parts[rows.SHRINK, k]
    q0 = (wx * sx + wy * sy + wz * sz) * shrink
    q1 = (ux * sx + uy * sy + uz * sz) * shrink
    reach = abs(q1) * GROW + PAD * (abs(q0) + ONE)
    first, last = q0 - reach, q0 + reach
    q = below(q0, ZERO, ZERO, below(ONE, q0, ONE, q0))
    vx, vy, vz = ux - q1 * sx, uy - q1 * sy, uz - q1 * sz
    slow = vx * vx + vy * vy + vz * vz
    slowest = below(last, ZERO, speed, below(ONE, first, speed, slow))
    fastest = below(ZERO, first, below(last, ONE, slow, speed), speed)
    bent = HALF * (fastest - slowest)
    return wx - q * sx, wy - q * sy, wz - q * sz, HALF * (slowest + fastest), below(bent, ZERO, ZERO, bent)


@inlined
def around(parts, k, px, py, pz, ux, uy, uz, speed, way, loose):
    """1 - d^2/R^2 at p + u tau +- loose, tau in [-1, 1], for part k: a0 + a1 tau - a2 tau^2 +- the last of the four."""
    inverse = parts[rows.INVERSE, k]
    wx, wy, wz = px - parts[rows.AX, k], py - parts[rows.AY, k], pz - parts[rows.AZ, k]
    curl, bent = speed, spread(ZERO)
    if parts[rows.SHRINK, k] > ZERO:
        wx, wy, wz, curl, bent = beside(parts, k, wx, wy, wz, ux, uy, uz, speed)
    a0 = fma(fma(wz, wz, fma(wy, wy, wx * wx)), -inverse, ONE)
    a1 = fma(wz, uz, fma(wy, uy, wx * ux)) * (-TWO * inverse)
    a2 = curl * inverse
    off = loose + parts[rows.BLUR, k]
    # |d^2 - D| <= off (2 d + off) wherever one of the two is within reach, where |a0| <= 1 + |a1|, too.
    error = fma(off, fma(TWO, parts[rows.RADIUS, k] + way, THREE * off), bent) * inverse
    return a0, a1, a2, fma(PAD, abs(a1) + a2 + ONE, error)


@inlined
def looked_at(x, y, z, i):
    """Of VECTOR lanes of the point x, y, z from the ith on: c0 (3), c1 (3), bounding box, |c1| in all, error bound."""
    px, py, pz = load(x, i), load(y, i), load(z, i)
    ux, uy, uz = load(x, C1 + i), load(y, C1 + i), load(z, C1 + i)
    ex, ey, ez = load(x, E + i), load(y, E + i), load(z, E + i)
    bx, cx = extent(px, ux, ex)
    by, cy = extent(py, uy, ey)
    bz, cz = extent(pz, uz, ez)
    way = abs(ux) + abs(uy) + abs(uz)
    loose = ex + ey + ez + THRICE * (abs(px) + abs(py) + abs(pz) + way)
    return px, py, pz, ux, uy, uz, (bx, cx, by, cy, bz, cz), way, loose


@inlined
def weighed(weight, part, sums):
    """Add a part's polynomial c0, c1, c2, error and size, times its weight, to the sums."""
    d0, d1, d2, d, m = part
    c0, c1, c2, e, size = sums
    much = abs(weight)
    return fma(weight, d0, c0), fma(weight, d1, c1), fma(weight, d2, c2), fma(much, d, e), fma(much, m, size)


@inlined
def summed(out, i, sums, added, loose):
    """Write the sum of polynomials c0 + 3 c1 tau + 3 c2 tau^2 +- e as an enclosure in VECTOR lanes of ``out``."""
    c0, c1, c2, e, size = sums
    c1 = THREE * c1
    c2 = F(1.5) * c2  # half of the quadratic term, which lies between it and 0
    c0 = c0 + c2 + ZERO * loose  # NaN where the place is
    e = (e + abs(c2)) * GROW + (ROUGH + added * ROUND) * size
    store(out, i, c0)
    store(out, C1 + i, c1)
    store(out, E + i, e + PAD * (abs(c0) + abs(c1)) + TINY)


@inlined
def cubed(a0, a1, a2, error):
    """(c0, c1/3, c2/3, e) of a polynomial in tau that encloses max(u, 0)^3, and the cube of the largest u, for u = a0 +
    a1 tau - a2 tau^2 +- error, a2 >= 0."""
    m1 = abs(a1)
    bend = m1 - a2
    half = HALF * m1
    top = a0 + below(half, bend, bend, half) + error
    top = below(top, ZERO, ZERO, top)
    u = below(a0, ZERO, ZERO, a0)
    square = top * top
    most_of_it = square * top
    full = HALF * most_of_it
    steep = fma(TWO, a2, m1)
    third = steep * fma(steep, steep, F(6.0) * (top * a2)) + THREE * (square * error)
    second = u * (a1 * a1 - u * a2)
    reach = fma(F(1.5), abs(second), third)
    value = u * u
    return (
        below(reach, full, value * u, full),
        below(reach, full, value * a1, ZERO),
        below(reach, full, second, ZERO),
        below(reach, full, third, full),
        most_of_it,
    )


@inlined
def density_lanes(parts, start, stop, x, y, z, out, n):
    """Enclosure of the density of parts start..stop-1 at the point with enclosures x, y, z, into ``out``."""
    for i in range(0, n, VECTOR):
        px, py, pz, ux, uy, uz, box, way, loose = looked_at(x, y, z, i)
        speed = ux * ux + uy * uy + uz * uz
        none = spread(ZERO)
        sums = none, none, none, none, none
        added = ZERO
        for first in range(start, stop, VECTOR):
            bits = near_box(parts, first, stop, box)
            while bits != 0:
                k = first + first_bit(bits)
                bits &= bits - 1
                a0, a1, a2, error = around(parts, k, px, py, pz, ux, uy, uz, speed, way, loose)
                sums = weighed(parts[rows.WEIGHT, k], cubed(a0, a1, a2, error), sums)
                added += ONE
        summed(out, i, sums, added, loose)


@inlined
def sizes(x, y, z, spare):
    """Radii, by lane, of balls that contain the enclosed points."""
    for i in range(LANES):
        hx = (abs(x[C1 + i]) + x[E + i]) * GROW + PAD * abs(x[i])
        hy = (abs(y[C1 + i]) + y[E + i]) * GROW + PAD * abs(y[i])
        hz = (abs(z[C1 + i]) + z[E + i]) * GROW + PAD * abs(z[i])
        spare[i] = np.sqrt(hx * hx + hy * hy + hz * hz) * GROW


@inlined
def within_reach(parts, k, x, y, z, spare, first, stop):
    """Whether part k may have a density in one of the lanes first..stop-1, whose ``sizes`` are in ``spare``."""
    ax, ay, az, shrink = parts[rows.AX, k], parts[rows.AY, k], parts[rows.AZ, k], parts[rows.SHRINK, k]
    reach = parts[rows.RADIUS, k] * GROW + parts[rows.BLUR, k]
    for i in range(first // VECTOR * VECTOR, stop, VECTOR):
        wx, wy, wz = load(x, i) - ax, load(y, i) - ay, load(z, i) - az
        if shrink > ZERO:
            sx, sy, sz = parts[rows.SX, k], parts[rows.SY, k], parts[rows.SZ, k]
            q = (wx * sx + wy * sy + wz * sz) * shrink
            q = below(q, ZERO, ZERO, below(ONE, q, ONE, q))
            wx, wy, wz = wx - q * sx, wy - q * sy, wz - q * sz
        # Distance is 1-Lipschitz in the point.
        far = reach + load(spare, i)
        # NaN places count as near.
        near = ~bits_below(far * far * GROW + TINY, wx * wx + wy * wy + wz * wz)
        if near & ((1 << min(stop - i, VECTOR)) - (1 << max(first - i, 0))) != 0:
            return True
    return False


@inlined
def keep_near(code, k, registers, first, stop, singles, parts, kept, near_singles, near_parts):
    """Append the parts of density row k that are near lanes first..stop-1 to those kept; how many there are then."""
    p = code[k, 3]
    x, y, z, spare = registers[p], registers[p + 1], registers[p + 2], registers[k, SPARE:]
    sizes(x, y, z, spare)
    for part in range(code[k, 1], code[k, 2]):
        if within_reach(singles, part, x, y, z, spare, first, stop):
            for j in range(rows.PART):
                near_singles[j, kept] = singles[j, part]
            for j in range(8):
                near_parts[kept, j] = parts[part, j]
            kept += 1
    return kept
