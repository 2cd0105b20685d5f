# mypy: ignore-errors
"""First roots of a tape along a bundle of rays by enclosures of packets: see ``packet_roots_kernels``."""

import numpy as np

from sceneql.compiled.kernels import inlined, lean
from sceneql.compiled.lanes_kernels import spread
from sceneql.field.enclose.affine_kernels import GROW, ONE, PAD, ZERO, F
from sceneql.field.enclose.shorten_kernels import shorten
from sceneql.field.packets import ray_rows
from sceneql.field.packets import slab_kernels as slab
from sceneql.field.packets.packet_kernels import C1, LANES, TAPE_ROOTS, VECTOR, E, enclose, has, load_constants
from sceneql.field.packets.ray_rows import FOUND_HIGH, FOUND_LOW, FOUND_ROOT, FOUND_SLOPE, FOUND_STATUS
from sceneql.field.packets.search_lanes_kernels import search_lanes
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.batch_kernels import evaluate

SLABS = 8
"""Slabs of a beam."""
FEW = 8
"""Up to this number beams are not joined for a first test."""
STEADY, TURNS = 1e-9, 8
"""Change of a root, relative to the length of its search, at which its polish ends; steps after which the certified
routine takes over."""


@inlined
def enqueue(rays, count, groups, asked, found, queue):
    """Queue the rays that are to be searched, beam by beam, and write outcomes of decided ones; how many are queued."""
    queued = 0
    states = asked[ray_rows.SURE]
    for g in range(groups):
        for ray in range(g, count, groups):
            j = np.uint64(ray)
            queue[np.uint64(queued)] = ray
            if states[j] == slab.SETTLED:
                far = asked[ray_rows.FAR, j]
                found[FOUND_STATUS, j] = ops.HIT
                found[FOUND_LOW, j] = found[FOUND_HIGH, j] = far
                found[FOUND_ROOT, j] = rays[6, j] + far
            else:
                queued += 1 if states[j] >= 0.0 else 0
    return queued


@inlined
def polish(code, constants, parts, registers, points, rays, queue, count, found, values, ways):
    """A Newton step on all queued hits, in float64, and secant steps until they are STEADY; the order of hits changes.

    The slope of the first is that of the last enclosure, a mean over its segment. Across an edge, where a part's
    density ends or one of two solids takes over, a secant's slope is a mean too: the next step tells. ``values`` and
    ``ways`` (n,) are working memory.
    """
    width = points.shape[1]
    for start in range(0, count, width):
        moving = min(width, count - start)
        own, times = queue[start:], registers[0]
        begins, ends, roots = rays[6], rays[7], found[FOUND_ROOT]
        for turn in range(TURNS):
            n = moving
            for i in range(n):
                j = np.uint64(own[i])
                times[i] = begins[j] + roots[j]
            for axis in range(3):
                o, d, place = rays[axis], rays[3 + axis], points[axis]
                for i in range(n):
                    j = np.uint64(own[i])
                    place[i] = o[j] + times[i] * d[j]
            evaluate(code, constants, parts, registers, points, n)
            last = registers[code.shape[0] - 1]
            moving = 0
            for i in range(n):
                j = np.uint64(own[i])
                step = last[i] / found[FOUND_SLOPE, j]
                rise = last[i] - values[j]
                if turn > 0 and ways[j] != ZERO and rise * ways[j] * found[FOUND_SLOPE, j] > 0.0:
                    step = last[i] * ways[j] / rise
                root = min(max(roots[j] - step, found[FOUND_LOW, j]), found[FOUND_HIGH, j])
                values[j], ways[j] = last[i], root - roots[j]
                roots[j] = root
                left = min(abs(step), found[FOUND_HIGH, j] - found[FOUND_LOW, j])
                if turn == 0 or not left <= STEADY * (ends[j] - begins[j]):
                    own[i], own[moving] = own[moving], own[i]
                    moving += 1
                elif not begins[j] + root < ends[j]:
                    found[FOUND_STATUS, j] = ops.UNDECIDED
            if moving == 0:
                break
        for i in range(moving):
            found[FOUND_STATUS, np.uint64(own[i])] = ops.UNDECIDED


@inlined
def uncut(registers, clips):
    """(first, end) of the longest run of slabs that are proved inside all rows ``clips``."""
    first, end, begun = 0, 0, 0
    for i in range(LANES):
        for k in range(clips.shape[0]):
            row = registers[clips[k]]
            m = abs(row[C1 + i])
            if not row[i] + m + (row[E + i] * GROW + PAD * (abs(row[i]) + m)) < ZERO:
                begun = i + 1
        if i + 1 - begun > end - first:
            first, end = begun, i + 1
    return first, end


@inlined
def all_through(rays, count, low, high):
    """Whether all rays that have a length pass through low..high."""
    begins, ends = rays[6], rays[7]
    others = 0
    for j in range(count):
        others += 1 if (begins[j] < ends[j]) & ~((begins[j] < low) & (ends[j] > high)) else 0
    return others == 0


@inlined
def leave_all(rays, count, found, queue):
    """Leave all rays that have a length to the certified routine; returns their number."""
    queued = 0
    for j in range(count):
        if rays[6, j] < rays[7, j]:
            queue[np.uint64(queued)] = j
            found[FOUND_STATUS, j], found[FOUND_LOW, j] = ops.UNDECIDED, 0.0
            queued += 1
    return queued


@lean(TAPE_ROOTS, inner=True)
def tape_roots(
    code, constants, singles, registers, point, status, lanes, ids, rays, asked, queue, count, groups, anywhere, found,
    parts, scratch, beams, doubles, points, short, near_singles, near_parts, clips,
):  # fmt: skip
    """First roots of a bundle as by ``packet_roots_kernels.first_roots``, except for the clips in the rows ``clips``.

    Returns (enclosures, rays that may hit, in ``queue``, rows of the shortened tape in ``short``, end of the interval
    where it is valid, and the interval in which no clip cuts the solid).
    """
    load_constants(code, constants, registers)
    length = code.shape[0]
    last = registers[length - 1]
    spent = 0
    rows = 0
    safe, unsafe = -np.inf, np.inf
    base = slab.bundle(rays, count, groups, beams)
    if base == np.inf:
        return 0, 0, 0, np.inf, np.inf, np.inf
    slab.join(beams, groups, groups)
    begin, end = base, beams[slab.STOP, groups]
    if groups > FEW:
        slab.place_slabs(beams, groups, base, begin, end, point)
        enclose(code, constants, singles, registers, point, status, LANES)
        spent += LANES
        first, final, _ = slab.left_of_slabs(last, status, 0, LANES)
        if first == LANES:
            return spent, 0, 0, np.inf, np.inf, np.inf
        depth = (end - begin) / LANES
        deep = slab.first_inside(last, status, 0, LANES)
        if deep >= 0 and all_through(rays, count, base + deep * depth, base + (deep + 1) * depth):
            final = deep
        begin, end = base + (first - 1e-6) * depth, base + (final + 1 + 1e-6) * depth
        of_parts = has(code, ops.DENSITY) or has(code, ops.SKELETON)
        if of_parts or has(code, ops.MAX) or has(code, ops.MIN):
            rows, parted = shorten(
                code, registers, status, first, final, clips, singles, parts, scratch, short, near_singles, near_parts
            )
            if parted:
                return spent, leave_all(rays, count, found, queue), 0, np.inf, -np.inf, np.inf
            from_slab, to_slab = uncut(registers, clips)
            if clips.shape[0] > 0:
                safe, unsafe = base + from_slab * depth, base + to_slab * depth
            code = short[length : length + rows]
            if of_parts:
                singles = near_singles
            last = registers[rows - 1]
            load_constants(code, constants, registers)
    slab.cut_beams(beams, groups, begin, end)
    for at in range(0, groups, VECTOR):
        # The memory of the lanes is free until the search.
        slab.single_beams(beams, at, base, SLABS, lanes)
        left, final_slab, deep_slab = spread(F(SLABS)), spread(-ONE), spread(-ONE)
        for begun in range(0, SLABS, LANES // VECTOR):
            slab.place_beams(lanes, begun, point)
            enclose(code, constants, singles, registers, point, status, LANES)
            left, final_slab, deep_slab = slab.left_of_beams(last, status, begun, left, final_slab, deep_slab)
        spent += SLABS * min(VECTOR, groups - at)
        slab.note_beams(beams, at, SLABS, left, final_slab, deep_slab, lanes)
    slab.ask(rays, count, groups, beams, anywhere, safe, unsafe, asked)
    slab.ask_places(rays, count, asked)
    queued = enqueue(rays, count, groups, asked, found, queue)
    spent += search_lanes(
        code, constants, singles, registers, point, status, lanes, ids, asked, queue, queued, anywhere, found
    )
    if not anywhere:
        hits = 0
        for k in range(queued):  # hits to the front of the queue
            if found[FOUND_STATUS, queue[k]] == ops.HIT:
                queue[hits], queue[k] = queue[k], queue[hits]
                hits += 1
        near, run = asked[ray_rows.NEAR], asked[ray_rows.RUN]
        own_parts = near_parts if rows > 0 else parts
        polish(code, constants, own_parts, doubles, points, rays, queue, hits, found, near, run)
    return spent, queued, rows, end, safe, unsafe
