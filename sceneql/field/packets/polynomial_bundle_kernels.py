# mypy: ignore-errors
"""First roots along a whole bundle of rays of a polynomial: see ``polynomial_search_kernels``."""

from sceneql.compiled.kernels import lean
from sceneql.field.packets import polynomial_search_kernels as search
from sceneql.field.roots import polynomial_steps_kernels as steps
from sceneql.field.roots.polynomial_kernels import ABREAST, DEGREES, POLYNOMIAL, coefficients, rounding


@lean(search.POLYNOMIAL_ROOTS, inner=True)
def polynomial_roots(
    code, constants, rays, count, anywhere, found, queue, plan, order, room, lanes
):  # fmt: skip
    """First roots of a bundle as by ``packet_roots_kernels.first_roots``.

    Returns (steps, rays that may hit, in ``queue``). Culling by enclosures of the tape would empty some bundles, but
    cost all of them as much as it saves.
    """
    n = search.pack(rays, count, order, room)
    if n == 0:
        return 0, 0
    wide = rays if n == count else room
    x, y, z = search.reach(wide, n, 0), search.reach(wide, n, 1), search.reach(wide, n, 2)
    off = rounding(code, constants, plan, (x[0], y[0], z[0], x[1], y[1], z[1]), lanes)
    rows = plan[POLYNOMIAL] + 1
    degree = plan[DEGREES + rows - 1]
    kept = steps.C + (max(degree + degree % 2, 4) + 1) * ABREAST  # padded to an even degree of at least 4
    spare = order[rays.shape[1] :]
    spent = queued = 0
    for first in range(0, n, ABREAST):
        width = min(ABREAST, n - first)
        m = (width + 15) // 16 * 16
        search.take(wide, first, width, m, lanes)
        coefficients(code, constants, plan, wide, first, lanes[steps.MIDDLE :], lanes[steps.HALF_WAY :], m, lanes)
        for i in range(steps.C + (degree + 1) * ABREAST, kept):
            lanes[i] = 0.0
        live, tries = width, 0
        while width > 0:
            while 2 * live > width:
                tries += 1
                spent += live
                live = steps.step(lanes, degree, m, off, anywhere, tries > steps.MOST)
            queued = search.settle_lanes(
                lanes, kept, degree, order, spare, width, live, rays, anywhere, found, queue, queued
            )  # fmt: skip
            width = live
            m = (width + 15) // 16 * 16
    return spent, queued
