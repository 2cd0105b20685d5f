# mypy: ignore-errors
"""The second pass of a solution, down the tree of fronts: U x = y.

See solve_kernels; of a module of its own, so that two processes compile the passes at the same time.
"""

from sceneql.compiled.arithmetic_kernels import widest
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.lanes_kernels import BYTES, fma, folded, load, spread
from sceneql.linear.multifrontal import layout
from sceneql.linear.multifrontal.entries_kernels import PASS, at_front


@lean_inlined
def substitute(panel, height, k, rows, own):
    """Solve rows k.. of U, given the solution of the rows after them in ``own``."""
    lanes = BYTES // own.itemsize
    p = q = r = s = spread(own.dtype.type(0.0))
    if rows == layout.ROWS:
        a = k * height
        b, c, d = a + height, a + 2 * height, a + 3 * height
        for j in range(k + rows, height, lanes):
            known = load(own, j)
            p = fma(load(panel, a + j), known, p)
            q = fma(load(panel, b + j), known, q)
            r = fma(load(panel, c + j), known, r)
            s = fma(load(panel, d + j), known, s)
        own[k] -= folded(p)
        own[k + 1] -= folded(q)
        own[k + 2] -= folded(r)
        own[k + 3] -= folded(s)
    else:
        for i in range(k, k + rows):
            p = spread(own.dtype.type(0.0))
            for j in range(k + rows, height, lanes):
                p = fma(load(panel, i * height + j), load(own, j), p)
            own[i] -= folded(p)
    for i in range(k + rows - 1, k - 1, -1):
        own[i] *= panel[i * height + i]
        for j in range(k, i):
            own[j] -= panel[j * height + i] * own[i]


@lean_inlined
def backward_of(plan, factors, x, carried, begin, end):
    """Fronts begin..end of U x = y, parents first."""
    widest()
    rows, at = plan[3], at_front(plan, begin)  # the same numbers for each front, which stay in the cache
    for s in range(end - 1, begin - 1, -1):
        t = layout.HEAD + layout.FIELDS * s
        first, width, height = plan[t], plan[t + 1], plan[t + 2]
        panel, own, row = factors[plan[t + 5] :], carried[at : at + height + layout.PAD], rows + plan[t + 3]
        for j in range(height):
            own[j] = x[plan[row + j]]
        for j in range(height, height + layout.PAD):
            own[j] = 0.0
        last = (width - 1) // layout.ROWS * layout.ROWS
        for k in range(last, -1, -layout.ROWS):
            substitute(panel, height, k, min(layout.ROWS, width - k), own)
        for k in range(width):
            x[first + k] = own[k]


@lean(PASS, inner=True)
def backward(plan, factors, x, carried, begin, end):
    """The second pass in double precision."""
    backward_of(plan, factors, x, carried, begin, end)
