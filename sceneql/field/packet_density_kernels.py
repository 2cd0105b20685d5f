# mypy: ignore-errors
"""First-order enclosures of density fields on many ray segments at once, in float32.

With u = 1 - d^2/R^2 the density is max(u, 0)^3, whose second derivative is Lipschitz: it is taken as its Taylor
polynomial of degree 2 about the middle of the segment, with the third derivative bounded.
"""

import numpy as np

from sceneql.field.single_kernels import lane
from sceneql.kernels import inlined, lean

F = np.float32
LANES, VECTOR = 64, 16
C1, E = LANES, 2 * LANES
SPARE = 3 * LANES
"""Where others keep the sine and cosine of an angle, the register of a density has working memory."""
SPEED, OFF = SPARE, SPARE + LANES
"""Of that: squares of the ways of the point, and how far it is off."""
PAD = F(5.0e-7)
GROW = F(1.0 + 4.0e-6)
TINY = F(1.0e-37)
ZERO, HALF, ONE, TWO, THREE = F(0.0), F(0.5), F(1.0), F(2.0), F(3.0)
INFINITE = F(np.inf)
ROUND = F(1.3e-7)
"""Two half units in the last place."""
PART = 11
"""Columns of a part: end a (3), axis b - a (3), 1/R^2, weight, 1/|axis|^2 (0: a point), R, rounding of the place."""


@inlined
def pack_part(part, out):
    """One part (8,) of a tape in float32, into ``out`` (PART,)."""
    size = 0.0
    length2 = 0.0
    for j in range(3):
        s = part[3 + j] - part[j]
        out[j] = part[j]
        out[3 + j] = s
        size += abs(part[j]) + abs(s)
        length2 += s * s
    out[6] = 1.0 / (part[6] * part[6])
    out[7] = part[7]
    out[8] = 1.0 / length2 if length2 > 0.0 else 0.0
    out[9] = part[6]
    out[10] = size * 1.0e-6


@lane
def key_of(number):
    """An integer that is less where the number is: integers are compared in any order, so that loops vectorize."""
    bits = number.view(np.int32)
    return bits ^ ((bits >> np.int32(31)) & np.int32(0x7FFFFFFF))


@inlined
def number_of(key):
    """The number with a key."""
    return np.int32(key ^ ((key >> np.int32(31)) & np.int32(0x7FFFFFFF))).view(np.float32)


@inlined
def span(row, n):
    """Least and largest of what n lanes of a register reach; without bounds where one is not a number."""
    least = np.int32(0x7FFFFFFF)
    most = np.int32(-0x7FFFFFFF)
    for i in range(n):
        reach = (abs(row[C1 + i]) + row[E + i]) * GROW
        bottom, top = key_of(row[i] - reach), key_of(row[i] + reach)
        least = bottom if bottom < least else least
        most = top if top > most else most
    low, high = number_of(least), number_of(most)
    hair = PAD * (abs(low) + abs(high))
    if not (low <= high):
        return -INFINITE, INFINITE
    return low - hair, high + hair


@lane
def gap(a, axis, low, high):
    """How far a segment a, a + axis along one coordinate stays off low..high."""
    before = low - (a + axis if axis > ZERO else a)
    behind = (a if axis > ZERO else a + axis) - high
    off = before if before > behind else behind
    return off if off > ZERO else ZERO


@lane
def cubed(a0, a1, a2, error):
    """(value, slope, spread, top) of max(u, 0)^3 for u = a0 + a1 tau - a2 tau^2 +- error, a2 >= 0; top 0: all is 0."""
    m1 = abs(a1)
    # The largest value of u is no more than this.
    top = a0 + (m1 - a2 if m1 - a2 > HALF * m1 else HALF * m1) + error
    top = ZERO if top <= ZERO else top
    u = a0 if a0 > ZERO else ZERO
    b2 = F(1.5) * u * (a1 * a1 - u * a2)
    steep = m1 + TWO * a2
    bulk = top + m1 + a2
    spread = steep * (steep * steep + F(6.0) * top * a2) + THREE * top * top * error + abs(b2)
    spread += F(4.0) * PAD * bulk * bulk * bulk
    full = HALF * top * top * top
    coarse = not (spread < full)
    return (
        full if coarse else u * u * u + b2,
        ZERO if coarse else THREE * u * u * a1,
        full if coarse else spread,
        top,
    )


@lane
def beside(wx, wy, wz, ux, uy, uz, sx, sy, sz, shrink):
    """From the nearest point of a segment: (wx, wy, wz, half the least and most |u|^2, how far that may be off).

    d^2 to a convex set: its second derivative along a line lies between those of its features.
    """
    speed = ux * ux + uy * uy + uz * uz
    q0 = (wx * sx + wy * sy + wz * sz) * shrink
    q1 = (ux * sx + uy * sy + uz * sz) * shrink
    reach = abs(q1) * GROW + PAD * (abs(q0) + ONE)
    q = q0 if q0 > ZERO else ZERO
    q = q if q < ONE else ONE
    vx, vy, vz = ux - q1 * sx, uy - q1 * sy, uz - q1 * sz
    slow = vx * vx + vy * vy + vz * vz
    inner = q0 - reach > ZERO and q0 + reach < ONE
    beyond = q0 + reach < ZERO or q0 - reach > ONE
    least = speed if beyond else slow
    most = slow if inner else speed
    bent = HALF * (most - least)
    return wx - q * sx, wy - q * sy, wz - q * sz, HALF * (least + most), bent if bent > ZERO else ZERO


@inlined
def prepare(x, y, z, out, n):
    """What all parts ask of n lanes, and no density yet."""
    for i in range(n):
        ux, uy, uz = x[C1 + i], y[C1 + i], z[C1 + i]
        size = abs(x[i]) + abs(y[i]) + abs(z[i]) + abs(ux) + abs(uy) + abs(uz)
        out[i] = out[C1 + i] = out[E + i] = ZERO
        out[SPEED + i] = ux * ux + uy * uy + uz * uz
        out[OFF + i] = x[E + i] + y[E + i] + z[E + i] + PAD * size


@inlined
def add_part(p, x, y, z, out, n, straight):
    """Add the density of a part (PART,) in n lanes; ``straight``: it is a segment, else a point."""
    ax, ay, az, sx, sy, sz = p[0], p[1], p[2], p[3], p[4], p[5]
    inverse, weight, shrink, radius, blur = p[6], p[7], p[8], p[9], p[10]
    size = abs(weight)
    for i in range(n):
        wx, wy, wz = x[i] - ax, y[i] - ay, z[i] - az
        ux, uy, uz = x[C1 + i], y[C1 + i], z[C1 + i]
        speed = out[SPEED + i]
        bent = ZERO
        if straight:
            wx, wy, wz, speed, bent = beside(wx, wy, wz, ux, uy, uz, sx, sy, sz, shrink)
        a0 = ONE - (wx * wx + wy * wy + wz * wz) * inverse
        a1 = -TWO * (wx * ux + wy * uy + wz * uz) * inverse
        a2 = speed * inverse
        su = abs(ux) + abs(uy) + abs(uz)
        off = out[OFF + i] + blur
        # |d^2 - D| <= off (2 d + off) wherever one of the two is within reach.
        error = (off * (TWO * (radius + su) + THREE * off) + bent) * inverse
        error += PAD * (ONE + abs(a0) + abs(a1) + a2)
        value, slope, spread, top = cubed(a0, a1, a2, error)
        c0 = out[i] + weight * value
        c1 = out[C1 + i] + weight * slope
        e = out[E + i] + size * spread * GROW
        out[i] = c0
        out[C1 + i] = c1
        out[E + i] = e + (ZERO if top == ZERO else ROUND * (abs(c0) + abs(c1) + e))


@inlined
def around(x, y, z, block, n):
    """Box around VECTOR of n lanes: least and largest x, y and z."""
    first = VECTOR * block
    lanes = min(VECTOR, n - first)
    x0, x1 = span(x[first:], lanes)
    y0, y1 = span(y[first:], lanes)
    z0, z1 = span(z[first:], lanes)
    return x0, x1, y0, y1, z0, z1


@inlined
def reaches(p, box):
    """Whether a part (PART,) may have a density in a box."""
    gx = gap(p[0], p[3], box[0], box[1])
    gy = gap(p[1], p[4], box[2], box[3])
    gz = gap(p[2], p[5], box[4], box[5])
    reach = p[9] * GROW + p[10] + p[10]
    return not gx * gx + gy * gy + gz * gz > reach * reach * GROW


@inlined
def density_lanes(parts, start, stop, x, y, z, out, n):
    """Enclosure of the density of parts start..stop-1 at the point with enclosures x, y, z, into ``out``."""
    prepare(x, y, z, out, n)
    # Boxes around VECTOR lanes each.
    boxes = around(x, y, z, 0, n), around(x, y, z, 1, n), around(x, y, z, 2, n), around(x, y, z, 3, n)
    for part in range(start, stop):
        p = parts[part]
        first = n
        last = 0
        for block in range(4):
            if VECTOR * block < n and reaches(p, boxes[block]):
                first = min(first, VECTOR * block)
                last = min(VECTOR * block + VECTOR, n)
        if first < last:
            add_part(p, x[first:], y[first:], z[first:], out[first:], last - first, p[8] > ZERO)
    for i in range(n):
        unknown = ZERO * (x[i] + y[i] + z[i] + x[C1 + i] + y[C1 + i] + z[C1 + i])
        unknown += ZERO * (x[E + i] + y[E + i] + z[E + i])
        out[i] += unknown
        out[E + i] += PAD * (abs(out[i]) + abs(out[C1 + i])) + TINY


@inlined
def sizes(x, y, z, spare):
    """Radii of balls that what is enclosed in all lanes stays in."""
    for i in range(LANES):
        hx = (abs(x[C1 + i]) + x[E + i]) * GROW + PAD * abs(x[i])
        hy = (abs(y[C1 + i]) + y[E + i]) * GROW + PAD * abs(y[i])
        hz = (abs(z[C1 + i]) + z[E + i]) * GROW + PAD * abs(z[i])
        spare[i] = np.sqrt(hx * hx + hy * hy + hz * hz) * GROW


@inlined
def within_reach(p, x, y, z, spare, first, stop):
    """Whether a part (PART,) may have a density in one of the lanes first..stop-1, whose ``sizes`` are in ``spare``."""
    ax, ay, az = p[0], p[1], p[2]
    sx, sy, sz = p[3], p[4], p[5]
    shrink, blur = p[8], p[10]
    reach = p[9] * GROW + blur
    lanes = np.int32(0)
    for i in range(LANES):
        wx, wy, wz = x[i] - ax, y[i] - ay, z[i] - az
        q = (wx * sx + wy * sy + wz * sz) * shrink
        q = q if q > ZERO else ZERO
        q = q if q < ONE else ONE
        wx, wy, wz = wx - q * sx, wy - q * sy, wz - q * sz
        # The distance changes no faster than the point moves.
        far = reach + spare[i]
        # Where the place is not a number, nothing is known to be off.
        off = wx * wx + wy * wy + wz * wz > far * far * GROW + TINY
        lanes += np.int32(0) if off | (i < first) | (i >= stop) else np.int32(1)
    return lanes > 0


@inlined
def keep_near(code, k, registers, first, stop, singles, parts, kept, near_singles, near_parts):
    """Copy the parts of density row k that are near lanes first..stop-1 behind those kept; how many there are then."""
    p = code[k, 3]
    x, y, z, spare = registers[p], registers[p + 1], registers[p + 2], registers[k, SPARE:]
    sizes(x, y, z, spare)
    for part in range(code[k, 1], code[k, 2]):
        if within_reach(singles[part], x, y, z, spare, first, stop):
            for j in range(PART):
                near_singles[kept, j] = singles[part, j]
            for j in range(8):
                near_parts[kept, j] = parts[part, j]
            kept += 1
    return kept


@lean("void(float64[:, ::1], float32[:, ::1])")
def pack_parts(parts, out):
    """The parts (p, 8) of a tape as (p, PART)."""
    for i in range(parts.shape[0]):
        pack_part(parts[i], out[i])
