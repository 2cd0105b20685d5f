# mypy: ignore-errors
"""First roots along a whole bundle of rays of a polynomial: see ``polynomial_hunt_kernels``."""

import numpy as np

from sceneql.field.density_roots_kernels import OTHER
from sceneql.field.extent_kernels import extent
from sceneql.field.packet_kernels import LANES, enclose, load_constants
from sceneql.field.polynomial_hunt_kernels import (
    POLYNOMIAL_ROOTS,
    SPOT,
    T0,
    T1,
    count_lanes,
    negative_slabs,
    pack,
    place_beam,
    settle_lanes,
    take,
)
from sceneql.field.polynomial_kernels import ABREAST, DEGREES, POLYNOMIAL, coefficients, rounding
from sceneql.field.polynomial_steps_kernels import HALF_WAY, LIVE, MIDDLE, MOST, C, step
from sceneql.field.slab_kernels import left_of_slabs
from sceneql.kernels import lean


@lean(POLYNOMIAL_ROOTS, inner=True)
def polynomial_roots(
    code, constants, singles, registers, point, status, rays, count, anywhere, found, queue, plan, order, room, lanes
):  # fmt: skip
    """Settle a bundle as ``packet_roots_kernels.first_roots`` does.

    Returns (enclosures, rays that may be met, in ``queue``, begin and end of where the other field is proved negative).
    """
    n = pack(rays, count, order, room)
    if n == 0:
        return 0, 0, np.inf, np.inf
    wide, spot = rays if n == count else room, room[SPOT]
    base, _ = extent(wide[T0], n)
    _, stop = extent(wide[T1], n)
    x = place_beam(wide, n, base, stop, 0, spot, point[0])
    y = place_beam(wide, n, base, stop, 1, spot, point[1])
    z = place_beam(wide, n, base, stop, 2, spot, point[2])
    load_constants(code, constants, registers)
    enclose(code, constants, singles, registers, point, status, LANES)
    first, final, run = left_of_slabs(registers[code.shape[0] - 1], status, 0, LANES)
    if first == LANES:
        return LANES, 0, np.inf, np.inf
    depth = (stop - base) / LANES
    begin, end, run_end = base + (first - 1e-6) * depth, base + (final + 1 + 1e-6) * depth, base + run * depth
    safe, unsafe = np.inf, np.inf
    if plan[OTHER] >= 0:
        k, m = negative_slabs(registers[plan[OTHER]])
        safe, unsafe = base + (k + 1e-6) * depth, base + (m - 1e-6) * depth
    off = rounding(code, constants, plan, (x[0], y[0], z[0], x[1], y[1], z[1]), lanes)
    rows = plan[POLYNOMIAL] + 1
    degree = plan[DEGREES + rows - 1]
    kept = C + (max(degree + degree % 2, 4) + 1) * ABREAST  # coefficients up to the next even degree from 4 on
    spare = order[rays.shape[1] :]
    spent = LANES
    queued = 0
    for first in range(0, n, ABREAST):
        width = min(ABREAST, n - first)
        m = (width + 15) // 16 * 16
        take(wide, first, width, m, begin, run_end, end, lanes)
        coefficients(code, constants, plan, wide, first, lanes[MIDDLE:], lanes[HALF_WAY:], m, lanes)
        for i in range(C + (degree + 1) * ABREAST, kept):
            lanes[i] = 0.0
        live = count_lanes(lanes, m, LIVE)
        tries = 0
        while width > 0:
            while 2 * live > width:
                tries += 1
                step(lanes, degree, m, off, anywhere, tries > MOST)
                spent += live
                live = count_lanes(lanes, m, LIVE)
            queued = settle_lanes(
                lanes, kept, degree, order, spare, width, live, rays, anywhere, found, queue, queued
            )  # fmt: skip
            width = live
            m = (width + 15) // 16 * 16
    return spent, queued, safe, unsafe
