# mypy: ignore-errors
"""First roots of polynomials along a bundle of rays: as ``search_lanes_kernels``, from exact coefficients.

The rays that have a length are packed, and processed together in lanes.
"""

import numpy as np
from numba import types

from sceneql.compiled.arithmetic_kernels import bits, from_bits
from sceneql.compiled.kernels import inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.field.packets.ray_rows import FOUND_HIGH, FOUND_LOW, FOUND_ROOT, FOUND_STATUS, SETTLED
from sceneql.field.roots import polynomial_steps_kernels as steps
from sceneql.field.roots.polynomial_kernels import ABREAST
from sceneql.field.tape.tape_ops import HIT, MISS, UNDECIDED

T0, T1 = 6, 7
"""Rows of packed rays, as of rays: begin and end."""
_f, _i, _ids, _wide = types.float64, types.int64, types.int64[::1], types.float64[:, ::1]
POLYNOMIAL_ROOTS = types.UniTuple(_i, 2)(
    types.int32[:, ::1], _f[::1], _wide, _i, types.boolean, _wide, _ids, _ids, _ids, _wide, _f[::1]
)
polynomial_roots = lazy("sceneql.field.packets.polynomial_bundle_kernels:polynomial_roots", POLYNOMIAL_ROOTS)


@inlined
def pack(rays, count, ids, wide):
    """Copy the rays that have a length into ``wide``, unless all have one; returns their number."""
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
def reach(wide, n, axis):
    """(bound of a coordinate on n rays, bound of its error in units of that)."""
    o, d, t0, t1 = wide[axis], wide[3 + axis], wide[T0], wide[T1]
    most, way = np.int64(0), np.int64(0)
    for i in range(n):
        # Nonnegative floats are ordered like their bits; loops over integers vectorize.
        near, far = bits(abs(o[i] + t0[i] * d[i])), bits(abs(o[i] + t1[i] * d[i]))
        near = near if near > far else far
        most = near if near > most else most
        first, last = bits(abs(t0[i] * d[i])), bits(abs(t1[i] * d[i]))
        first = first if first > last else last
        way = first if first > way else way
    size = from_bits(most)
    return size, 8.0 + 8.0 * from_bits(way) / max(size, 1e-300)


@inlined
def take(wide, first, width, n, lanes):
    """Load packed rays into lanes; lanes beyond ``width`` are MISSes."""
    t0, t1 = wide[T0, first:], wide[T1, first:]
    for i in range(n):
        some = i < width
        lanes[steps.MIDDLE + i] = 0.5 * (t0[i] + t1[i])
        lanes[steps.HALF_WAY + i] = 0.5 * (t1[i] - t0[i]) if some else 1.0
        lanes[steps.RAY + i] = float(first + i)
        lanes[steps.A + i] = -1.0
        lanes[steps.B + i] = 1.0
        lanes[steps.END + i] = 1.0
        lanes[steps.STATE + i] = steps.LIVE if some else float(MISS)


@inlined
def count_lanes(lanes, n, outcome):
    """Number of lanes, of the first n, with an outcome."""
    number = 0
    for i in range(n):
        number += 1 if lanes[steps.STATE + i] == outcome else 0
    return number


@inlined
def note(lanes, ids, ended, count, rays, anywhere, found, queue, queued):
    """Write the outcomes and brackets of ``ended`` lanes, and queue their rays; returns the length of the queue."""
    begins, ends = rays[T0], rays[T1]
    outcomes, lows, highs, roots = found[FOUND_STATUS], found[FOUND_LOW], found[FOUND_HIGH], found[FOUND_ROOT]
    for k in range(count):
        i = np.uint64(ended[np.uint64(k)])
        ray = ids[np.uint64(lanes[steps.RAY + i])]
        j = np.uint64(ray)
        t0, t1 = begins[j], ends[j]
        outcome = lanes[steps.STATE + i]
        middle, half = lanes[steps.MIDDLE + i] - t0, lanes[steps.HALF_WAY + i]
        root = middle + half * lanes[steps.ROOT + i]
        safe = (half * lanes[steps.CHANGE + i] <= SETTLED * (t1 - t0)) & (t0 + root < t1)
        lost = (outcome == HIT) & (not anywhere) & (not safe)
        outcomes[j] = float(UNDECIDED) if lost else outcome
        lows[j] = middle + half * lanes[steps.A + i]
        highs[j] = middle + half * lanes[steps.B + i]
        roots[j] = root
        queue[np.uint64(queued + k)] = ray
    return queued + count


@inlined
def settle_lanes(lanes, rows, degree, ids, kept, width, live, rays, anywhere, found, queue, queued):
    """Write the outcomes of lanes, and compact the ``live`` ones; returns the length of the queue.

    ``kept`` is working memory. Rays are MISSes from the start, so a lane that misses is not written.
    """
    if live + count_lanes(lanes, width, MISS) < width:
        if not anywhere:
            steps.polish(lanes, degree, (width + 15) // 16 * 16)
        settled = 0
        for i in range(width):
            outcome = lanes[steps.STATE + i]
            kept[np.uint64(settled)] = i
            settled += 1 if (outcome != steps.LIVE) & (outcome != MISS) else 0
        queued = note(lanes, ids, kept, settled, rays, anywhere, found, queue, queued)
    if 0 < live < width:
        n = 0
        for i in range(width):
            kept[np.uint64(n)] = i
            n += 1 if lanes[steps.STATE + i] == steps.LIVE else 0
        for start in range(steps.A, rows, ABREAST):
            row = lanes[start:]
            for i in range(live):
                row[i] = row[np.uint64(kept[i])]
        for i in range(live, width):
            lanes[steps.STATE + i] = float(MISS)
    return queued
