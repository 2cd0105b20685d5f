# mypy: ignore-errors
"""First roots of a tape along a bundle of rays by enclosures of packets: see ``packet_roots_kernels``."""

import numpy as np

from sceneql.field.batch_kernels import evaluate
from sceneql.field.hunt_kernels import hunt
from sceneql.field.packet_kernels import LANES, TAPE_ROOTS, enclose, has, load_constants
from sceneql.field.ray_rows import (
    FAR,
    FOUND_HIGH,
    FOUND_LOW,
    FOUND_ROOT,
    FOUND_SLOPE,
    FOUND_STATUS,
    NEAR,
    RUN,
    SETTLED,
    SURE,
)
from sceneql.field.shorten_kernels import shorten
from sceneql.field.slab_kernels import BEGIN, STOP, bundle, first_inside, join, left_of_slabs, place_slabs
from sceneql.field.tape_ops import DENSITY, HIT, MAX, MIN, UNDECIDED
from sceneql.kernels import inlined, lean

SLABS, VECTOR = 8, 16
BEAMS = LANES // SLABS


@inlined
def ask(rays, j, begin, depth, first, final, deep, anywhere, asked, found):
    """Set where the search on ray j begins and ends; False where nothing is left of it.

    It ends in slab ``deep``, which is inside (-1: none is known to be), where the ray comes through it.
    """
    t0 = rays[6, j]
    t1 = rays[7, j]
    if not t0 < t1:
        return False
    hair = 1e-6 * depth
    low = max(begin + first * depth - hair - t0, 0.0)
    high = min(begin + (final + 1) * depth + hair, t1) - t0
    if not low < high:
        return False
    low *= 1.0 - 2e-7
    high *= 1.0 + 2e-7
    inside = begin + (deep + 0.5) * depth
    sure = deep >= 0 and t0 + low < inside < t1
    if sure:
        high = inside - t0
        if anywhere:
            found[FOUND_STATUS, j] = HIT
            found[FOUND_LOW, j] = found[FOUND_HIGH, j] = high
            found[FOUND_ROOT, j] = inside
            return False
    asked[NEAR, j] = low
    asked[FAR, j] = high
    asked[RUN, j] = min(max(begin + (first + 1) * depth - t0, low + 0.01 * (high - low)), high)
    asked[SURE, j] = 1.0 if sure else 0.0
    return True


@inlined
def polish(code, constants, parts, registers, points, rays, queue, count, found):
    """Newton's steps on all hits among the queued rays, in float64, with the slope of the last enclosure."""
    width = points.shape[1]
    for start in range(0, count, width):
        n = min(width, count - start)
        for turn in range(2):
            for i in range(n):
                j = np.uint64(queue[start + i])
                t = rays[6, j] + found[FOUND_ROOT, j]
                points[0, i] = rays[0, j] + t * rays[3, j]
                points[1, i] = rays[1, j] + t * rays[4, j]
                points[2, i] = rays[2, j] + t * rays[5, j]
            evaluate(code, constants, parts, registers, points, n)
            last = registers[code.shape[0] - 1]
            for i in range(n):
                j = np.uint64(queue[start + i])
                step = last[i] / found[FOUND_SLOPE, j]
                root = min(max(found[FOUND_ROOT, j] - step, found[FOUND_LOW, j]), found[FOUND_HIGH, j])
                if turn == 1 and not (
                    abs(step) <= SETTLED * (rays[7, j] - rays[6, j]) and rays[6, j] + root < rays[7, j]
                ):
                    found[FOUND_STATUS, j] = UNDECIDED
                found[FOUND_ROOT, j] = root


@inlined
def all_through(rays, count, low, high):
    """Whether all rays that have a length come through low..high."""
    begins, ends = rays[6], rays[7]
    others = 0
    for j in range(count):
        others += 1 if (begins[j] < ends[j]) & ~((begins[j] < low) & (ends[j] > high)) else 0
    return others == 0


@lean(TAPE_ROOTS, inner=True)
def tape_roots(
    code, constants, singles, registers, point, status, lanes, ids, rays, asked, queue, count, groups, anywhere, found,
    parts, scratch, beams, doubles, points, short, near_singles, near_parts,
):  # fmt: skip
    """Settle a bundle as ``packet_roots_kernels.first_roots`` does.

    Returns (enclosures, rays that may be met, in ``queue``, rows of ``short`` that hold up to where all is looked at,
    that place).
    """
    load_constants(code, constants, registers)
    length = code.shape[0]
    last = registers[length - 1]
    spent = 0
    queued = 0
    rows = 0
    base = bundle(rays, count, groups, beams)
    if base == np.inf:
        return 0, 0, 0, np.inf
    join(beams, groups, groups)
    begin, end = base, beams[STOP, groups]
    if groups > BEAMS:
        place_slabs(beams, groups, base, begin, end, point, 0, LANES)
        enclose(code, constants, singles, registers, point, status, LANES)
        spent += LANES
        first, final, _ = left_of_slabs(last, status, 0, LANES)
        if first == LANES:
            return spent, 0, 0, np.inf
        depth = (end - begin) / LANES
        deep = first_inside(last, status, 0, LANES)
        if deep >= 0 and all_through(rays, count, base + deep * depth, base + (deep + 1) * depth):
            final = deep
        begin, end = base + (first - 1e-6) * depth, base + (final + 1 + 1e-6) * depth
        if has(code, DENSITY) or has(code, MAX) or has(code, MIN):
            rows = shorten(
                code, registers, status, first, final, singles, parts, scratch, short, near_singles, near_parts
            )
            code = short[length : length + rows]
            if has(code, DENSITY):
                singles = near_singles
            last = registers[rows - 1]
            load_constants(code, constants, registers)
    waiting = 0
    for g in range(groups):
        low, high = max(beams[BEGIN, g], begin), min(beams[STOP, g], end)
        if low < high:
            place_slabs(beams, g, base, low, high, point, SLABS * waiting, SLABS)
            ids[waiting] = g
            waiting += 1
        if waiting == 0 or (waiting < BEAMS and g + 1 < groups):
            continue
        enclose(code, constants, singles, registers, point, status, (SLABS * waiting + VECTOR - 1) // VECTOR * VECTOR)
        spent += SLABS * waiting
        for b in range(waiting):
            first, final, _ = left_of_slabs(last, status, SLABS * b, SLABS)
            if first == SLABS:
                continue
            deep = first_inside(last, status, SLABS * b, SLABS)
            low, high = max(beams[BEGIN, ids[b]], begin), min(beams[STOP, ids[b]], end)
            depth = (high - low) / SLABS
            for j in range(ids[b], count, groups):
                if ask(rays, j, low, depth, first, final, deep, anywhere, asked, found):
                    queue[queued] = j
                    queued += 1
        waiting = 0
    spent += hunt(
        code, constants, singles, registers, point, status, lanes, ids, rays, asked, queue, queued, anywhere, found
    )
    if not anywhere:
        hits = 0
        for k in range(queued):  # hits to the front of the queue
            if found[FOUND_STATUS, queue[k]] == HIT:
                queue[hits], queue[k] = queue[k], queue[hits]
                hits += 1
        polish(code, constants, near_parts if rows > 0 else parts, doubles, points, rays, queue, hits, found)
    return spent, queued, rows, end
