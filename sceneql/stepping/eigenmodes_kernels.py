# mypy: ignore-errors
"""Solutions of eight systems at once with the factors of a symmetric matrix: each number of the factors is read once.

For the plan and the factors, in double precision, see linear/multifrontal/systems_kernels; b (n, 8), row by row.
"""

from numba import types

from sceneql.compiled.arithmetic_kernels import widest
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.lanes_kernels import BYTES, fma, load, store
from sceneql.linear.multifrontal import layout
from sceneql.linear.multifrontal.entries_kernels import at_front
from sceneql.system.signatures_kernels import A, I

BLOCK = BYTES // 8
"""Systems at once, the lanes of float64: more than the modes of most symmetries that share a frequency."""
SOLVE_BLOCK = types.void(I, A, A, A)


@lean_inlined
def row(numbers, k):
    """Row k of (n, 8) numbers."""
    return load(numbers, BLOCK * k)


@lean_inlined
def keep(numbers, k, lanes):
    """Set row k of (n, 8) numbers."""
    store(numbers, BLOCK * k, lanes)


@lean_inlined
def take_in(own, child, low, high, runs):
    """Add rows low..high of ``child``, a child's update, to the front's ``own`` at ``runs`` (end, place)."""
    first = run = 0
    while first < high - low:
        end, place = runs[run], runs[run + 1]
        for i in range(first, end):
            at = place + i - first
            keep(own, at, row(own, at) + row(child, low + i))
        first = end
        run += 2


@lean_inlined
def subtract(panel, height, k, rows, own):
    """Rows k.. of U, times what is solved for in them, from what comes after them in ``own``."""
    for i in range(k, k + rows):
        value = row(own, i) * panel[i * height + i]
        for j in range(i + 1, k + rows):
            keep(own, j, fma(-panel[i * height + j], value, row(own, j)))
    if rows == layout.ROWS:
        a = k * height
        b, c, d = a + height, a + 2 * height, a + 3 * height
        p, q = row(own, k) * panel[a + k], row(own, k + 1) * panel[b + k + 1]
        r, s = row(own, k + 2) * panel[c + k + 2], row(own, k + 3) * panel[d + k + 3]
        for j in range(k + rows, height):
            sums = fma(-panel[a + j], p, row(own, j))
            sums = fma(-panel[b + j], q, sums)
            sums = fma(-panel[c + j], r, sums)
            keep(own, j, fma(-panel[d + j], s, sums))
    else:
        for i in range(k, k + rows):
            value = row(own, i) * panel[i * height + i]
            for j in range(k + rows, height):
                keep(own, j, fma(-panel[i * height + j], value, row(own, j)))


@lean_inlined
def substitute(panel, height, k, rows, own):
    """Solve rows k.. of U, given the solution of the rows after them in ``own``."""
    if rows == layout.ROWS:
        a = k * height
        b, c, d = a + height, a + 2 * height, a + 3 * height
        p, q, r, s = row(own, k), row(own, k + 1), row(own, k + 2), row(own, k + 3)
        for j in range(k + rows, height):
            known = row(own, j)
            p = fma(-panel[a + j], known, p)
            q = fma(-panel[b + j], known, q)
            r = fma(-panel[c + j], known, r)
            s = fma(-panel[d + j], known, s)
        keep(own, k, p)
        keep(own, k + 1, q)
        keep(own, k + 2, r)
        keep(own, k + 3, s)
    else:
        for i in range(k, k + rows):
            p = row(own, i)
            for j in range(k + rows, height):
                p = fma(-panel[i * height + j], row(own, j), p)
            keep(own, i, p)
    for i in range(k + rows - 1, k - 1, -1):
        solved = row(own, i) * panel[i * height + i]
        keep(own, i, solved)
        for j in range(k, i):
            keep(own, j, fma(-panel[j * height + i], solved, row(own, j)))


@lean(SOLVE_BLOCK)
def solve_block(plan, factors, b, work):
    """Solve by the factors; the solutions take the place of b. ``work``: 8 times as many numbers as those of a plan."""
    widest()
    n, fronts, order, rows, maps = plan[0], plan[1], plan[2], plan[3], plan[4]
    x, carried = work[: BLOCK * n], work[BLOCK * n :]
    for k in range(n):
        keep(x, k, row(b, plan[order + k]))
    for s in range(fronts):
        t = layout.HEAD + layout.FIELDS * s
        first, width, height = plan[t], plan[t + 1], plan[t + 2]
        panel, own = factors[plan[t + 5] :], carried[BLOCK * at_front(plan, s) :]
        for k in range(width):
            keep(own, k, row(x, first + k))
        own[BLOCK * width : BLOCK * height] = 0.0
        child = plan[t + 7]
        while child >= 0:
            c = layout.HEAD + layout.FIELDS * child
            low = at_front(plan, child)
            take_in(own, carried, low + plan[c + 1], low + plan[c + 2], plan[maps + plan[c + 4] :])
            child = plan[c + 8]
        for k in range(0, width, layout.ROWS):
            subtract(panel, height, k, min(layout.ROWS, width - k), own)
        for k in range(width):
            keep(x, first + k, row(own, k))
    for s in range(fronts - 1, -1, -1):
        t = layout.HEAD + layout.FIELDS * s
        first, width, height = plan[t], plan[t + 1], plan[t + 2]
        panel, own, at = factors[plan[t + 5] :], carried[BLOCK * at_front(plan, s) :], rows + plan[t + 3]
        for j in range(height):
            keep(own, j, row(x, plan[at + j]))
        last = (width - 1) // layout.ROWS * layout.ROWS
        for k in range(last, -1, -layout.ROWS):
            substitute(panel, height, k, min(layout.ROWS, width - k), own)
        for k in range(width):
            keep(x, first + k, row(own, k))
    for k in range(n):
        keep(b, plan[order + k], row(x, k))
