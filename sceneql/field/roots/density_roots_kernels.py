# mypy: ignore-errors
"""First roots along a bundle of rays of fields c - D and max(c - D, g), D the density of points with Wyvill's kernel.

The parts that reach into the bundle are collected once; packets of LANES rays search them from front to back, in slices
of their beam, so that parts behind the first root are seldom read. Before the first root of c - D the field is positive
whatever g is; at the root g is evaluated.
"""

import numpy as np
from numba import types

from sceneql.compiled.kernels import inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.field.packets.ray_rows import FOUND_HIGH, FOUND_LOW, FOUND_ROOT, FOUND_STATUS
from sceneql.field.roots import beam_kernels as beams
from sceneql.field.roots import density_march_kernels as march
from sceneql.field.roots import density_slice_kernels as slices
from sceneql.field.roots.density_march_kernels import F
from sceneql.field.roots.density_slice_kernels import CLEARLY, INFINITE
from sceneql.field.tape.tape_ops import HIT, MISS, UNDECIDED

LOST, KEPT, ENDED = march.LANES, 2 * march.LANES, 3 * march.LANES
"""Offsets in ``live`` (4 LANES,), after the lanes' rays, of the rays left for the next slice, and of the lanes that go
on or have an outcome."""
MOST_PARTS = 512
"""Rows of ``table``; if more parts reach into a slice, its rays are left to the certified routine."""
ROW_OF, THRESHOLD, OTHER = range(3)
"""Entries of a plan: row of the density D, -1 for a field of another form; index of c; row of g, -1 without one."""
BENT = 6.0
"""R^2 times the largest second derivative of a density of weight 1."""
STEEPEST = 1.72
"""R times the largest slope of a density of weight 1, a little more than 96/(25 sqrt(5))."""
NEARLY = 1.1
"""Only densities below so many times the threshold may be rounded to the other side of it."""
SURELY = 1.0 - 1.0e-9
"""Densities below this part of the threshold are below it whatever the rounding in float64."""
UNIT = 1.2e-7
"""Two half units in the last place."""
_ids, _wide = types.int64[::1], types.float64[:, ::1]
DENSITY_ROOTS = types.UniTuple(types.int64, 3)(
    types.int32[:, ::1], types.float64[::1], _wide, _ids, _wide, types.int64, types.int64, types.boolean, _wide, _ids,
    _ids, _wide, types.float32[:, ::1], types.float32[::1], types.int32[:, ::1], _wide, types.float32[:, ::1]
)  # fmt: skip
density_roots = lazy("sceneql.field.packets.density_bundle_kernels:density_roots", DENSITY_ROOTS)


@inlined
def rounding(rows, bulk, bend, stiff, stiffer, negative, reach, threshold):
    """Bounds of rounding errors where places are off by UNIT reach, and 2 UNIT reach.

    They are of the density near c at the lane's begin, of its growth per meter, and of the slope. ``bulk``, ``stiff``
    and ``stiffer`` are the sums of |w|, |w|/R and |w|/R^2, ``bend`` is the largest 1/R. Of positive parts sum w u^2 <=
    (sum w u^3)^(2/3) (sum w)^(1/3) by Hoelder's inequality, with |du/dt| <= 2/R; densities above NEARLY c are not
    rounded below c. A part within reach at x has |T| <= x + R, so that u is off by UNIT (x/R + 1) for T and by 7 half
    units for the steps to u; a mirrored place is rounded once more.
    """
    off = UNIT * reach
    level = bulk if negative else NEARLY * abs(threshold)
    turns = 2.0 if negative else 1.0
    unit = 3.0 * UNIT * (level * level * bulk) ** (1.0 / 3.0)
    return (
        F(unit * (3.0 + 2.0 * turns) + UNIT * (0.5 * rows + 4.0) * level),
        F(unit * turns * bend),
        F(STEEPEST * (30.0 * off * stiffer + (rows + 40) * UNIT * stiff)),
        F(2.0 * off),
    )


@inlined
def note(room, state, count, live, rays, found, queue, met, doubted):
    """Write the outcomes of the lanes in ``live`` from ENDED on, and queue their rays: hits at the front of the queue,
    undecided rays at its end. Returns the numbers of both."""
    bases, inverse = room[slices.SPOT + slices.BASE], room[beams.INVERSE_SPEED]
    outcomes, lows, highs, roots = found[FOUND_STATUS], found[FOUND_LOW], found[FOUND_HIGH], found[FOUND_ROOT]
    last = len(queue) - 1
    for k in range(count):
        i = np.uint64(live[np.uint64(ENDED + k)])
        j = np.uint64(live[i])
        ray = np.uint64(rays[j])
        base, unit = bases[i], inverse[j]
        low, root = state[march.A + i], state[march.ROOT + i]
        root = root if root > low else low
        outcome = state[march.STATE + i]
        outcomes[ray] = outcome
        lows[ray] = (base + low) * unit
        highs[ray] = (base + state[march.B + i]) * unit
        roots[ray] = (base + root) * unit
        hit = outcome == F(HIT)
        queue[met if hit else last - doubted] = rays[j]
        met += 1 if hit else 0
        doubted += 0 if hit else 1
    return met, doubted


@inlined
def move_lanes(row, first, live, n):
    """Compact one quantity, at ``first`` in a row, to the n lanes listed in ``live`` from KEPT on."""
    for i in range(n):
        row[first + i] = row[np.uint64(first + live[KEPT + i])]


@inlined
def settle_lanes(table, rows, state, room, live, width, looking, left, later, rays, found, queue, met, doubted):
    """Write the outcomes of lanes, and compact those still ``looking``: (rays left for the next slice, hits,
    undecided). Unless there is a ``later`` slice no ray is left for it."""
    settled = 0
    for i in range(width):
        outcome = state[march.STATE + i]
        live[np.uint64(ENDED + settled)] = i
        settled += 0 if (outcome == march.LIVE) | (outcome == F(MISS)) else 1
    met, doubted = note(room, state, settled, live, rays, found, queue, met, doubted)
    if later:
        for i in range(width):
            live[np.uint64(LOST + left)] = live[i]
            left += 1 if state[march.STATE + i] == F(MISS) else 0
    if 0 < looking < width:
        n = 0
        for i in range(width):
            live[np.uint64(KEPT + n)] = i
            n += 1 if state[march.STATE + i] == march.LIVE else 0
        for k in range(rows):
            for part in range(0, march.WEIGHT, march.LANES):
                move_lanes(table[k], part, live, n)
        for row in range(march.A, march.AT_A, march.LANES):
            move_lanes(state, row, live, n)
        move_lanes(room[slices.SPOT + slices.BASE], 0, live, n)
        move_lanes(live, 0, live, n)
        for i in range(width):
            state[march.STATE + i] = march.LIVE if i < n else F(MISS)
    return left, met, doubted


@inlined
def lanes_for(n):
    """Lanes in which n rays are searched: whole vectors of them, but of a single ray one."""
    return n if n == 1 else (n + march.VECTOR - 1) // march.VECTOR * march.VECTOR


@inlined
def search_slice(
    table, kept, state, room, live, n, looking, later, threshold, off, drift, off_slope, blur, bend, anywhere,
    rays, found, queue, met, doubted,
):  # fmt: skip
    """March all lanes, ``looking`` of them without an outcome: (rays without an outcome at the end of the slice, put
    first into ``live``, segments, hits, undecided)."""
    spent = 0
    left = 0
    width = n
    while width > 0:
        whole = lanes_for(width)
        # Fewer lanes than a vector holds cost as much as a whole vector.
        enough = width // 4 if width > march.VECTOR else 0
        while looking > enough:
            march.sum_up(table, kept, state, whole, blur)
            spent += looking
            looking = march.advance(state, whole, threshold, off, drift, off_slope, bend, anywhere)
        if not anywhere and looking < width:
            march.refine(table, kept, state, whole, threshold)
        left, met, doubted = settle_lanes(
            table, kept, state, room, live, width, looking, left, later, rays, found, queue, met, doubted
        )
        width = looking
    for i in range(left):
        live[i] = live[LOST + i]
    return left, spent, met, doubted


@inlined
def leave_undecided(room, live, n, rays, found, queue, doubted):
    """Leave all lanes to the certified routine, from the start of their slice; returns the number of undecided rays."""
    last = len(queue) - 1 - doubted
    for i in range(n):
        j = live[i]
        found[FOUND_STATUS, rays[j]] = UNDECIDED
        found[FOUND_LOW, rays[j]] = room[slices.SPOT + slices.BASE, i] * room[beams.INVERSE_SPEED, j]
        queue[last - i] = rays[j]
    return doubted + n


@inlined
def densest(spans, m, start, end):
    """An upper bound of the density in a slice of a beam."""
    most = 0.0
    for i in range(m):
        most += spans[2, i] if spans[0, i] < end and spans[1, i] > start else 0.0
    return most


@inlined
def search_packet(
    room, first, stop, near, kept, threshold, anywhere, table, state, live, order, rays, own, lowest, found, queue,
    met, doubted,
):  # fmt: skip
    """First roots of rays first..stop-1 of a gathered bundle: (segments examined, hits, undecided), see ``note``.

    ``own`` is the beam around them, ``lowest`` the least cosine between its axis and a ray.
    """
    spans = room[slices.SPANS :]
    m = beams.list_parts(near, kept, own, spans, order)
    n = stop - first
    for i in range(n):
        live[i] = first + i
    spent = 0
    fresh = True
    begin = own[beams.LOW]
    leveled, level = 0.0, INFINITE
    while n > 0:
        start, end = beams.next_slice(spans, m, begin)
        if start == np.inf:
            return spent, met, doubted
        if lowest <= 0.5:
            end = np.inf
        if densest(spans, m, start, end) < threshold * SURELY:
            if end == np.inf:
                return spent, met, doubted
            begin = end
            continue
        whole = lanes_for(n)
        slices.place_lanes(room, live, state, n, whole, fresh, start, end, lowest)
        fresh = False
        rows = 0
        bulk = bend = stiff = stiffer = 0.0
        negative = False
        for i in range(m):
            if spans[0, i] < end and spans[1, i] > start:
                part = near[order[i]]
                if part[7] != leveled:
                    leveled = part[7]
                    level = F((CLEARLY * threshold / leveled) ** (1.0 / 3.0)) if leveled > threshold > 0.0 else INFINITE
                if slices.set_part(part, room, table[rows], state, whole, level) == 0:
                    continue
                rows += 1
                weight, steep = abs(part[7]), 1.0 / part[6]
                negative = negative or part[7] < 0.0
                bulk += weight
                bend = max(bend, steep)
                stiff += weight * steep
                stiffer += weight * steep * steep
                if rows == table.shape[0]:
                    return spent, met, leave_undecided(room, live, n, rays, found, queue, doubted)
        reach = min(end, own[beams.HIGH]) - start + 2.0 * own[beams.RADIUS_OF]
        off, drift, off_slope, blur = rounding(rows, bulk, bend, stiff, stiffer, negative, reach, threshold)
        if slices.reach_threshold(state, whole, F(threshold), off, drift):
            slices.tighten(table, rows, state, whole, F(threshold), off, drift)
        looking = slices.start_lanes(state, whole, F(threshold), off, drift, negative, anywhere)
        n, more, met, doubted = search_slice(
            table, rows, state, room, live, n, looking, end < np.inf, F(threshold), off, drift,
            off_slope, blur, F(BENT * stiffer), anywhere, rays, found, queue, met, doubted,
        )  # fmt: skip
        spent += more
        if end == np.inf:
            return spent, met, doubted
        begin = end
    return spent, met, doubted
