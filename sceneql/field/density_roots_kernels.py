# mypy: ignore-errors
"""First roots along a bundle of rays of fields c - D and max(c - D, g), D the density of points with Wyvill's kernel.

The parts that reach into the bundle are found once; packets of LANES rays look at them from front to back, a slice of
their beam at a time, so that what stands behind the first root is seldom looked at. Before the first root of c - D the
field is outside whatever g is; at the root its value tells.
"""

import numpy as np

from sceneql.field.beam_kernels import (
    BEAM,
    BEHIND,
    DX,
    FAR,
    HIGH,
    INVERSE_SPEED,
    LOW,
    PX,
    RADIUS_OF,
    STRETCH,
    WIDE,
    beam_around,
    beam_within,
    gather,
    keep_reaching,
    keep_reaching_skeleton,
    list_parts,
    next_slice,
)
from sceneql.field.density_march_kernels import (
    AT_A,
    AT_B,
    END,
    FINE,
    INVERSE,
    LANES,
    LIVE,
    ROOT,
    STATE,
    TRIES,
    WEIGHT,
    ZERO,
    A,
    B,
    F,
    Q,
    T,
    advance,
    sum_up,
)
from sceneql.field.density_polish_kernels import polish
from sceneql.field.hunt_kernels import FOUND_HIGH, FOUND_LOW, FOUND_ROOT, FOUND_STATUS
from sceneql.field.tape_ops import DENSITY, HIT, MISS, UNDECIDED
from sceneql.kernels import inlined

MOST_PARTS = 512
"""Rows of ``table``; where more parts reach into a slice, its rays are left to the certified routine."""
SPOT, SPANS, BEAM_ROW, OWN_ROW, SPARE, ROOM = WIDE, WIDE + 7, WIDE + 9, WIDE + 10, WIDE + 11, WIDE + 17
BASE = 6
"""Rows of ``room`` (ROOM, n): rays, lanes (place, direction, where the slice begins on the ray), where parts are
entered and left along the axis of a beam, the bundle's beam and a packet's, and working memory of theirs."""
ROW_OF, THRESHOLD, OTHER = range(3)
"""Of a plan: the row of the density, -1 where a field has another form; of c; of g, -1 where there is none."""
NARROW, HAIR = F(2.0e-5), F(1.0e-6)
"""Width of a bracket, and what is searched beyond the parts, relative to the ray's piece."""
INFINITE = F(np.inf)
GOLDEN = F(0.4472136)
"""1/sqrt(5)."""
STEEPEST = 1.72
"""R times the largest slope of a density of weight 1, a little more than 96/(25 sqrt(5))."""
UNIT = 1.2e-7
"""Two half units in the last place."""


@inlined
def pick(source, live, n, fresh, target):
    """What lanes have of a row of the rays; ``fresh``: the lanes are rays that follow each other."""
    if fresh:
        own = source[live[0] :]
        for i in range(n):
            target[i] = own[i]
    else:
        for i in range(n):
            target[i] = source[np.uint64(live[i])]


@inlined
def place_lanes(room, live, state, n, fresh, begin, end, lowest):
    """Set the lanes' rays at the begin of a slice, and where on them it ends."""
    bases = room[SPOT + BASE]
    pick(room[FAR], live, n, fresh, room[SPARE])
    pick(room[BEHIND], live, n, fresh, room[SPARE + 1])
    pick(room[STRETCH], live, n, fresh, room[SPARE + 2])
    far, behind, stretch = room[SPARE], room[SPARE + 1], room[SPARE + 2]
    sliced = lowest > 0.5
    for i in range(n):
        stop = far[i]
        base, last = (begin - behind[i]) * stretch[i], (end - behind[i]) * stretch[i]
        base = base if base > 0.0 else 0.0
        base = base if base < stop else stop
        last = last if last > base else base
        last = last if last < stop else stop
        base = base if sliced else 0.0
        bases[i] = base
        state[END + i] = F((last if sliced else stop) - base)
        state[AT_A + i] = INFINITE
        state[AT_B + i] = -INFINITE
    for axis in range(3):
        spot, way = room[SPOT + axis], room[SPOT + 3 + axis]
        pick(room[PX + axis], live, n, fresh, spot)
        pick(room[DX + axis], live, n, fresh, way)
        for i in range(n):
            spot[i] += bases[i] * way[i]


@inlined
def set_part(part, room, row, state, n):
    """A row of the table for a part; how many lanes come into its reach. AT_A and AT_B: where they enter and leave."""
    cx, cy, cz, radius = part[0], part[1], part[2], part[6]
    inverse = 1.0 / (radius * radius)
    x, y, z = room[SPOT], room[SPOT + 1], room[SPOT + 2]
    dx, dy, dz = room[SPOT + 3], room[SPOT + 4], room[SPOT + 5]
    for i in range(n):
        wx, wy, wz = cx - x[i], cy - y[i], cz - z[i]
        t = wx * dx[i] + wy * dy[i] + wz * dz[i]
        row[i] = F(1.0 - inverse * (wx * wx + wy * wy + wz * wz - t * t))
        row[T + i] = F(t)
    reach = F(radius)
    lanes = np.int32(0)
    for i in range(n):
        p, t = row[i], row[T + i]
        half = reach * np.sqrt(p if p > ZERO else ZERO)
        row[Q + i] = t - GOLDEN * half
        near = (p > ZERO) & (t + half > ZERO) & (t - half < state[END + i])
        entry, exit = state[AT_A + i], state[AT_B + i]
        first = entry if entry < t - half else t - half
        last = exit if exit > t + half else t + half
        state[AT_A + i] = first if near else entry
        state[AT_B + i] = last if near else exit
        lanes += np.int32(1) if near else np.int32(0)
    row[WEIGHT] = F(part[7])
    row[INVERSE] = F(inverse)
    return lanes


@inlined
def rounding(rows, bulk, bend, stiff, stiffer, negative, reach, threshold):
    """How far the computed density about c, and the computed slope, may be off where places are off by UNIT reach.

    ``bulk``, ``stiff`` and ``stiffer`` are the sums of |w|, |w|/R and |w|/R^2, ``bend`` is the largest 1/R.
    Of positive parts sum w u^2 <= (sum w u^3)^(2/3) (sum w)^(1/3) by Hoelder's inequality, with |du/dt| <= 2/R.
    """
    off = UNIT * reach
    level = bulk if negative else 2.0 * abs(threshold)
    squares = (level * level * bulk) ** (1.0 / 3.0)
    return (
        F(3.0 * squares * (2.0 * bend * off + 4.0 * UNIT) + UNIT * (rows + 12) * level),
        F(STEEPEST * (30.0 * off * stiffer + (rows + 40) * UNIT * stiff)),
    )


@inlined
def start_lanes(room, state, n):
    """Begin the search in each lane, between where the parts of the slice are entered and left."""
    far = room[SPARE]
    for i in range(n):
        way = F(far[i])
        low = state[AT_A + i] - HAIR * way
        high = state[AT_B + i] + HAIR * way
        low = low if low > ZERO else ZERO
        high = high if high < state[END + i] else state[END + i]
        state[A + i] = low
        state[B + i] = high
        state[END + i] = high
        state[FINE + i] = NARROW * way
        state[TRIES + i] = ZERO
        state[STATE + i] = LIVE if low < high else F(MISS)
    for i in range(n, LANES):
        state[STATE + i] = F(MISS)


@inlined
def note(room, state, width, live, rays, found):
    """What became of lanes, and where they are so far; of the live ones it is noted again."""
    bases, inverse = room[SPOT + BASE], room[INVERSE_SPEED]
    outcomes, lows, highs, roots = found[FOUND_STATUS], found[FOUND_LOW], found[FOUND_HIGH], found[FOUND_ROOT]
    for i in range(width):
        j = np.uint64(live[i])
        ray = np.uint64(rays[j])
        base, unit = bases[i], inverse[j]
        low, root = state[A + i], state[ROOT + i]
        root = root if root > low else low
        outcomes[ray] = state[STATE + i]
        lows[ray] = (base + low) * unit
        highs[ray] = (base + state[B + i]) * unit
        roots[ray] = (base + root) * unit


@inlined
def live_lanes(state, n):
    """How many of n lanes have no outcome."""
    lanes = np.int32(0)
    for i in range(n):
        lanes += np.int32(1) if state[STATE + i] == LIVE else np.int32(0)
    return lanes


@inlined
def move_lanes(row, kept, n):
    """Put n lanes of a row, those ``kept``, together."""
    for i in range(n):
        row[i] = row[np.uint64(kept[i])]


@inlined
def settle_lanes(table, rows, state, room, live, width, left, rays, found):
    """Note the outcomes of lanes, and put those without one together; (how many, rays left for the next slice)."""
    note(room, state, width, live, rays, found)
    lost, kept = live[LANES:], live[2 * LANES :]
    n = 0
    for i in range(width):
        outcome = state[STATE + i]
        kept[np.uint64(n)] = i
        n += 1 if outcome == LIVE else 0
        lost[np.uint64(left)] = live[i]
        left += 1 if outcome == F(MISS) else 0
    if n < width:
        for k in range(rows):
            for part in (0, T, Q):
                move_lanes(table[k, part:], kept, n)
        for start in (A, B, END, TRIES, FINE):
            move_lanes(state[start:], kept, n)
        move_lanes(room[SPOT + BASE], kept, n)
        move_lanes(live, kept, n)
        for i in range(width):
            state[STATE + i] = LIVE if i < n else F(MISS)
    return n, left


@inlined
def search_slice(table, kept, state, room, live, n, threshold, off, off_slope, anywhere, rays, found):
    """March all lanes; (how many are still looking at the end of the slice, put first into ``live``, segments)."""
    spent = 0
    left = 0
    width = n
    while width > 0:
        whole = (width + 7) // 8 * 8
        looking = live_lanes(state, whole)
        while 2 * looking > width:
            sum_up(table, kept, state, whole)
            advance(state, whole, threshold, off, off_slope, anywhere)
            spent += looking
            looking = live_lanes(state, whole)
        width, left = settle_lanes(table, kept, state, room, live, width, left, rays, found)
    for i in range(left):
        live[i] = live[LANES + i]
    return left, spent


@inlined
def leave_undecided(room, live, n, rays, found):
    """Leave all lanes to the certified routine, from where their slice begins."""
    for i in range(n):
        j = live[i]
        found[FOUND_STATUS, rays[j]] = UNDECIDED
        found[FOUND_LOW, rays[j]] = room[SPOT + BASE, i] * room[INVERSE_SPEED, j]


@inlined
def search_packet(
    room, first, stop, near, kept, threshold, anywhere, table, state, live, order, rays, beam, lowest, found
):
    """Settle rays first..stop-1 of a gathered bundle; segments looked at."""
    own = room[OWN_ROW, :BEAM]
    beam_within(room, first, stop, beam, room[SPARE:], own)
    spans = room[SPANS:]
    m = list_parts(near, kept, own, spans, order)
    n = stop - first
    for i in range(n):
        live[i] = first + i
    spent = 0
    fresh = True
    begin = beam[LOW]
    while n > 0:
        start, end = next_slice(spans, m, begin)
        if start == np.inf:
            return spent
        if lowest <= 0.5:
            end = np.inf
        place_lanes(room, live, state, n, fresh, start, end, lowest)
        fresh = False
        rows = 0
        bulk = bend = stiff = stiffer = 0.0
        negative = False
        for i in range(m):
            if spans[0, i] < end and spans[1, i] > start:
                part = near[order[i]]
                if set_part(part, room, table[rows], state, n) == 0:
                    continue
                rows += 1
                weight, steep = abs(part[7]), 1.0 / part[6]
                negative = negative or part[7] < 0.0
                bulk += weight
                bend = max(bend, steep)
                stiff += weight * steep
                stiffer += weight * steep * steep
                if rows == table.shape[0]:
                    leave_undecided(room, live, n, rays, found)
                    return spent
        reach = min(end, beam[HIGH]) - start + 2.0 * own[RADIUS_OF]
        off, off_slope = rounding(rows, bulk, bend, stiff, stiffer, negative, reach, threshold)
        start_lanes(room, state, n)
        n, more = search_slice(
            table, rows, state, room, live, n, F(threshold), off, off_slope, anywhere, rays, found
        )  # fmt: skip
        spent += more
        if end == np.inf:
            return spent
        begin = end
    return spent


@inlined
def first_hits(found, ids, n, queue):
    """The rays that may be met into the ``queue``, hits first; how many."""
    outcomes = found[FOUND_STATUS]
    queued = 0
    for outcome in (HIT, UNDECIDED):
        for i in range(n):
            if outcomes[np.uint64(ids[i])] == outcome:
                queue[queued] = ids[i]
                queued += 1
    return queued


@inlined
def density_roots(
    code, constants, parts, plan, rays, count, groups, anywhere, found, queue, order, room, table, state, short, near
):  # fmt: skip
    """Settle a bundle as ``packet_roots_kernels.first_roots`` does; (segments, rays that may be met, in ``queue``).

    ``short`` becomes the tape with the parts alone that reach into the bundle, which are ``near``, as a DENSITY.
    """
    k = plan[ROW_OF]
    for row in range(code.shape[0]):
        for j in range(4):
            short[row, j] = code[row, j]
    ids = order[3 * LANES :]
    listed = ids[rays.shape[1] :]
    n = gather(rays, count, groups, room, ids)
    if n == 0:
        return 0, 0
    beam = room[BEAM_ROW, :BEAM]
    lowest = beam_around(room, 0, n, beam, room[SPARE:])
    if code[k, 0] == DENSITY:
        kept = keep_reaching(parts, code[k, 1], code[k, 2], beam, near)
    else:
        kept = keep_reaching_skeleton(parts, code[k, 1], code[k, 2], beam, near)
    short[k, 0], short[k, 1], short[k, 2] = DENSITY, 0, kept
    spent = 0
    if kept > 0:
        for first in range(0, n, LANES):
            spent += search_packet(
                room, first, min(first + LANES, n), near, kept, constants[plan[THRESHOLD]], anywhere, table, state,
                order, listed, ids, beam, lowest, found,
            )  # fmt: skip
    queued = first_hits(found, ids, n, queue)
    if not anywhere:
        hits = 0
        while hits < queued and found[FOUND_STATUS, queue[hits]] == HIT:
            hits += 1
        polish(near, kept, constants[plan[THRESHOLD]], rays, queue, hits, room, found)
    return spent, queued
