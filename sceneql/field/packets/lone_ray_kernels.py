# mypy: ignore-errors
"""The first root of c - D along a single ray, D the density of points with Wyvill's kernel: the points in lanes.

As density_roots_kernels finds it for many rays in lanes, in the same slices and by the same steps; rays that go apart
have few points in common. Rows of ``table`` hold what the search knows of the points near a piece of the ray.
"""

import numpy as np

from sceneql.compiled.kernels import inlined
from sceneql.compiled.lanes_kernels import below, bits_below, folded, least, load, most, root, spread, store
from sceneql.field.packets.packet_kernels import VECTOR
from sceneql.field.packets.point_blocks_kernels import whole
from sceneql.field.packets.ray_rows import SETTLED
from sceneql.field.roots.density_march_kernels import (
    FOUR,
    HALF,
    LESS,
    MORE,
    MOST,
    ONE,
    SIX,
    TENTH,
    TINY,
    TWO,
    ZERO,
    F,
)
from sceneql.field.roots.density_roots_kernels import BENT, NEARLY, STEEPEST, SURELY, UNIT
from sceneql.field.roots.density_slice_kernels import CLEARLY, GOLDEN, HAIR, INFINITE, NARROW, THREE
from sceneql.field.tape.tape_ops import HIT, MISS, UNDECIDED

P, T, WEIGHT, INVERSE, RADIUS, LEVEL, ENTER, LEAVE, PEAK = range(0, 18, 2)
"""Rows of ``table`` (an even row begins at a cache line), of a point: u = P - (t - T)^2 INVERSE at t, its weight, 1/R^2
and R; the u at which it alone has the density c; where the ray enters and leaves its reach, and its largest density on
the ray."""
MOST_POINTS = 192
"""Points near a piece of a ray up to which they have room in ``table``."""


@inlined
def place_points(parts, listed, kept, x, y, z, dx, dy, dz, threshold, table):
    """Write the points of the rows ``listed`` that reach a line, in their order; ``listed`` becomes that of these.

    Returns their number and their ``sums``: of |w|, |w|/R and |w|/R^2, the largest 1/R, and the least w or 0.
    """
    n = 0
    bulk = bend = stiff = stiffer = lightest = leveled = 0.0
    level = INFINITE
    for k in range(kept):
        row = np.uint64(listed[k])
        wx, wy, wz = parts[row, 0] - x, parts[row, 1] - y, parts[row, 2] - z
        radius, weight = parts[row, 6], parts[row, 7]
        steep = 1.0 / radius
        inverse = steep * steep
        t = wx * dx + wy * dy + wz * dz
        p = 1.0 - inverse * (wx * wx + wy * wy + wz * wz - t * t)
        if not p > 0.0:
            continue
        table[P, n], table[T, n], table[WEIGHT, n] = F(p), F(t), F(weight)
        table[INVERSE, n], table[RADIUS, n] = F(inverse), F(radius)
        listed[n] = listed[k]
        n += 1
        size = abs(weight)
        bulk += size
        bend = max(bend, steep)
        stiff += size * steep
        stiffer += size * inverse
        lightest = min(lightest, weight)
        if weight != leveled:
            leveled = weight
            level = F((CLEARLY * threshold / weight) ** (1.0 / 3.0)) if weight > threshold > 0.0 else INFINITE
        table[LEVEL, n - 1] = level
    for i in range(n, whole(n)):
        table[P, i] = -ONE
        table[T, i] = table[WEIGHT, i] = table[RADIUS, i] = ZERO
        table[INVERSE, i] = table[LEVEL, i] = ONE
    for i in range(0, n, VECTOR):
        p, t = load(table[P], i), load(table[T], i)
        half = load(table[RADIUS], i) * root(below(p, ZERO, ZERO, p))
        weight = load(table[WEIGHT], i)
        store(table[ENTER], i, below(ZERO, p, t - half, INFINITE))
        store(table[LEAVE], i, below(ZERO, p, t + half, -INFINITE))
        store(table[PEAK], i, below(weight, ZERO, ZERO, weight) * p * p * p)
    return n, (bulk, stiff, stiffer, bend, lightest)


@inlined
def rounding(sums, n, length, threshold):
    """As density_roots_kernels.rounding; a geometric mean is bounded by the arithmetic one."""
    bulk, stiff, stiffer, bend, lightest = sums
    off, negative = UNIT * length, lightest < 0.0
    level = bulk if negative else NEARLY * abs(threshold)
    turns = 2.0 if negative else 1.0
    unit = UNIT * (2.0 * level + bulk)
    return (
        F(unit * (3.0 + 2.0 * turns) + UNIT * (0.5 * n + 4.0) * level),
        F(unit * turns * bend),
        F(STEEPEST * (30.0 * off * stiffer + (n + 40) * UNIT * stiff)),
        F(2.0 * off),
    )


@inlined
def next_slice(table, n, begin):
    """(start, end) of the next slice from ``begin`` on, as beam_kernels.next_slice has it, and a bound of D there."""
    start, last, chords, left = spread(INFINITE), spread(-INFINITE), spread(ZERO), spread(ZERO)
    for i in range(0, n, VECTOR):
        enter, leave = load(table[ENTER], i), load(table[LEAVE], i)
        first = below(enter, begin, begin, enter)
        first = below(begin, leave, first, INFINITE)
        start = below(first, start, first, start)
        late = below(begin, leave, enter, -INFINITE)
        last = below(last, late, late, last)
        chords = chords + below(begin, leave, leave - enter, ZERO)
        left = left + below(begin, leave, ONE, ZERO)
    low, many = least(start), folded(left)
    if low == INFINITE:
        return low, low, ZERO
    end = low + folded(chords) / many
    end = end if most(last) > end else INFINITE
    dense = spread(ZERO)
    for i in range(0, n, VECTOR):
        peak = below(low, load(table[LEAVE], i), load(table[PEAK], i), ZERO)
        dense = dense + below(load(table[ENTER], i), end, peak, ZERO)
    return low, end, folded(dense)


@inlined
def densest(p, t, inverse, start, stop):
    """The largest u of points in start..stop, in lanes."""
    s = below(t, start, start, t)
    s = t - below(stop, s, stop, s)
    u = p - inverse * (s * s)
    return below(u, ZERO, ZERO, u)


@inlined
def survey(table, n, start, stop):
    """(where points are within reach of start..stop (2), an upper bound of D there, first place where one alone reaches
    the threshold)."""
    enter, leave, top, deep = spread(INFINITE), spread(-INFINITE), spread(ZERO), spread(INFINITE)
    for i in range(0, n, VECTOR):
        p, t, inverse = load(table[P], i), load(table[T], i), load(table[INVERSE], i)
        first, last, weight = load(table[ENTER], i), load(table[LEAVE], i), load(table[WEIGHT], i)
        near = below(start, last, below(first, stop, ONE, ZERO), ZERO)
        first, last = below(ZERO, near, first, INFINITE), below(ZERO, near, last, -INFINITE)
        enter, leave = below(first, enter, first, enter), below(leave, last, last, leave)
        u = densest(p, t, inverse, start, stop)
        top = top + below(ZERO, near, below(weight, ZERO, ZERO, weight) * (u * u * u), ZERO)
        lift = p - load(table[LEVEL], i)
        inner = t - load(table[RADIUS], i) * root(below(lift, ZERO, ZERO, lift))
        inner = below(ZERO, lift, below(start, inner, below(inner, stop, inner, INFINITE), INFINITE), INFINITE)
        deep = below(inner, deep, inner, deep)
    return least(enter), most(leave), folded(top), least(deep)


@inlined
def tighten(table, n, start, stop, top, threshold, off):
    """(from, to) where points are dense enough for the threshold, as density_slice_kernels.tighten narrows it."""
    scale = TWO / threshold if threshold > ZERO else ZERO
    total = top * (MORE + scale * off) - threshold
    enter, leave = spread(-INFINITE), spread(INFINITE)
    for i in range(0, n, VECTOR):
        p, t, inverse, weight = (
            load(table[P], i), load(table[T], i), load(table[INVERSE], i), load(table[WEIGHT], i),
        )  # fmt: skip
        u = densest(p, t, inverse, start, stop)
        cube = u * u * u
        rest = cube - total / below(ZERO, weight, weight, ONE)
        rest = below(ZERO, weight, rest, -ONE)
        level = THREE * LESS * rest * u / below(ZERO, rest, cube + TWO * rest, ONE)
        lift = p - level
        half = load(table[RADIUS], i) * MORE * root(below(lift, ZERO, ZERO, lift))
        first, last = below(ZERO, rest, t - half, -INFINITE), below(ZERO, rest, t + half, INFINITE)
        enter, leave = below(enter, first, first, enter), below(last, leave, last, leave)
    return most(enter), least(leave)


@inlined
def sum_up(table, n, a, b, blur):
    """(D at a, D at b, a sixth of its largest slope between, whether a part may fall there), as density_march_kernels
    has them."""
    at_a, at_b, slope = spread(ZERO), spread(ZERO), spread(ZERO)
    falling = 0
    for i in range(0, n, VECTOR):
        p, t, inverse, weight = (
            load(table[P], i), load(table[T], i), load(table[INVERSE], i), load(table[WEIGHT], i),
        )  # fmt: skip
        # The slope of a negative part is that of a positive one, mirrored.
        low, high = below(weight, ZERO, t + t - b, a), below(weight, ZERO, t + t - a, b)
        half = load(table[RADIUS], i) * root(below(p, ZERO, ZERO, p))
        c = t - GOLDEN * half
        c = below(low, c, c, low)
        c = below(c, high, c, high)
        sb, sc = t - high, t - c
        sa = t - low
        ua, ub, uc = p - inverse * (sa * sa), p - inverse * (sb * sb), p - inverse * (sc * sc)
        ua, ub, uc = below(ua, ZERO, ZERO, ua), below(ub, ZERO, ZERO, ub), below(uc, ZERO, ZERO, uc)
        gb, gc = ub * ub * sb, uc * uc * sc
        da, db = ua * ua * ua, ub * ub * ub
        at_a = at_a + weight * below(weight, ZERO, db, da)
        at_b = at_b + weight * below(weight, ZERO, da, db)
        slope = slope + abs(weight) * inverse * below(gb, gc, gc, gb)
        past = bits_below(ZERO, ua) | (bits_below(ZERO, p) & bits_below(low, t + blur))
        falling |= bits_below(t, high + blur) & past
    return folded(at_a), folded(at_b), folded(slope), falling


@inlined
def near_root(table, n, threshold, low, high, at):
    """Two steps of Halley's method from ``at`` in low..high, as density_march_kernels.refine takes them."""
    for _ in range(2):
        density, slope, bend = spread(ZERO), spread(ZERO), spread(ZERO)
        for i in range(0, n, VECTOR):
            inverse, weight = load(table[INVERSE], i), load(table[WEIGHT], i)
            s = load(table[T], i) - at
            square = s * s
            u = load(table[P], i) - inverse * square
            u = below(u, ZERO, ZERO, u)
            rise = SIX * weight * inverse * u
            density = density + weight * (u * u * u)
            slope = slope + rise * (u * s)
            bend = bend + rise * (FOUR * inverse * square - u)
        steep = folded(slope)
        steep = steep if steep > TINY else TINY
        off = (folded(density) - threshold) / steep
        bent = HALF * off * folded(bend)
        at = at - off * steep / (steep - bent if steep > bent + bent else HALF * steep)
        at = at if at > low else low
        at = at if at < high else high
    return at


@inlined
def march(table, n, threshold, low, high, first, close, drift, off_slope, blur, bend, fine, anywhere):
    """(outcome, from, to, root, steps) in low..high, whose first segment ends at ``first``: see
    density_march_kernels.advance."""
    a, b, end = low, first, high
    steps = 0
    while True:
        at_a, at_b, slope, falling = sum_up(table, n, a, b, blur)
        steps += 1
        off = close + drift * b
        fa, fb = threshold - at_a, threshold - at_b
        slope = SIX * slope * MORE + off_slope
        clear = fa - off
        clear = clear if clear > ZERO else ZERO
        flat = ONE / (slope if slope > TINY else TINY)
        step = clear * LESS * flat
        width = b - a
        full = (clear > ZERO) and slope * width * MORE < clear
        start = b if full else a + step
        start = start if start < b else b
        inside, begun = fb + off < ZERO, fa + off < ZERO
        narrow = b - start
        rising = falling == 0 or bend * width * width < fa - fb - TWO * off
        rising = (clear > ZERO and rising) or narrow <= fine * TWO
        if (inside and (anywhere or rising) and not begun) or (begun and anywhere):
            # From behind the root, Newton's step with the largest slope stays behind it.
            return HIT, start, (start if begun else b), b + fb * flat, steps
        if full and b >= end:
            return MISS, start, b, b, steps
        if begun or steps > MOST or (not full and not inside and width <= fine * TWO and step < TENTH * fine):
            return UNDECIDED, start, b, b, steps
        if full:
            then = b + TWO * width
        elif inside:
            r = a + fa * (width / (fa - fb if fa > fb else ONE))
            past = r + HALF * (r - start if r > start else ZERO) + HALF * fine
            past = past if past > start else start + HALF * narrow
            then = past if past < b else b
        else:
            on = start + F(2.5) * step
            on = on if on > start + HALF * width else start + HALF * width
            then = on if on < b else b
        if not full:
            then = then if then > start + fine else start + fine
        a, b = start, (then if then < end else end)


@inlined
def search_piece(table, sums, n, far, threshold, anywhere):
    """(outcome, from, to, root, steps) on 0..far of the line along which points are placed in ``table``."""
    close, drift, off_slope, blur = rounding(sums, n, far, threshold)
    c, way = F(threshold), F(far)
    fine, hair = NARROW * way, HAIR * way
    begin, spent = ZERO, 0
    _, _, stiffer, _, lightest = sums
    positive, bend = lightest >= 0.0, F(BENT * stiffer)
    while True:
        start, end, dense = next_slice(table, n, begin)
        if not start < way:
            return MISS, way, way, way, spent
        stop = end if end < way else way
        if dense >= threshold * SURELY:
            enter, leave, top, deep = survey(table, n, start, stop)
            off = close + drift * stop
            if top > c - off:
                first, last = tighten(table, n, start, stop, top, c, off)
                enter, leave = (first if first > enter else enter), (last if last < leave else leave)
                low, high = enter - hair, leave + hair
                low, high = (low if low > start else start), (high if high < stop else stop)
                if low < high:
                    known = positive and off < (CLEARLY - ONE) * c and low < deep < high
                    if known and anywhere:
                        return HIT, low, deep, low, spent
                    first = deep if known else (high if anywhere else HALF * (low + high))
                    outcome, low, to, at, steps = march(
                        table, n, c, low, high, first, close, drift, off_slope, blur, bend, fine, anywhere
                    )  # fmt: skip
                    spent += steps
                    if outcome != MISS:
                        if outcome == HIT and not anywhere:
                            at = near_root(table, n, c, low, to, at)
                        return outcome, low, to, (at if at > low else low), spent
        if end == INFINITE:
            return MISS, way, way, way, spent
        begin = end


@inlined
def polish(parts, listed, n, threshold, x, y, z, dx, dy, dz, at, low, high, length):
    """(root, whether it is settled): a step of Chebyshev's method in float64, as density_polish_kernels takes it, on
    a line from a place in a unit direction. ``length`` is that of the search."""
    px, py, pz = x + at * dx, y + at * dy, z + at * dz
    density = slope = bend = 0.0
    for k in range(n):
        row = np.uint64(listed[k])
        wx, wy, wz, weight = px - parts[row, 0], py - parts[row, 1], pz - parts[row, 2], parts[row, 7]
        inverse = 1.0 / (parts[row, 6] * parts[row, 6])
        u = 1.0 - inverse * (wx * wx + wy * wy + wz * wz)
        if u > 0.0:
            along = wx * dx + wy * dy + wz * dz
            rise = -6.0 * weight * inverse * u
            density += weight * (u * u * u)
            slope += rise * (u * along)
            bend += rise * (u - 4.0 * inverse * (along * along))
    step = (threshold - density) / slope
    bent = 0.5 * step * step * bend / slope
    root_at = min(max(at + step - bent, low), high)
    return root_at, abs(bent) <= SETTLED * length
