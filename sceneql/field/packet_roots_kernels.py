# mypy: ignore-errors
"""First roots of a tape along a bundle of neighboring rays: emptied slabs, packets, certified stragglers, polish.

Rays stand in GROUP rows; those of a column make a beam, which is cut in SLABS along its way. Slabs that a packet proves
to be outside are left out. What remains is hunted in lanes, and what float32 cannot tell goes to the certified float64
routine.
"""

import numpy as np
from numba.core.sigutils import normalize_signature

from sceneql.field.batch_kernels import evaluate
from sceneql.field.density_roots_kernels import ROW_OF, density_roots
from sceneql.field.hunt_kernels import (
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
    hunt,
)
from sceneql.field.isolation_kernels import isolate
from sceneql.field.packet_kernels import LANES, PACKET, enclose, load_constants
from sceneql.field.polynomial_hunt_kernels import polynomial_roots
from sceneql.field.polynomial_kernels import POLYNOMIAL
from sceneql.field.shorten_kernels import shorten
from sceneql.field.slab_kernels import BEGIN, STOP, bundle, first_inside, join, left_of_slabs, place_slabs
from sceneql.field.tape_ops import DENSITY, HIT, MAX, MIN, MISS, SKELETON, UNDECIDED
from sceneql.kernels import inlined, lean

GROUP, SLABS, VECTOR = 16, 8, 16
BEAMS = LANES // SLABS
TOLERANCE = 1e-9
"""Of the certified routine, relative to the searched piece of the ray."""


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
def has(code, op):
    """Whether a tape has an operation."""
    for k in range(code.shape[0]):
        if code[k, 0] == op:
            return True
    return False


@inlined
def certify_ray(code, constants, parts, scratch, rays, j, end, anywhere, found):
    """Settle ray j from FOUND_LOW on by the certified routine; behind ``end`` it is known to be outside."""
    ox, oy, oz, dx, dy, dz = rays[0, j], rays[1, j], rays[2, j], rays[3, j], rays[4, j], rays[5, j]
    begin = rays[6, j] + found[FOUND_LOW, j] * (1.0 - 1e-7)
    outcome, t = isolate(
        code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, begin, min(rays[7, j], end), TOLERANCE, 1.0, anywhere
    )
    found[FOUND_STATUS, j] = outcome
    found[FOUND_ROOT, j] = t


@inlined
def certify(code, constants, parts, scratch, rays, count, anywhere, found):
    """Settle all rays one at a time: for operations that packets do not know. Returns their number."""
    certified = 0
    for j in range(count):
        found[FOUND_LOW, j] = 0.0
        if rays[6, j] < rays[7, j]:
            certify_ray(code, constants, parts, scratch, rays, j, np.inf, anywhere, found)
            certified += 1
    return certified


@inlined
def all_through(rays, count, low, high):
    """Whether all rays that have a length come through low..high."""
    begins, ends = rays[6], rays[7]
    others = 0
    for j in range(count):
        others += 1 if (begins[j] < ends[j]) & ~((begins[j] < low) & (ends[j] > high)) else 0
    return others == 0


@inlined
def packet_roots(
    code, constants, singles, registers, point, status, lanes, ids, rays, asked, queue, count, groups, anywhere, found,
    parts, scratch, beams, short, near_singles, near_parts,
):  # fmt: skip
    """Settle a bundle by enclosures: (enclosures, rays that may be met, in ``queue``, rows of ``short`` that hold up to
    where all is looked at, that place)."""
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
    return spent, queued, rows, end


@inlined
def leave_safe(rays, queue, count, row, late, safe, unsafe, found, doubtful):
    """Put those queued rays into ``doubtful`` that ``check_inside`` must look at; how many."""
    begins, ends, places = rays[6], rays[7], found[row]
    n = 0
    for k in range(count):
        j = np.uint64(queue[k])
        t = begins[j] + places[j] + late * (ends[j] - begins[j])
        doubtful[np.uint64(n)] = queue[k]
        n += 0 if (t > safe) & (t < unsafe) else 1
    return n


@inlined
def check_inside(code, constants, parts, registers, points, rays, queue, count, row, late, found):
    """Leave rays undecided that are not inside ``late`` times their length behind the place in a row of ``found``."""
    width = points.shape[1]
    for start in range(0, count, width):
        n = min(width, count - start)
        for i in range(n):
            j = np.uint64(queue[start + i])
            t = rays[6, j] + found[row, j] + late * (rays[7, j] - rays[6, j])
            for axis in range(3):
                points[axis, i] = rays[axis, j] + t * rays[3 + axis, j]
        evaluate(code, constants, parts, registers, points, n)
        last = registers[code.shape[0] - 1]
        for i in range(n):
            j = np.uint64(queue[start + i])
            if found[FOUND_STATUS, j] == HIT and not last[i] < 0.0:
                found[FOUND_STATUS, j] = UNDECIDED


BUNDLE = f"{PACKET}, float32[::1], float32[::1], int64[::1], float64[:, ::1], float32[:, ::1], int64[::1]"
FOUND = "float64[:, ::1]," * 6 + "int32[:, ::1], float32[:, ::1], float64[:, ::1],"
FOUND += "int64[::1], int64[::1], float64[:, ::1], float32[:, ::1], float64[::1], int32[:, ::1]"
ARGUMENTS = normalize_signature(f"void({BUNDLE}, {FOUND})")[0]
"""Types of the arrays that ``first_roots`` takes before and behind its two numbers."""


@lean(f"UniTuple(int64, 2)({BUNDLE}, int64, boolean, {FOUND})")
def first_roots(
    code,
    constants,
    singles,
    registers,
    point,
    status,
    lanes,
    ids,
    rays,
    asked,
    queue,
    count,
    anywhere,
    found,
    parts,
    scratch,
    beams,
    doubles,
    points,
    short,
    near_singles,
    near_parts,
    plan,
    order,
    room,
    table,
    flat,
    other,
):
    """Settle the first ``count`` rays: outcomes and places [t] into rows FOUND_STATUS and FOUND_ROOT of ``found``.

    Returns (enclosures spent, rays left to the certified routine). ``rays`` (RAY, n) holds origins, directions, begin
    and end; a ray with begin >= end is a MISS. They stand in GROUP rows, the last perhaps shorter, neighbors in
    columns. Outcomes are those of ``isolation_kernels.isolate``.
    """
    for j in range(count):
        found[FOUND_STATUS, j] = MISS
    groups = (count + GROUP - 1) // GROUP
    safe = unsafe = end = np.inf
    if plan[ROW_OF] >= 0:
        spent, queued = density_roots(
            code, constants, parts, plan, rays, count, groups, anywhere, found, queue, order, room, table, lanes,
            short, near_parts,
        )  # fmt: skip
        code, parts = short[: code.shape[0]], near_parts
    elif plan[POLYNOMIAL] >= 0:
        spent, queued, safe, unsafe = polynomial_roots(
            code, constants, singles, registers, point, status, rays, count, anywhere, found, queue, plan, order,
            room, flat,
        )  # fmt: skip
    elif has(code, SKELETON):
        return 0, certify(code, constants, parts, scratch, rays, count, anywhere, found)
    else:
        spent, queued, rows, end = packet_roots(
            code, constants, singles, registers, point, status, lanes, ids, rays, asked, queue, count, groups,
            anywhere, found, parts, scratch, beams, short, near_singles, near_parts,
        )  # fmt: skip
        if rows > 0:
            length = code.shape[0]
            code, parts = short[length : length + rows], near_parts
        else:
            end = np.inf
    if not anywhere and plan[POLYNOMIAL] < 0 and plan[ROW_OF] < 0:
        hits = 0
        for k in range(queued):  # hits to the front of the queue
            if found[FOUND_STATUS, queue[k]] == HIT:
                queue[hits], queue[k] = queue[k], queue[hits]
                hits += 1
        polish(code, constants, parts, doubles, points, rays, queue, hits, found)
    if other.shape[0] > 0:
        row, late = (FOUND_HIGH, 0.0) if anywhere else (FOUND_ROOT, SETTLED)
        doubtful = leave_safe(rays, queue, queued, row, late, safe, unsafe, found, order)
        check_inside(other, constants, parts, doubles, points, rays, order, doubtful, row, late, found)
    certified = 0
    for k in range(queued):
        j = np.uint64(queue[k])
        if found[FOUND_STATUS, j] == UNDECIDED:
            certified += 1
            certify_ray(code, constants, parts, scratch, rays, j, end, anywhere, found)
        else:
            found[FOUND_ROOT, j] += rays[6, j]
    return spent, certified
