# mypy: ignore-errors
"""First roots of polynomials along many rays at once: hunt_kernels.hunt with enclosures of their coefficients."""

from sceneql.field.affine_kernels import ZERO
from sceneql.field.hunt_kernels import (
    CUT_FROM,
    CUT_TO,
    END,
    FAR,
    FOUND_HIGH,
    FOUND_LOW,
    FOUND_ROOT,
    FOUND_SLOPE,
    FOUND_STATUS,
    HELD,
    LENGTH,
    LIVE,
    NEAR,
    ROOT,
    ROWS,
    RUN,
    SLOPE,
    STATE,
    TRIES,
    A,
    B,
    advance,
)
from sceneql.field.packet_kernels import LANES
from sceneql.field.polynomial_kernels import (
    COEFFICIENTS,
    DEGREES,
    HALF_WAY,
    MIDDLE,
    POLYNOMIAL,
    coefficients,
    enclose_polynomials,
    rounding,
)
from sceneql.kernels import inlined

MOST_DEGREE = 8
PIECES = 6
WORK = PIECES + COEFFICIENTS + MOST_DEGREE + 1
"""Rows of ``room``: places and directions of the lanes' rays, their polynomials, and working memory."""


@inlined
def sizes_of(rays, queue, count, axis):
    """The largest |o| + |t d| of an axis on the queued rays."""
    size = 0.0
    for i in range(count):
        j = queue[i]
        size = max(size, abs(rays[axis, j]) + max(abs(rays[6, j]), abs(rays[7, j])) * abs(rays[3 + axis, j]))
    return size


@inlined
def take(rays, asked, queue, first, n, lanes, ids, pieces, table):
    """Put rays queue[first..first+n-1] into lanes."""
    middle, half = table[MIDDLE], table[HALF_WAY]
    for i in range(n):
        j = queue[first + i]
        ids[i] = j
        low, high = asked[NEAR, j], asked[FAR, j]
        middle[i] = 0.5 * (float(low) + float(high))
        half[i] = 0.5 * (float(high) - float(low))
        lanes[A * LANES + i] = low
        lanes[B * LANES + i] = asked[RUN, j]
        lanes[END * LANES + i] = lanes[CUT_FROM * LANES + i] = lanes[CUT_TO * LANES + i] = high
        lanes[LENGTH * LANES + i] = rays[7, j] - rays[6, j]
        lanes[HELD * LANES + i] = lanes[TRIES * LANES + i] = ZERO
        lanes[STATE * LANES + i] = LIVE
    for axis in range(3):
        place, way, own, own_way = rays[axis], rays[3 + axis], pieces[axis], pieces[3 + axis]
        begin = rays[6]
        for i in range(n):
            j = ids[i]
            own_way[i] = way[j]
            own[i] = place[j] + begin[j] * way[j]


@inlined
def close_gaps(lanes, ids, table, rows, width):
    """Move lanes that are looking for a root together; their number."""
    n = 0
    for j in range(width):
        if ids[j] < 0:
            continue
        if n < j:
            ids[n] = ids[j]
            for row in range(ROWS):
                lanes[row * LANES + n] = lanes[row * LANES + j]
            for row in range(rows):
                table[row, n] = table[row, j]
        n += 1
    return n


@inlined
def hunt_polynomials(
    code, constants, plan, last, status, lanes, ids, rays, asked, queue, count, anywhere, found, room
):  # fmt: skip
    """Settle the first ``count`` rays of the ``queue``; returns the enclosures spent."""
    pieces, table, work = room[:PIECES], room[PIECES:WORK], room[WORK:]
    degree = plan[DEGREES + plan[POLYNOMIAL]]
    sizes = sizes_of(rays, queue, count, 0), sizes_of(rays, queue, count, 1), sizes_of(rays, queue, count, 2)
    off = rounding(code, constants, plan, sizes, work)
    spent = 0
    for first in range(0, count, LANES):
        looking = width = min(LANES, count - first)
        take(rays, asked, queue, first, width, lanes, ids, pieces, table)
        coefficients(code, constants, plan, pieces, width, work, table)
        while looking > 0:
            if 2 * looking <= width:
                width = close_gaps(lanes, ids, table, COEFFICIENTS + degree + 1, width)
            n = (width + 7) // 8 * 8
            enclose_polynomials(table, degree, lanes, off, work, last, status, n)
            advance(lanes, last, status, n, anywhere)
            spent += looking
            for i in range(width):
                if lanes[STATE * LANES + i] == LIVE or ids[i] < 0:
                    continue
                j = ids[i]
                found[FOUND_STATUS, j] = lanes[STATE * LANES + i]
                found[FOUND_LOW, j] = lanes[A * LANES + i]
                found[FOUND_HIGH, j] = lanes[B * LANES + i]
                found[FOUND_ROOT, j] = lanes[ROOT * LANES + i]
                found[FOUND_SLOPE, j] = lanes[SLOPE * LANES + i]
                ids[i] = -1
                looking -= 1
    return spent
