# mypy: ignore-errors
"""What closed lines cut off halves of cells, exactly, and the coefficients of a flat flow by it, as a term.

Each piece of a side between the lines of the grid adds the signed area between it and the right end of its half, and
its height to all halves further right: a sum along rows then has the area in each (as outlines of letters are drawn).
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows import layout as flow
from sceneql.flows.varying import fluid_layout as own
from sceneql.flows.varying.coefficients_kernels import begin, blend, finish, known
from sceneql.flows.varying.halves_kernels import halves
from sceneql.system.signatures_kernels import TERM


@lean_inlined
def note(part, cover, i, j, height, mean_x, nx, ny, periodic_x, periodic_y):
    """Add a piece in half (i, j), ``height`` down the line, at a mean place along x from the half's low end."""
    if periodic_y:
        j %= ny
    elif j < 0 or j >= ny:
        return
    if periodic_x:
        i %= nx
    elif i < 0:
        i, mean_x = 0, 0.0
    elif i >= nx:
        return
    part[i + nx * j] += height * (1.0 - mean_x)
    cover[i + nx * j] += height


@lean_inlined
def along(part, cover, x0, y0, x1, y1, nx, ny, periodic_x, periodic_y):
    """Add a side, in halves from the low corner, piece by piece."""
    if y0 == y1:
        return
    low, high = min(y0, y1), max(y0, y1)
    slope = (x1 - x0) / (y1 - y0)
    for j in range(math.floor(low), math.floor(high) + 1):
        bottom, top = max(low, float(j)), min(high, j + 1.0)
        if not top > bottom:
            continue
        a, b = x0 + slope * (bottom - y0), x0 + slope * (top - y0)
        left, right = min(a, b), max(a, b)
        height = bottom - top if y1 > y0 else top - bottom
        first, last = math.floor(left), math.floor(right)
        if first == last:
            note(part, cover, first, j, height, 0.5 * (left + right) - first, nx, ny, periodic_x, periodic_y)
            continue
        for i in range(first, last + 1):
            begin_x, end_x = max(left, float(i)), min(right, i + 1.0)
            share = height * ((end_x - begin_x) / (right - left))
            note(part, cover, i, j, share, 0.5 * (begin_x + end_x) - i, nx, ny, periodic_x, periodic_y)


@lean(TERM, inner=True)
def measure(t, y, rate, floats, ints):
    """The density and the viscosity of all halves, and what terms and the projection read of them."""
    if known(y, floats, ints):
        return
    one = ints[ints[own.FLOW] :]
    nx, ny, _ = halves(one)
    n = nx * ny
    part, cover = floats[ints[own.PART] : ints[own.PART] + n], floats[ints[own.COVER] : ints[own.COVER] + n]
    box = ints[own.OWN] + 2
    scale_x, scale_y = 2.0 / floats[box + 3], 2.0 / floats[box + 4]
    periodic_x, periodic_y = one[flow.PERIODIC] == 1, one[flow.PERIODIC + 1] == 1
    begin(n, floats, ints)
    for number in range(int(floats[ints[own.TABLE]])):
        row = int(floats[ints[own.TABLE] + 1]) + own.ROW * number
        count, at = int(floats[row + own.COUNT]), int(floats[row + own.POSITION_AT])
        for c in range(n):
            part[c] = cover[c] = 0.0
        leftmost = math.inf
        for v in range(count):
            w = v + 1 if v < count - 1 else 0
            x0, y0 = scale_x * (y[at + 3 * v] - floats[box]), scale_y * (y[at + 3 * v + 1] - floats[box + 1])
            x1, y1 = scale_x * (y[at + 3 * w] - floats[box]), scale_y * (y[at + 3 * w + 1] - floats[box + 1])
            if not math.isfinite(x0 + y0 + x1 + y1) or abs(x0) + abs(y0) > 1e9 or abs(x1) + abs(y1) > 1e9:
                continue
            leftmost = min(leftmost, x0)
            along(part, cover, x0, y0, x1, y1, nx, ny, periodic_x, periodic_y)
        first = math.floor(leftmost) if periodic_x and math.isfinite(leftmost) else 0
        for j in range(ny):
            running = 0.0
            for s in range(nx):
                c = (first + s) % nx + nx * j
                part[c] += running
                running += cover[c]
        blend(n, floats[row + own.ITS_DENSITY], floats[row + own.ITS_VISCOSITY], floats, ints)
    finish(floats, ints)
