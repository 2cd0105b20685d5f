# mypy: ignore-errors
"""Beams around the columns of a bundle of rays, cut into slabs along their length; one beam a lane."""

import numpy as np

from sceneql.compiled.kernels import inlined
from sceneql.compiled.lanes_kernels import below, load, spread, store
from sceneql.field.enclose.affine_kernels import GROW, HALF, ONE, PAD, ZERO, F
from sceneql.field.packets import ray_rows
from sceneql.field.packets.packet_kernels import C1, LANES, VECTOR, E, place, placed, put, taken
from sceneql.field.tape.tape_ops import NOWHERE, WHOLE

PLACE, WAY, PLACE_OFF, WAY_OFF, BEGIN, STOP = 0, 3, 6, 9, 12, 13
BEAM = 14
"""Rows of beams: middle of the rays' places at the common begin, and of their directions; half widths of both; begin
and end."""
FROM, TO, RUN_TO, INSIDE = range(4)
"""Rows that replace these after the slabs are classified: begin and end of the search, end of its first segment, and a
place proved inside, -inf if none is known."""
OCTET = 8
"""Lanes of float64; rays and beams are processed so many at a time, so that arrays need room behind the last."""
NO_LENGTH, ASKED, ENDS_INSIDE, SETTLED = -1.0, 0.0, 1.0, 2.0
"""Row SURE of ``asked``: the ray has no length; is to be searched; is to be searched and ends inside; is decided."""


@inlined
def bundle(rays, count, groups, beams):
    """Enclose the rays of each group in a beam; returns the begin of the earliest ray, at which all beams start.

    A group whose rays have no length ends before it begins. Groups are lanes: ray j belongs to group j % groups.
    """
    t0, t1 = rays[6], rays[7]
    for j in range(count, min(count + OCTET, rays.shape[1])):
        t0[j] = t1[j] = 0.0
    for g in range(0, groups, OCTET):
        low, high = spread(np.inf), spread(-np.inf)
        for j in range(g, count, groups):
            a, b = load(t0, j), load(t1, j)
            low = below(a, b, below(a, low, a, low), low)
            high = below(a, b, below(high, b, b, high), high)
        store(beams[BEGIN], g, low)
        store(beams[STOP], g, high)
    begin = np.inf
    for g in range(groups):
        begin = min(begin, beams[BEGIN, g])
    if begin == np.inf:
        return begin
    for axis in range(3):
        place, way = rays[axis], rays[3 + axis]
        for g in range(0, groups, OCTET):
            low, high, d_low, d_high = spread(np.inf), spread(-np.inf), spread(np.inf), spread(-np.inf)
            for j in range(g, count, groups):
                a, b = load(t0, j), load(t1, j)
                d = load(way, j)
                p = load(place, j) + begin * d
                low = below(a, b, below(p, low, p, low), low)
                high = below(a, b, below(high, p, p, high), high)
                d_low = below(a, b, below(d, d_low, d, d_low), d_low)
                d_high = below(a, b, below(d_high, d, d, d_high), d_high)
            store(beams[PLACE + axis], g, low)
            store(beams[PLACE_OFF + axis], g, high)
            store(beams[WAY + axis], g, d_low)
            store(beams[WAY_OFF + axis], g, d_high)
    return begin


@inlined
def join(beams, groups, whole):
    """Make the beam around all beams, in column ``whole``; then turn bounds into middles and half widths."""
    beams[STOP, whole] = -np.inf
    beams[BEGIN, whole] = np.inf
    for g in range(groups):
        beams[BEGIN, whole] = min(beams[BEGIN, whole], beams[BEGIN, g])
        beams[STOP, whole] = max(beams[STOP, whole], beams[STOP, g])
    for axis in range(6):
        row = axis if axis < 3 else axis + WAY - 3
        low = np.inf
        high = -np.inf
        for g in range(groups):
            low = min(low, beams[row, g])
            high = max(high, beams[row + PLACE_OFF, g])
        beams[row, whole] = low
        beams[row + PLACE_OFF, whole] = high
        lows, highs = beams[row], beams[row + PLACE_OFF]
        for g in range(0, whole + 1, OCTET):
            a, b = load(lows, g), load(highs, g)
            store(lows, g, 0.5 * (a + b))
            store(highs, g, 0.5 * (b - a))


@inlined
def place_slabs(beams, g, base, begin, end, point):
    """Enclose LANES slabs, from begin to end, of a beam whose places are given at ``base``."""
    depth = F((end - begin) / LANES)
    late = begin - base
    for axis in range(3):
        row = point[axis]
        d = F(beams[WAY + axis, g])
        o = F(beams[PLACE + axis, g] + late * beams[WAY + axis, g])
        off = F(beams[PLACE_OFF + axis, g] + (end - base) * beams[WAY_OFF + axis, g]) * GROW
        for k in range(LANES):
            place(row, k, o, d, (F(k) + HALF) * depth, HALF * depth * GROW)
        for k in range(LANES):
            row[E + k] += off


@inlined
def cut_beams(beams, groups, begin, end):
    """Clip beams to begin..end; beams outside get no length."""
    for g in range(groups):
        low, high = max(beams[BEGIN, g], begin), min(beams[STOP, g], end)
        beams[BEGIN, g] = low if low < high else begin
        beams[STOP, g] = high if low < high else begin


@inlined
def single_beams(beams, first, base, slabs, singles):
    """Write middles, directions, half widths (3 rows each) and slab depths of VECTOR beams to ``singles``, rounded."""
    begins, stops = beams[BEGIN, first:], beams[STOP, first:]
    for i in range(0, VECTOR, OCTET):
        a, b = load(begins, i), load(stops, i)
        for axis in range(3):
            d = load(beams[WAY + axis, first:], i)
            store(singles, axis * VECTOR + i, load(beams[PLACE + axis, first:], i) + (a - base) * d)
            store(singles, (3 + axis) * VECTOR + i, d)
            off = load(beams[PLACE_OFF + axis, first:], i) + (b - base) * load(beams[WAY_OFF + axis, first:], i)
            store(singles, (6 + axis) * VECTOR + i, off)
        store(singles, 9 * VECTOR + i, (b - a) * (1.0 / slabs))


@inlined
def place_beams(singles, begun, point):
    """Enclose slabs of VECTOR beams, as many as there are lanes, from slab ``begun`` on."""
    depth = load(singles, 9 * VECTOR)
    half = HALF * GROW * depth
    for axis in range(3):
        o, d = load(singles, axis * VECTOR), load(singles, (3 + axis) * VECTOR)
        off = GROW * load(singles, (6 + axis) * VECTOR)
        for k in range(LANES // VECTOR):
            c0, c1, e = placed(o, d, (F(begun + k) + HALF) * depth, half)
            put(point[axis], k * VECTOR, c0, c1, e + off)


@inlined
def left_of_beams(last, status, begun, first, final, deep):
    """Update (first, last, first inside) of the slabs of VECTOR beams that are not outside, by the slabs from ``begun``
    on, just enclosed in lanes."""
    for k in range(LANES // VECTOR):
        c0, c1, e = taken(last, k * VECTOR)
        where = load(status, k * VECTOR)
        m = abs(c1)
        e = e * GROW + PAD * (abs(c0) + m)
        number = F(begun + k)
        off = below(e, c0 - m, ONE, below(F(NOWHERE) - HALF, where, ONE, ZERO))
        first = below(off, HALF, below(number, first, number, first), first)
        final = below(off, HALF, number, final)
        inside = below(c0 + m + e, ZERO, below(where, F(WHOLE) + HALF, number, -ONE), -ONE)
        deep = below(deep, ZERO, inside, deep)
    return first, final, deep


@inlined
def note_beams(beams, at, slabs, first, final, deep, singles):
    """Write where VECTOR beams from ``at`` on are to be searched: rows FROM, TO, RUN_TO and INSIDE."""
    store(singles, 0, first)
    store(singles, VECTOR, final)
    store(singles, 2 * VECTOR, deep)
    for i in range(VECTOR):
        begin, depth = beams[BEGIN, at + i], (beams[STOP, at + i] - beams[BEGIN, at + i]) / slabs
        one, two, three = float(singles[i]), float(singles[VECTOR + i]), float(singles[2 * VECTOR + i])
        hair = 1e-6 * depth
        beams[FROM, at + i] = begin + one * depth - hair if one < slabs else np.inf
        beams[TO, at + i] = begin + (two + 1.0) * depth + hair
        beams[RUN_TO, at + i] = begin + (one + 1.0) * depth
        beams[INSIDE, at + i] = begin + (three + 0.5) * depth if three >= 0.0 else -np.inf


@inlined
def ask(rays, count, groups, beams, anywhere, safe, unsafe, asked):
    """Write the search interval of each ray to ``asked``; in safe..unsafe no clip cuts the solid.

    The search ends where the beam is inside, if the ray passes there.
    """
    t0, t1 = rays[6], rays[7]
    nears, fars, runs, states = asked[ray_rows.NEAR], asked[ray_rows.FAR], asked[ray_rows.RUN], asked[ray_rows.SURE]
    # Backwards: lanes beyond the last group write to rays of the first ones, in the next row, which come after.
    for g in range((groups - 1) // OCTET * OCTET, -1, -OCTET):
        begin, end = load(beams[FROM], g), load(beams[TO], g)
        run, inside = load(beams[RUN_TO], g), load(beams[INSIDE], g)
        known = below(safe, inside, below(inside, unsafe, SETTLED, ENDS_INSIDE), ENDS_INSIDE)
        known = known if anywhere else spread(ENDS_INSIDE)
        for j in range(g, count, groups):
            a, b = load(t0, j), load(t1, j)
            low = begin - a
            low = below(low, 0.0, 0.0, low)
            high = below(end, b, end, b) - a
            some = below(a, b, below(low, high, ASKED, NO_LENGTH), NO_LENGTH)
            low = low * (1.0 - 2e-7)
            high = high * (1.0 + 2e-7)
            state = below(a + low, inside, below(inside, b, known, ASKED), ASKED)
            high = below(ASKED, state, inside - a, high)
            least = low + 0.01 * (high - low)
            first = run - a
            first = below(first, least, least, first)
            store(nears, j, low)
            store(fars, j, high)
            store(runs, j, below(first, high, first, high))
            store(states, j, below(some, ASKED, some, state))


@inlined
def ask_places(rays, count, asked):
    """Write begins, directions and lengths of rays to ``asked``."""
    t0, t1 = rays[6], rays[7]
    lengths = asked[ray_rows.LONG]
    for j in range(count):
        lengths[j] = t1[j] - t0[j]
    for axis in range(3):
        o, d, places, ways = rays[axis], rays[3 + axis], asked[ray_rows.START + axis], asked[ray_rows.WAY_OF + axis]
        for j in range(count):
            places[j] = o[j] + t0[j] * d[j]
        for j in range(count):
            ways[j] = d[j]


@inlined
def left_of_slabs(last, status, lane, slabs):
    """(first, last, end of the first run) of the slabs that are not proved outside; first = slabs: none."""
    first = slabs
    final = -1
    run = slabs
    for k in range(slabs):
        i = lane + k
        m = abs(last[C1 + i])
        e = last[E + i] * GROW + PAD * (abs(last[i]) + m)
        if status[i] == F(NOWHERE) or last[i] - m > e:
            if first < slabs and run == slabs:
                run = k
            continue
        first = min(first, k)
        final = k
    return first, final, run


@inlined
def first_inside(last, status, lane, slabs):
    """The first of the slabs that is proved inside; -1: none."""
    for k in range(slabs):
        i = lane + k
        m = abs(last[C1 + i])
        e = last[E + i] * GROW + PAD * (abs(last[i]) + m)
        if status[i] == F(WHOLE) and last[i] + m + e < ZERO:
            return k
    return -1
