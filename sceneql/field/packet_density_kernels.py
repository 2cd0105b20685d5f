# mypy: ignore-errors
"""First-order enclosures of density fields on many ray segments at once, in float32.

With u = 1 - d^2/R^2 the density is max(u, 0)^3, whose second derivative is Lipschitz: it is taken as its Taylor
polynomial of degree 2 about the middle of the segment, with the third derivative bounded.
"""

import numpy as np

from sceneql.kernels import inlined, lean

F = np.float32
LANES = 64
C1, E = LANES, 2 * LANES
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


@inlined
def span(row, n):
    """Least and largest of what n lanes of a register reach, but for those that are not numbers."""
    low = INFINITE
    high = -INFINITE
    for i in range(n):
        reach = (abs(row[C1 + i]) + row[E + i]) * GROW
        bottom, top = row[i] - reach, row[i] + reach
        low = bottom if bottom < low else low
        high = top if top > high else high
    hair = PAD * (abs(low) + abs(high))
    if not (low <= high):
        return -INFINITE, INFINITE
    return low - hair, high + hair


@inlined
def gap(a, axis, low, high):
    """How far a segment a, a + axis along one coordinate stays off low..high."""
    first = a if axis > ZERO else a + axis
    last = a + axis if axis > ZERO else a
    return max(max(first - high, low - last), ZERO)


@inlined
def density_lanes(parts, start, stop, x, y, z, out, n):
    """Enclosure of the density of parts start..stop-1 at the point with enclosures x, y, z, into ``out``."""
    for i in range(n):
        out[i] = out[C1 + i] = out[E + i] = ZERO
    x_low, x_high = span(x, n)
    y_low, y_high = span(y, n)
    z_low, z_high = span(z, n)
    for part in range(start, stop):
        p = parts[part]
        ax, ay, az = p[0], p[1], p[2]
        sx, sy, sz = p[3], p[4], p[5]
        # A part off the box around all lanes is left out.
        gx = gap(ax, sx, x_low, x_high)
        gy = gap(ay, sy, y_low, y_high)
        gz = gap(az, sz, z_low, z_high)
        reach = p[9] * GROW + p[10] + p[10]
        if gx * gx + gy * gy + gz * gz > reach * reach * GROW:
            continue
        inverse, weight, shrink, radius, blur = p[6], p[7], p[8], p[9], p[10]
        size = abs(weight)
        for i in range(n):
            wx, wy, wz = x[i] - ax, y[i] - ay, z[i] - az
            ux, uy, uz = x[C1 + i], y[C1 + i], z[C1 + i]
            speed = ux * ux + uy * uy + uz * uz
            bent = ZERO
            if shrink > ZERO:
                # d^2 to a convex set: its second derivative along a line lies between those of its features.
                q0 = (wx * sx + wy * sy + wz * sz) * shrink
                q1 = (ux * sx + uy * sy + uz * sz) * shrink
                reach = abs(q1) * GROW + PAD * (abs(q0) + ONE)
                q = q0 if q0 > ZERO else ZERO
                q = q if q < ONE else ONE
                wx, wy, wz = wx - q * sx, wy - q * sy, wz - q * sz
                vx, vy, vz = ux - q1 * sx, uy - q1 * sy, uz - q1 * sz
                slow = vx * vx + vy * vy + vz * vz
                beside = q0 - reach > ZERO and q0 + reach < ONE
                beyond = q0 + reach < ZERO or q0 - reach > ONE
                least = speed if beyond else slow
                most = slow if beside else speed
                speed = HALF * (least + most)
                bent = HALF * (most - least)
                bent = bent if bent > ZERO else ZERO
            d0 = wx * wx + wy * wy + wz * wz
            a0 = ONE - d0 * inverse
            a1 = -TWO * (wx * ux + wy * uy + wz * uz) * inverse
            a2 = speed * inverse
            m1 = abs(a1)
            su = abs(ux) + abs(uy) + abs(uz)
            off = x[E + i] + y[E + i] + z[E + i] + blur + PAD * (abs(x[i]) + abs(y[i]) + abs(z[i]) + su)
            # |d^2 - D| <= off (2 d + off) wherever one of the two is within reach.
            error = (off * (TWO * (radius + su) + THREE * off) + bent) * inverse + PAD * (ONE + abs(a0) + m1 + a2)
            # The largest value of a0 + a1 tau - a2 tau^2 is no more than this.
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
            c0 = out[i] + weight * (full if coarse else u * u * u + b2)
            c1 = out[C1 + i] + (ZERO if coarse else weight * (THREE * u * u * a1))
            e = out[E + i] + size * (full if coarse else spread) * GROW
            out[i] = c0
            out[C1 + i] = c1
            out[E + i] = e + (ZERO if top == ZERO else ROUND * (abs(c0) + abs(c1) + e))
    for i in range(n):
        unknown = ZERO * (x[i] + y[i] + z[i] + x[C1 + i] + y[C1 + i] + z[C1 + i])
        unknown += ZERO * (x[E + i] + y[E + i] + z[E + i])
        out[i] += unknown
        out[E + i] += PAD * (abs(out[i]) + abs(out[C1 + i])) + TINY


@inlined
def within_reach(p, x, y, z, first, stop):
    """Whether a part (PART,) may have a density in one of the lanes first..stop-1."""
    ax, ay, az = p[0], p[1], p[2]
    sx, sy, sz = p[3], p[4], p[5]
    shrink, blur = p[8], p[10]
    reach = p[9] * GROW + blur
    lanes = 0
    for i in range(first, stop):
        wx, wy, wz = x[i] - ax, y[i] - ay, z[i] - az
        q = (wx * sx + wy * sy + wz * sz) * shrink
        q = q if q > ZERO else ZERO
        q = q if q < ONE else ONE
        wx, wy, wz = abs(wx - q * sx), abs(wy - q * sy), abs(wz - q * sz)
        hx = (abs(x[C1 + i]) + x[E + i]) * GROW + PAD * abs(x[i])
        hy = (abs(y[C1 + i]) + y[E + i]) * GROW + PAD * abs(y[i])
        hz = (abs(z[C1 + i]) + z[E + i]) * GROW + PAD * abs(z[i])
        # The distance changes no faster than the point moves.
        far = reach + np.sqrt(hx * hx + hy * hy + hz * hz) * GROW
        # Where the place is not a number, nothing is known to be off.
        off = wx * wx + wy * wy + wz * wz > far * far * GROW + TINY
        lanes += 0 if off else 1
    return lanes > 0


@inlined
def keep_near(code, k, registers, first, stop, singles, parts, kept, short, near_singles, near_parts):
    """Copy the parts of density row k that are near lanes first..stop-1 behind those kept; how many there are then."""
    p = code[k, 3]
    short[k, 1] = kept
    for part in range(code[k, 1], code[k, 2]):
        if within_reach(singles[part], registers[p], registers[p + 1], registers[p + 2], first, stop):
            for j in range(PART):
                near_singles[kept, j] = singles[part, j]
            for j in range(8):
                near_parts[kept, j] = parts[part, j]
            kept += 1
    short[k, 2] = kept
    return kept


@lean("void(float64[:, ::1], float32[:, ::1])")
def pack_parts(parts, out):
    """The parts (p, 8) of a tape as (p, PART)."""
    for i in range(parts.shape[0]):
        pack_part(parts[i], out[i])
