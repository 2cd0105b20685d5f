# mypy: ignore-errors
"""The first pass of a solution, up the tree of fronts: U^T D^-1 y = b.

See solve_kernels; of a module of its own, so that two processes compile the passes at the same time.
"""

from sceneql.compiled.arithmetic_kernels import widest
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.lanes_kernels import BYTES, fma, load, store
from sceneql.linear.multifrontal import layout
from sceneql.linear.multifrontal.entries_kernels import PASS, at_front


@lean_inlined
def take_in(own, child, runs):
    """Add a child's update vector to the front's ``own`` at ``runs`` (end, place)."""
    first = run = 0
    while first < child.size:
        end, place = runs[run], runs[run + 1]
        for i in range(first, end):
            own[place + i - first] += child[i]
        first = end
        run += 2


@lean_inlined
def subtract(panel, height, k, rows, own):
    """Rows k.. of U, times what is solved for in them, from what comes after them in ``own``."""
    for i in range(k, k + rows):
        value = own[i] * panel[i * height + i]
        for j in range(i + 1, k + rows):
            own[j] -= panel[i * height + j] * value
    lanes = BYTES // own.itemsize
    if rows == layout.ROWS:
        a = k * height
        b, c, d = a + height, a + 2 * height, a + 3 * height
        p, q = -own[k] * panel[a + k], -own[k + 1] * panel[b + k + 1]
        r, s = -own[k + 2] * panel[c + k + 2], -own[k + 3] * panel[d + k + 3]
        for j in range(k + rows, height, lanes):
            sums = fma(p, load(panel, a + j), load(own, j))
            sums = fma(q, load(panel, b + j), sums)
            sums = fma(r, load(panel, c + j), sums)
            store(own, j, fma(s, load(panel, d + j), sums))
    else:
        for i in range(k, k + rows):
            value = -own[i] * panel[i * height + i]
            for j in range(k + rows, height, lanes):
                store(own, j, fma(value, load(panel, i * height + j), load(own, j)))


@lean_inlined
def forward_of(plan, factors, x, carried, begin, end):
    """Fronts begin..end of U^T D^-1 y = b, in x; children come before. All of float64, or all of float32."""
    widest()
    maps = plan[4]
    for s in range(begin, end):
        t = layout.HEAD + layout.FIELDS * s
        first, width, height, at = plan[t], plan[t + 1], plan[t + 2], at_front(plan, s)
        panel, own = factors[plan[t + 5] :], carried[at : at + height + layout.PAD]
        for k in range(width):
            own[k] = x[first + k]
        for k in range(width, height + layout.PAD):
            own[k] = 0.0
        child = plan[t + 7]
        while child >= 0:
            c = layout.HEAD + layout.FIELDS * child
            low = at_front(plan, child)
            take_in(own, carried[low + plan[c + 1] : low + plan[c + 2]], plan[maps + plan[c + 4] :])
            child = plan[c + 8]
        for k in range(0, width, layout.ROWS):
            subtract(panel, height, k, min(layout.ROWS, width - k), own)
        for k in range(width):
            x[first + k] = own[k]


@lean(PASS, inner=True)
def forward(plan, factors, x, carried, begin, end):
    """The first pass in double precision."""
    forward_of(plan, factors, x, carried, begin, end)
