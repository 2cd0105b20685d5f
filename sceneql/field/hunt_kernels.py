# mypy: ignore-errors
"""First roots of a tape along many rays at once: isolation_kernels.isolate in lanes, by float32 enclosures.

Rays wait in a queue and take a lane each as soon as one is free. What is claimed is proved; a ray about which float32
can tell no more is left UNDECIDED at a place up to which all is proved outside, for the certified float64 routine.
Places along a ray are counted from its own start, so that float32 numbers them finely.
"""

from sceneql.field.affine_kernels import GROW, HALF, ONE, PAD, TINY, TWO, ZERO, F
from sceneql.field.packet_kernels import C1, LANES, PACKET, E, enclose, place
from sceneql.field.tape_ops import HIT, MISS, NOWHERE, UNDECIDED, WHOLE
from sceneql.kernels import inlined, lean

OX, OY, OZ, DX, DY, DZ, A, B, END, CUT_FROM, CUT_TO, HELD, TRIES, STATE, ROOT, SLOPE, LENGTH = range(17)
"""Rows of ``lanes``, each of LANES, one behind the other: ray, segment, where the search ends, a piece cut out, whether
the inside is proved at the end, enclosures so far, outcome (LIVE until there is one), root and slope [1/t] of the last
enclosure, length of the search."""
ROWS = 17
LIVE = F(-1.0)
LARGE = F(1.0e36)
FINE, ROUGH, LEAST = F(2.0e-5), F(1.0e-4), F(2.0e-6)
"""Widths relative to the search: of a bracket good enough; of one that float32 cannot narrow; too small to cut."""
MOST = F(48.0)
"""Enclosures after which a ray is left to the certified routine."""
SETTLED = 1e-6
"""Change of a root, relative to the length of its search, at the last step of its polish, beyond which it is sought
anew by the certified routine."""
RAY = 8
"""Rows of rays: origin, direction, begin and end."""
FOUND_STATUS, FOUND_LOW, FOUND_HIGH, FOUND_ROOT, FOUND_SLOPE = range(5)
"""Rows of what is found, by ray; places from the ray's own start."""
NEAR, FAR, RUN = range(3)
"""Rows of what is asked, by ray: where to begin and to end, and where the first segment ends."""


@inlined
def load(lanes, i, rays, j, asked):
    """Put ray j into lane i."""
    t0 = rays[6, j]
    for axis in range(3):
        lanes[(OX + axis) * LANES + i] = rays[axis, j] + t0 * rays[3 + axis, j]
        lanes[(DX + axis) * LANES + i] = rays[3 + axis, j]
    lanes[A * LANES + i] = asked[NEAR, j]
    lanes[B * LANES + i] = asked[RUN, j]
    lanes[END * LANES + i] = asked[FAR, j]
    lanes[CUT_FROM * LANES + i] = lanes[CUT_TO * LANES + i] = asked[FAR, j]
    lanes[LENGTH * LANES + i] = rays[7, j] - t0
    lanes[HELD * LANES + i] = lanes[TRIES * LANES + i] = ZERO
    lanes[STATE * LANES + i] = LIVE


@inlined
def place_lanes(lanes, point, n):
    """Enclose the segments of n lanes."""
    for axis in range(3):
        row = point[axis]
        o, d = (OX + axis) * LANES, (DX + axis) * LANES
        for i in range(n):
            a, b = lanes[A * LANES + i], lanes[B * LANES + i]
            place(row, i, lanes[o + i], lanes[d + i], HALF * (a + b), HALF * (b - a))


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
        outside = (where == F(NOWHERE)) | (c0 - m > e)
        good = e + abs(c0) + m < LARGE
        whole = good & (where == F(WHOLE))
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
        now = start + HALF * narrow if slow & (~hit) else now
        # What follows a rejected segment.
        after = cut_to if b == cut_from else b
        then = after + TWO * width
        then = then if then < end else end
        then = cut_from if (cut_from > after) & (cut_from < then) else then
        done = after >= end
        state = F(HIT) if hit | inside else (F(UNDECIDED) if stuck else LIVE)
        rejected = (F(HIT) if lanes[HELD * LANES + i] > ZERO else F(MISS)) if done else LIVE
        lanes[STATE * LANES + i] = rejected if outside else state
        lanes[A * LANES + i] = after if outside else (a if inside else start)
        met = b if anywhere & (c1 < ZERO) else a
        lanes[B * LANES + i] = then if outside else (met if inside else now)
        lanes[ROOT * LANES + i] = x
        lanes[SLOPE * LANES + i] = c1 / half
        lanes[END * LANES + i] = end if outside else last_end
        lanes[CUT_FROM * LANES + i] = cut_from if outside else from_now
        lanes[CUT_TO * LANES + i] = cut_to if outside else to_now
        lanes[HELD * LANES + i] = lanes[HELD * LANES + i] if outside else (ONE if held else ZERO)
        lanes[TRIES * LANES + i] += ONE


@lean(
    f"int64({PACKET}, float32[::1], float32[::1], int64[::1], float64[:, ::1], float32[:, ::1], int64[::1], int64,"
    " boolean, float64[:, ::1])",
    inner=True,
)
def hunt(code, constants, parts, registers, point, status, lanes, ids, rays, asked, queue, count, anywhere, found):
    """Settle the first ``count`` rays of the ``queue``; returns the enclosures spent.

    ``rays`` (RAY, n), ``asked`` (3, n) and ``found`` (5, n) are by ray. A HIT has a bracket low..high with all before
    it outside and the inside at its end; with ``anywhere`` (shadow rays) high is any place inside. MISS: all outside.
    """
    last = registers[code.shape[0] - 1]
    upcoming = 0
    live = 0
    spent = 0
    while True:
        while live < LANES and upcoming < count:
            j = queue[upcoming]
            load(lanes, live, rays, j, asked)
            ids[live] = j
            live += 1
            upcoming += 1
        if live == 0:
            return spent
        n = (live + 15) // 16 * 16
        place_lanes(lanes, point, n)
        enclose(code, constants, parts, registers, point, status, n)
        advance(lanes, last, status, n, anywhere)
        spent += live
        i = 0
        while i < live:
            state = lanes[STATE * LANES + i]
            if state == LIVE:
                i += 1
                continue
            j = ids[i]
            found[FOUND_STATUS, j] = state
            found[FOUND_LOW, j] = lanes[A * LANES + i]
            found[FOUND_HIGH, j] = lanes[B * LANES + i]
            found[FOUND_ROOT, j] = lanes[ROOT * LANES + i]
            found[FOUND_SLOPE, j] = lanes[SLOPE * LANES + i]
            live -= 1
            for row in range(ROWS):
                lanes[row * LANES + i] = lanes[row * LANES + live]
            ids[i] = ids[live]
