# mypy: ignore-errors
"""First roots of polynomials along a bundle of rays: what ``hunt_kernels`` does, from exact coefficients.

The rays that have a length are packed; slabs of the beam around them all that an enclosure of the tape proves to be
outside are left out at both ends.
"""

import numpy as np
from numba import types

from sceneql.compiling.late import late
from sceneql.field.affine_kernels import GROW, HALF, PAD, ZERO, F
from sceneql.field.extent_kernels import extent
from sceneql.field.packet_kernels import C1, ENCLOSE, LANES, E, place
from sceneql.field.polynomial_kernels import ABREAST
from sceneql.field.polynomial_steps_kernels import (
    CHANGE,
    END,
    HALF_WAY,
    LIVE,
    MIDDLE,
    RAY,
    ROOT,
    STATE,
    A,
    B,
    polish,
)
from sceneql.field.ray_rows import FOUND_HIGH, FOUND_LOW, FOUND_ROOT, FOUND_STATUS, SETTLED
from sceneql.field.tape_ops import HIT, MISS, UNDECIDED
from sceneql.kernels import inlined

SHORTEST = -0.98
"""Where the first segment ends at least."""
T0, T1, SPOT = 6, 7, 8
"""Rows of packed rays, of which the first are those of rays; the last is working memory."""
_f, _i, _ids, _wide = types.float64, types.int64, types.int64[::1], types.float64[:, ::1]
POLYNOMIAL_ROOTS = types.Tuple((_i, _i, _f, _f))(
    *ENCLOSE.args[:-1], _wide, _i, types.boolean, _wide, _ids, _ids, _ids, _wide, _f[::1]
)
polynomial_roots = late("sceneql.field.polynomial_bundle_kernels:polynomial_roots", POLYNOMIAL_ROOTS)


@inlined
def pack(rays, count, ids, wide):
    """Put the rays that have a length into ``wide``, but for where all have one; how many there are."""
    n = 0
    t0, t1 = rays[T0], rays[T1]
    for j in range(count):
        n += 1 if t0[j] < t1[j] else 0
    if n == count:
        for j in range(count):
            ids[j] = j
        return n
    n = 0
    for j in range(count):
        ids[n] = j
        n += 1 if t0[j] < t1[j] else 0
    for row in range(8):
        source, target = rays[row], wide[row]
        for i in range(n):
            target[i] = source[np.uint64(ids[i])]
    return n


@inlined
def place_beam(wide, n, begin, end, axis, spot, point):
    """Enclose a coordinate in the slabs of the beam around n rays; (bound of it, of its error in units of that).

    ``spot`` (n,) is working memory.
    """
    o, d = wide[axis], wide[3 + axis]
    for i in range(n):
        spot[i] = o[i] + begin * d[i]
    low, high = extent(spot, n)
    d_low, d_high = extent(d, n)
    way, way_off = 0.5 * (d_low + d_high), 0.5 * (d_high - d_low)
    depth = F((end - begin) / LANES)
    off = F(0.5 * (high - low) + (end - begin) * way_off) * GROW
    middle, along = F(0.5 * (low + high)), F(way)
    for k in range(LANES):
        place(point, k, middle, along, (F(k) + HALF) * depth, HALF * depth * GROW)
    for k in range(LANES):
        point[E + k] += off
    speed = max(abs(d_low), abs(d_high))
    size = max(abs(low), abs(high)) + (end - begin) * speed
    return size, 8.0 + 8.0 * max(abs(begin), abs(end)) * speed / max(size, 1e-300)


@inlined
def negative_slabs(row):
    """(first, end) of the longest run of slabs in which what a register encloses is negative."""
    first, end, begun = 0, 0, 0
    for k in range(LANES):
        m = abs(row[C1 + k])
        e = row[E + k] * GROW + PAD * (abs(row[k]) + m)
        if not row[k] + m + e < ZERO:
            begun = k + 1
        elif k + 1 - begun > end - first:
            first, end = begun, k + 1
    return first, end


@inlined
def take(wide, first, width, n, begin, run, end, lanes):
    """Put packed rays into lanes; those beyond ``width``, or nowhere within begin..end, have nothing to look for."""
    t0, t1 = wide[T0, first:], wide[T1, first:]
    for i in range(n):
        low = t0[i] if t0[i] > begin else begin
        high = t1[i] if t1[i] < end else end
        some = (low < high) & (i < width)
        middle = 0.5 * (low + high)
        half = 0.5 * (high - low) if some else 1.0
        stop = (run - middle) / half
        stop = stop if stop > SHORTEST else SHORTEST
        lanes[MIDDLE + i] = middle
        lanes[HALF_WAY + i] = half
        lanes[RAY + i] = float(first + i)
        lanes[A + i] = -1.0
        lanes[B + i] = stop if stop < 1.0 else 1.0
        lanes[END + i] = 1.0
        lanes[STATE + i] = LIVE if some else float(MISS)


@inlined
def count_lanes(lanes, n, outcome):
    """How many of n lanes have an outcome."""
    number = 0
    for i in range(n):
        number += 1 if lanes[STATE + i] == outcome else 0
    return number


@inlined
def note(lanes, ids, ended, count, rays, anywhere, found, queue, queued):
    """Note the outcomes of ``ended`` lanes and where they are, and queue their rays; how many are in the queue then."""
    begins, ends = rays[T0], rays[T1]
    outcomes, lows, highs, roots = found[FOUND_STATUS], found[FOUND_LOW], found[FOUND_HIGH], found[FOUND_ROOT]
    for k in range(count):
        i = np.uint64(ended[np.uint64(k)])
        ray = ids[np.uint64(lanes[RAY + i])]
        j = np.uint64(ray)
        t0, t1 = begins[j], ends[j]
        outcome = lanes[STATE + i]
        middle, half = lanes[MIDDLE + i] - t0, lanes[HALF_WAY + i]
        root = middle + half * lanes[ROOT + i]
        safe = (half * lanes[CHANGE + i] <= SETTLED * (t1 - t0)) & (t0 + root < t1)
        lost = (outcome == HIT) & (not anywhere) & (not safe)
        outcomes[j] = float(UNDECIDED) if lost else outcome
        lows[j] = middle + half * lanes[A + i]
        highs[j] = middle + half * lanes[B + i]
        roots[j] = root
        queue[np.uint64(queued + k)] = ray
    return queued + count


@inlined
def settle_lanes(lanes, rows, degree, ids, kept, width, live, rays, anywhere, found, queue, queued):
    """Note what became of lanes, and put those that are ``live`` together; how many rays are in the queue.

    ``kept`` is working memory. A ray whose lane misses is a MISS already.
    """
    if live + count_lanes(lanes, width, MISS) < width:
        if not anywhere:
            polish(lanes, degree, (width + 15) // 16 * 16)
        settled = 0
        for i in range(width):
            outcome = lanes[STATE + i]
            kept[np.uint64(settled)] = i
            settled += 1 if (outcome != LIVE) & (outcome != MISS) else 0
        queued = note(lanes, ids, kept, settled, rays, anywhere, found, queue, queued)
    if 0 < live < width:
        n = 0
        for i in range(width):
            kept[np.uint64(n)] = i
            n += 1 if lanes[STATE + i] == LIVE else 0
        for start in range(A, rows, ABREAST):
            row = lanes[start:]
            for i in range(live):
                row[i] = row[np.uint64(kept[i])]
        for i in range(live, width):
            lanes[STATE + i] = float(MISS)
    return queued
