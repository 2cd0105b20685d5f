# mypy: ignore-errors
"""First roots of a tape along many rays at once: isolation_kernels.isolate in lanes, by float32 enclosures.

Rays wait in a queue and take a lane each as soon as one is free. All claims are proved; a ray that float32 cannot
decide is left UNDECIDED at a place up to which it is proved outside, for the certified float64 routine. Places along a
ray count from its own begin, where float32 is fine.
"""

import numpy as np

from sceneql.compiled.kernels import inlined, lean
from sceneql.compiled.lanes_kernels import load
from sceneql.field.enclose.affine_kernels import GROW, HALF, ONE, PAD, TINY, TWO, ZERO, F
from sceneql.field.packets import ray_rows
from sceneql.field.packets.packet_kernels import C1, LANES, PACKET, VECTOR, E, enclose, placed, put
from sceneql.field.tape import tape_ops as ops

OX, OY, OZ, DX, DY, DZ, A, B, END, CUT_FROM, CUT_TO, HELD, TRIES, LENGTH, STATE, ROOT, CHANGE, HALF_WAY = range(18)
"""Rows of ``lanes``, LANES numbers each: ray, segment, end of the search, interval cut out, whether the end is proved
inside, enclosures so far, length of the search, outcome (LIVE until there is one); of the last enclosure its root,
change over half of its length, and that half."""
LIVE = F(-1.0)
LARGE = F(1.0e36)
FINE, ROUGH, LEAST = F(2.0e-5), F(1.0e-4), F(2.0e-6)
"""Widths relative to the search: of a bracket good enough; of one that float32 cannot narrow; too small to cut."""
SAFE, SHORTEST, LONGEST, AFTER_CUT = F(0.8), F(0.25), F(8.0), TWO
"""Length of the next segment relative to the outside foretold by the enclosure; least part of a segment that is
examined next; longest segment relative to the one just rejected, and to an interval cut out just passed."""
MOST = F(48.0)
"""Enclosures after which a ray is left to the certified routine."""


@inlined
def place_of(row, i):
    """Index in ``lanes`` of a row's number for lane i."""
    return np.uint64(row * LANES) + np.uint64(i)


@inlined
def enter(lanes, i, asked, j):
    """Load ray j into lane i."""
    for axis in range(3):
        lanes[place_of(OX + axis, i)] = asked[ray_rows.START + axis, j]
        lanes[place_of(DX + axis, i)] = asked[ray_rows.WAY_OF + axis, j]
    far = asked[ray_rows.FAR, j]
    lanes[place_of(A, i)] = asked[ray_rows.NEAR, j]
    lanes[place_of(B, i)] = asked[ray_rows.RUN, j]
    lanes[place_of(END, i)] = far
    lanes[place_of(CUT_FROM, i)] = far
    lanes[place_of(CUT_TO, i)] = far
    lanes[place_of(HELD, i)] = asked[ray_rows.SURE, j]
    lanes[place_of(TRIES, i)] = ZERO
    lanes[place_of(LENGTH, i)] = asked[ray_rows.LONG, j]
    lanes[place_of(STATE, i)] = LIVE


@inlined
def note(lanes, i, j, found):
    """Write the outcome of ray j, in lane i."""
    found[ray_rows.FOUND_STATUS, j] = lanes[place_of(STATE, i)]
    found[ray_rows.FOUND_LOW, j] = lanes[place_of(A, i)]
    found[ray_rows.FOUND_HIGH, j] = lanes[place_of(B, i)]
    found[ray_rows.FOUND_ROOT, j] = lanes[place_of(ROOT, i)]
    found[ray_rows.FOUND_SLOPE, j] = lanes[place_of(CHANGE, i)] / lanes[place_of(HALF_WAY, i)]


@inlined
def place_lanes(lanes, point, n):
    """Enclose the points of the segments of n lanes."""
    for i in range(0, n, VECTOR):
        a, b = load(lanes, A * LANES + i), load(lanes, B * LANES + i)
        middle, half = HALF * (a + b), HALF * (b - a)
        for axis in range(3):
            o, d = load(lanes, (OX + axis) * LANES + i), load(lanes, (DX + axis) * LANES + i)
            c0, c1, e = placed(o, d, middle, half)
            put(point[axis], i, c0, c1, e)


@inlined
def advance(lanes, last, status, n, anywhere):
    """Reject, cut or halve the segment of each lane by its enclosure."""
    for i in range(n):
        a, b, end = lanes[A * LANES + i], lanes[B * LANES + i], lanes[END * LANES + i]
        cut_from, cut_to = lanes[CUT_FROM * LANES + i], lanes[CUT_TO * LANES + i]
        held = lanes[HELD * LANES + i] > ZERO
        c0, c1, where = last[i], last[C1 + i], status[i]
        m = abs(c1)
        e = last[E + i] * GROW + PAD * (abs(c0) + m)
        width = b - a
        outside = (where == F(ops.NOWHERE)) | (c0 - m > e)
        good = e + abs(c0) + m < LARGE
        whole = good & (where == F(ops.WHOLE))
        inside = whole & (((m if anywhere else c1) - c0) > e)
        half = HALF * width
        r = half / (c1 if m > TINY else ONE)
        shift = c0 * r
        x = HALF * (a + b) - shift
        g = e * abs(r)
        blur = PAD * (b + abs(shift) + g)
        linear = good & (e < abs(c0) + m) & (m > TINY)
        falling = linear & (c1 < ZERO)
        rising = linear & (c1 > ZERO)
        start = x - g - blur
        start = start if falling & (start > a) else a
        start = start if start < b else b
        stop = x + g + blur
        stop = stop if stop > start else start
        ends = falling & whole & (stop < b)
        cuts = rising & (stop < b)
        now = stop if ends | cuts else b
        last_end = now if ends else end
        held = held | ends
        from_now = now if cuts else cut_from
        to_now = (cut_to if b == cut_from else b) if cuts else cut_to
        narrow = now - start
        slow = narrow >= HALF * width
        bracket = held & (now == last_end)
        whole_way = lanes[LENGTH * LANES + i]
        hit = bracket & ((narrow <= FINE * whole_way) | (slow & (narrow <= ROUGH * whole_way)))
        stuck = (~bracket) & (narrow <= LEAST * whole_way)
        stuck = stuck | (lanes[TRIES * LANES + i] > MOST)
        stuck = stuck | (bracket & slow & (narrow <= LEAST * whole_way))
        # Length up to which all is outside from the end with value f on, if e grows with the square of the length.
        f = c0 + c1 if outside else c0 - c1
        fall = c1 if c1 < ZERO else ZERO
        f = f if f > ZERO else ZERO
        way, per = SAFE * f, np.sqrt(fall * fall + e * f) - fall + TINY
        steep, wide = HALF * m, e + TINY  # steep / wide: the length if the slope dominates
        either = (not outside) & (steep * per > way * wide)
        far = (steep if either else way) / (wide if either else per)
        share = far if far > SHORTEST else SHORTEST
        now = start + (share if share < HALF else HALF) * narrow if slow & (~hit) else now
        # The segment after a rejected one.
        passed = b == cut_from
        after = cut_to if passed else b
        far = far if far > ONE else ONE
        ahead = (far if far < LONGEST else LONGEST) * width
        beyond = AFTER_CUT * (cut_to - cut_from)
        then = after + (beyond if passed & (beyond > ahead) else ahead)
        then = then if then < end else end
        then = cut_from if (cut_from > after) & (cut_from < then) else then
        done = after >= end
        state = F(ops.HIT) if hit | inside else (F(ops.UNDECIDED) if stuck else LIVE)
        rejected = (F(ops.HIT) if lanes[HELD * LANES + i] > ZERO else F(ops.MISS)) if done else LIVE
        lanes[STATE * LANES + i] = rejected if outside else state
        lanes[A * LANES + i] = after if outside else (a if inside else start)
        met = b if anywhere & (c1 < ZERO) else a
        met = HALF * (a + b) if anywhere & (c0 + m < -e) else met
        lanes[B * LANES + i] = then if outside else (met if inside else now)
        lanes[ROOT * LANES + i] = x
        lanes[CHANGE * LANES + i] = c1
        lanes[HALF_WAY * LANES + i] = half
        lanes[END * LANES + i] = end if outside else last_end
        lanes[CUT_FROM * LANES + i] = cut_from if outside else from_now
        lanes[CUT_TO * LANES + i] = cut_to if outside else to_now
        lanes[HELD * LANES + i] = lanes[HELD * LANES + i] if outside else (ONE if held else ZERO)
        lanes[TRIES * LANES + i] += ONE


@lean(
    f"int64({PACKET}, float32[::1], float32[::1], int64[::1], float32[:, ::1], int64[::1], int64,"
    " boolean, float64[:, ::1])",
    inner=True,
)
def search_lanes(code, constants, parts, registers, point, status, lanes, ids, asked, queue, count, anywhere, found):
    """Find the first roots of the first ``count`` rays of the ``queue``; returns the enclosures spent.

    ``asked`` (ASK, n) and ``found`` (5, n) are by ray. A HIT has a bracket low..high: outside before low, inside at
    high; with ``anywhere`` (shadow rays) high is any place inside. MISS: all outside.
    """
    last = registers[code.shape[0] - 1]
    live = min(count, LANES)
    upcoming = live
    for i in range(live):
        ids[i] = queue[i]
        enter(lanes, i, asked, np.uint64(ids[i]))
    spent = 0
    while live > 0:
        n = (live + 15) // 16 * 16
        place_lanes(lanes, point, n)
        enclose(code, constants, parts, registers, point, status, n)
        advance(lanes, last, status, n, anywhere)
        spent += live
        ended = 0
        for i in range(live):
            ids[np.uint64(LANES + ended)] = i
            ended += 1 if lanes[STATE * LANES + i] != LIVE else 0
        # From the last on, so that the lane moved into an ended lane's place is live.
        for k in range(ended - 1, -1, -1):
            i = np.uint64(ids[np.uint64(LANES + k)])
            note(lanes, i, np.uint64(ids[i]), found)
            if upcoming < count:
                ids[i] = queue[np.uint64(upcoming)]
                enter(lanes, i, asked, np.uint64(ids[i]))
                upcoming += 1
            else:
                live -= 1
                for row in range(ROOT):
                    lanes[place_of(row, i)] = lanes[place_of(row, live)]
                ids[i] = ids[np.uint64(live)]
    return spent
