# mypy: ignore-errors
"""First roots of c - D along rays in lanes, D the density of points with Wyvill's kernel: by one-sided bounds of slope.

Along a ray of unit direction a point has u(t) = P - (t - T)^2/R^2 and the density w max(u, 0)^3. Its slope rises up to
Q = T - H/sqrt(5), H the half chord, falls through 0 at T to a minimum, and rises to 0 where the chord ends. So its
maximum on [a, b] is at b or at the place in [a, b] nearest to Q, and with the sum S of these the ray is outside up to a
+ (c - D(a))/S: a Newton step that skips no root (Kalra & Barr 1989, with a one-sided bound of the slope). If no part's
density falls between a place outside and one inside, D is monotonic, and the root there is the only one.

``table`` (k, COLUMNS) has P, T and Q of each part in lanes, then its weight and 1/R^2; ``state`` (ROWS,) is float32,
with LANES numbers of each kind; places on the ray count from the start of the slice.
"""

import numpy as np

from sceneql.compiled.kernels import inlined
from sceneql.field.tape.single_kernels import lane
from sceneql.field.tape.tape_ops import HIT, MISS, UNDECIDED

F = np.float32
LANES, VECTOR = 64, 16
T, Q, WEIGHT, INVERSE = LANES, 2 * LANES, 3 * LANES, 3 * LANES + 1
COLUMNS = 3 * LANES + 8
A, B, END, TRIES, FINE, AT_A, AT_B, SLOPE, STATE, ROOT, TOP, DEEP, FALLING = range(0, 13 * LANES, LANES)
"""Offsets in state of: a segment, end of the search, steps so far, bracket width that suffices; densities at the
segment's ends, a sixth of the largest slope of D, outcome (LIVE until there is one; UNDECIDED at the first step: the
ray begins inside), the root; an upper bound of the density in the slice, the first place where a single part reaches
the threshold; number of parts whose density may fall in the segment."""
ROWS = 13 * LANES
LIVE, MOST = F(-1.0), F(40.0)
ZERO, HALF, ONE, TWO, FOUR, SIX, TENTH = F(0.0), F(0.5), F(1.0), F(2.0), F(4.0), F(6.0), F(0.1)
LESS, MORE = F(1.0 - 1.0e-5), F(1.0 + 1.0e-5)
TINY = F(1.0e-30)


@lane
def risen(p, t, q, a, b, inverse, blur):
    """Of a point: (u^3 at a, u^3 at b, largest u^2 (t - x) for x in [a, b], 1 where u^3 may fall there, else 0).

    Places are off by at most half of ``blur``.
    """
    sa = t - a
    sb = t - b
    c = q if q > a else a
    c = c if c < b else b
    sc = t - c
    ua = p - inverse * (sa * sa)
    ub = p - inverse * (sb * sb)
    uc = p - inverse * (sc * sc)
    ua = ua if ua > ZERO else ZERO
    ub = ub if ub > ZERO else ZERO
    uc = uc if uc > ZERO else ZERO
    gb = ub * ub * sb
    gc = uc * uc * sc
    # A part's density falls only beyond t, where it has its maximum.
    falling = ONE if (t < b + blur) & ((ua > ZERO) | ((p > ZERO) & (a < t + blur))) else ZERO
    return ua * ua * ua, ub * ub * ub, gc if gc > gb else gb, falling


@inlined
def sum_up(table, kept, state, n, blur):
    """Densities at both ends of n lanes' segments, a sixth of D's largest slope there, and how many parts may fall."""
    for i in range(n):
        state[AT_A + i] = state[AT_B + i] = state[SLOPE + i] = state[FALLING + i] = ZERO
    for k in range(kept):
        row = table[k]
        weight, inverse = row[WEIGHT], row[INVERSE]
        steep = weight * inverse
        if weight > ZERO:
            for i in range(n):
                a, b = state[A + i], state[B + i]
                da, db, g, falling = risen(row[i], row[T + i], row[Q + i], a, b, inverse, blur)
                state[AT_A + i] += weight * da
                state[AT_B + i] += weight * db
                state[SLOPE + i] += steep * g
                state[FALLING + i] += falling
        else:  # the slope of a negative part is that of a positive one, mirrored
            for i in range(n):
                t = row[T + i]
                a, b = t + t - state[B + i], t + t - state[A + i]
                db, da, g, falling = risen(row[i], t, row[Q + i], a, b, inverse, blur)
                state[AT_A + i] += weight * da
                state[AT_B + i] += weight * db
                state[SLOPE + i] -= steep * g
                state[FALLING + i] += falling


@inlined
def advance(state, n, threshold, close, drift, off_slope, bend, anywhere):
    """Make each lane's next segment, or its outcome.

    ``close`` + ``drift`` t and ``off_slope`` bound the rounding of D at t and of its slope, ``bend`` its second
    derivative. Returns how many lanes have no outcome. A HIT needs D surely below c, then above, and rising between.
    """
    looking = np.int32(0)
    for i in range(n):
        a, b, end = state[A + i], state[B + i], state[END + i]
        off = close + drift * b
        fa = threshold - state[AT_A + i]
        fb = threshold - state[AT_B + i]
        slope = SIX * state[SLOPE + i]
        slope = slope * MORE + off_slope
        clear = fa - off
        clear = clear if clear > ZERO else ZERO
        flat = ONE / (slope if slope > TINY else TINY)
        step = clear * LESS * flat
        width = b - a
        full = (clear > ZERO) & (slope * width * MORE < clear)
        start = b if full else a + step
        inside = fb + off < ZERO
        start = start if start < b else b
        begun = fa + off < ZERO
        fine = state[FINE + i]
        narrow = b - start
        # Next place to look at: just behind the secant's estimate of the root, or further on along Newton's step.
        r = a + fa * (width / (fa - fb if fa > fb else ONE))
        past = r + HALF * (r - start if r > start else ZERO) + HALF * fine
        past = past if past > start else start + HALF * narrow
        past = past if past < b else b
        on = start + F(2.5) * step
        on = on if on > start + HALF * width else start + HALF * width
        on = on if on < b else b
        then = past if inside else on
        then = then if then > start + fine else start + fine
        then = b + TWO * width if full else then
        then = then if then < end else end
        tries = state[TRIES + i] + ONE
        rising = (state[FALLING + i] == ZERO) | (bend * width * width < fa - fb - TWO * off)
        rising = (clear > ZERO) & rising | (narrow <= fine * TWO)
        hit = (inside & (anywhere | rising) & (~begun)) | (begun & anywhere)
        done = full & (b >= end)
        stuck = begun | (tries > MOST) | (~full) & (~inside) & (width <= fine * TWO) & (step < TENTH * fine)
        outcome = F(HIT) if hit else (F(MISS) if done else (F(UNDECIDED) if stuck else LIVE))
        live = state[STATE + i] == LIVE
        then_state = outcome if live else state[STATE + i]
        state[STATE + i] = then_state
        # Counted in int32: numba's sum of two would be int64, and only half as many lanes go into a vector then.
        looking = np.int32(looking + (np.int32(1) if then_state == LIVE else np.int32(0)))
        state[A + i] = start if live else a
        # A ray that begins inside has its hit at its begin.
        stop = (start if begun else b) if hit else then
        state[B + i] = stop if live else b
        # From behind the root, Newton's step with the largest slope stays behind it.
        state[ROOT + i] = b + fb * flat if live else state[ROOT + i]
        state[TRIES + i] = tries
    return looking


@inlined
def refine(table, kept, state, n, threshold):
    """Two steps of Halley's method for n lanes, each with a single root between A and B: near enough for one step of
    polish."""
    for _ in range(2):
        for i in range(n):
            state[AT_A + i] = state[AT_B + i] = state[SLOPE + i] = ZERO
        for k in range(kept):
            row = table[k]
            weight, inverse = row[WEIGHT], row[INVERSE]
            steep, twist = SIX * weight * inverse, FOUR * inverse
            for i in range(n):
                s = row[T + i] - state[ROOT + i]
                square = s * s
                u = row[i] - inverse * square
                u = u if u > ZERO else ZERO
                rise = steep * u
                state[AT_A + i] += weight * (u * u * u)
                state[SLOPE + i] += rise * (u * s)
                state[AT_B + i] += rise * (twist * square - u)
        for i in range(n):
            low, high = state[A + i], state[B + i]
            slope = state[SLOPE + i]
            slope = slope if slope > TINY else TINY
            off = (state[AT_A + i] - threshold) / slope
            bent = HALF * off * state[AT_B + i]
            root = state[ROOT + i] - off * slope / (slope - bent if slope > bent + bent else HALF * slope)
            root = root if root > low else low
            state[ROOT + i] = root if root < high else high
