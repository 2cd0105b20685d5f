# mypy: ignore-errors
"""First roots of a tape along a bundle of neighboring rays: culled slabs, packets, certified stragglers, polish.

Rays stand in GROUP rows; those of a column make a beam, which is cut into SLABS. Slabs that a packet proves outside are
culled. The rest is searched in lanes, and rays that float32 leaves undecided go to the certified float64 routine.
"""

import numpy as np
from numba import types
from numba.core.sigutils import normalize_signature

from sceneql.compiled.kernels import inlined, lean
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.field.packets.packet_kernels import BUNDLE, MEMORY, check_inside, tape_roots
from sceneql.field.packets.polynomial_search_kernels import polynomial_roots
from sceneql.field.packets.ray_rows import FOUND_HIGH, FOUND_LOW, FOUND_ROOT, FOUND_STATUS, SETTLED
from sceneql.field.roots.density_roots_kernels import ROW_OF, density_roots
from sceneql.field.roots.isolation_kernels import isolate
from sceneql.field.roots.polynomial_kernels import POLYNOMIAL
from sceneql.field.skeleton.density_polish_kernels import BOX, X, extent
from sceneql.field.tape import tape_ops as ops

_rows, _side = types.float64[:, ::1], types.float64
BOX_OF = types.Tuple((_side, _side, types.int64))(
    types.int32[:, ::1], types.float64[::1], _rows, _rows, _side, _side, _side, _side, _side, _side
)  # fmt: skip
box = lazy("sceneql.field.enclose.interval_kernels:box", BOX_OF)
GROUP = 16
TOLERANCE = 1e-9
"""Tolerance of the certified routine, relative to the searched piece of the ray."""
MOST_LOST = 2
"""Rays of a bundle that the certified routine may leave undecided."""
MANY = 64
"""Number of hits in a bundle from which on a test of their bounding box pays."""


@inlined
def certify_ray(code, constants, parts, scratch, rays, j, end, anywhere, found):
    """Find the root of ray j from FOUND_LOW on by the certified routine; the ray is outside behind ``end``."""
    ox, oy, oz, dx, dy, dz = rays[0, j], rays[1, j], rays[2, j], rays[3, j], rays[4, j], rays[5, j]
    begin = rays[6, j] + found[FOUND_LOW, j] * (1.0 - 1e-7)
    outcome, t = isolate(
        code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, begin, min(rays[7, j], end), TOLERANCE, 1.0, anywhere
    )
    found[FOUND_STATUS, j] = outcome
    found[FOUND_ROOT, j] = t - rays[6, j]
    if anywhere:
        found[FOUND_HIGH, j] = t - rays[6, j]


@inlined
def certify_queued(code, constants, parts, scratch, rays, queue, count, end, anywhere, found):
    """``certify_ray`` for the queued rays that are undecided; returns their number.

    After MOST_LOST that stay so, each of which takes long, the rest is left to whoever asks.
    """
    certified = lost = 0
    for k in range(count):
        j = np.uint64(queue[k])
        if found[FOUND_STATUS, j] == ops.UNDECIDED and lost < MOST_LOST:
            certified += 1
            certify_ray(code, constants, parts, scratch, rays, j, end, anywhere, found)
            lost += found[FOUND_STATUS, j] == ops.UNDECIDED
        elif found[FOUND_STATUS, j] == ops.UNDECIDED:  # the ray is outside up to FOUND_LOW, and no further for sure
            found[FOUND_ROOT, j] = found[FOUND_LOW, j]
            if anywhere:
                found[FOUND_HIGH, j] = found[FOUND_LOW, j]
    return certified


@inlined
def leave_safe(rays, queue, count, row, late, safe, unsafe, found, doubtful):
    """Copy the queued hits outside safe..unsafe, which ``check_inside`` must test, to ``doubtful``; how many."""
    begins, ends, places, outcomes = rays[6], rays[7], found[row], found[FOUND_STATUS]
    n = 0
    for k in range(count):
        j = np.uint64(queue[k])
        t = begins[j] + places[j] + late * (ends[j] - begins[j])
        doubtful[np.uint64(n)] = queue[k]
        n += 0 if (t > safe) & (t < unsafe) | (outcomes[j] != ops.HIT) else 1
    return n


@inlined
def box_inside(code, constants, parts, scratch, sides):
    """Whether a box, given in ``sides`` by its least and largest x, y and z, is proved inside a tape."""
    _, high, status = box(
        code, constants, parts, scratch, sides[0], sides[1], sides[2], sides[3], sides[4], sides[5]
    )  # fmt: skip
    return status == ops.WHOLE and high < 0.0


@inlined
def enclose_hits(rays, count, found, row, late, room):
    """Write the bounding box of the points that ``check_inside`` would test into row BOX of ``room``."""
    begins, ends, places, outcomes = rays[6], rays[7], found[row], found[FOUND_STATUS]
    sides = room[BOX]
    for axis in range(3):
        o, d, x = rays[axis], rays[3 + axis], room[X + axis]
        some = 0.0
        for j in range(count):
            if outcomes[j] == ops.HIT:
                some = o[j] + (begins[j] + places[j]) * d[j]
                break
        for j in range(count):
            place = o[j] + (begins[j] + places[j] + late * (ends[j] - begins[j])) * d[j]
            x[j] = place if outcomes[j] == ops.HIT else some
        sides[2 * axis], sides[2 * axis + 1] = extent(x, count)


FOUND = f"{MEMORY}, int64[::1], int64[::1], float64[:, ::1], float32[:, ::1], float64[::1], int32[:, ::1]"
ARGUMENTS = normalize_signature(f"void({BUNDLE}, {FOUND})")[0]
"""Types of the arrays that ``first_roots`` takes before and after ``count`` and ``anywhere``."""


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
    """Find the first roots of the first ``count`` rays; into rows FOUND_STATUS and FOUND_ROOT [t] of ``found``.

    Returns (enclosures spent, rays left to the certified routine). ``rays`` (RAY, n) holds origins, directions, begin
    and end; a ray with begin >= end is a MISS. They stand in GROUP rows, the last perhaps shorter, neighbors in
    columns. Outcomes are those of ``isolation_kernels.isolate``.
    """
    for j in range(count):
        found[FOUND_STATUS, j] = ops.MISS
    groups = (count + GROUP - 1) // GROUP
    safe = unsafe = np.inf
    certified = left = 0
    near_settled = False
    cut = other.shape[0] > 0
    kept = 0
    if plan[ROW_OF] >= 0:
        spent, queued, kept = density_roots(
            code, constants, parts, plan, rays, count, groups, anywhere, found, queue, order, room, table, lanes,
            short, near_parts, singles,
        )  # fmt: skip
        if kept >= 0:
            code, parts = short[: code.shape[0]], near_parts
    elif plan[POLYNOMIAL] >= 0:
        spent, queued = polynomial_roots(code, constants, rays, count, anywhere, found, queue, plan, order, room, flat)
    else:
        spent, queued, rows, end, safe, unsafe = tape_roots(
            code, constants, singles, registers, point, status, lanes, ids, rays, asked, queue, count, groups,
            anywhere, found, parts, scratch, beams, doubles, points, short, near_singles, near_parts,
            plan[POLYNOMIAL + 1 :],
        )  # fmt: skip
        near_settled = rows > 0
        cut = cut and near_settled
        if near_settled:
            length = code.shape[0]
            near = short[length : length + rows]
            certified = certify_queued(near, constants, near_parts, scratch, rays, queue, queued, end, anywhere, found)
    row, late = (FOUND_HIGH, 0.0) if anywhere else (FOUND_ROOT, SETTLED)
    boxed = plan[ROW_OF] >= 0 and kept >= 0 and not anywhere and queued > 0
    if cut and plan[POLYNOMIAL] >= 0 and queued > MANY:
        enclose_hits(rays, count, found, row, late, room)
        boxed = True
    if cut and not (boxed and box_inside(other, constants, parts, scratch, room[BOX])):
        left = leave_safe(rays, queue, queued, row, late, safe, unsafe, found, order)
        check_inside(other, constants, parts, doubles, points, rays, order, left, row, late, found)
    if near_settled:  # all but the rays to be tested against clips are done
        certified += certify_queued(code, constants, parts, scratch, rays, order, left, np.inf, anywhere, found)
    else:
        certified += certify_queued(code, constants, parts, scratch, rays, queue, queued, np.inf, anywhere, found)
    begins, roots = rays[6], found[FOUND_ROOT]
    for k in range(queued):
        j = np.uint64(queue[k])
        roots[j] += begins[j]
    return spent, certified
