# mypy: ignore-errors
"""Solutions with the factors of symmetric matrices, front by front, on several threads.

For the plan see fronts_kernels; A = U^T D^-1 U, with the reciprocals of D on U's diagonal. What a front takes from the
unknowns above it is carried up from child to parent, as updates of factorizations are, so that subtrees need nothing of
each other and the bytes do not depend on the threads. Four rows of U at a time are read once, as fast as memory gives
them.
"""

from numba import types

from sceneql.kernels import lean, lean_inlined
from sceneql.simulation.arithmetic_kernels import widest
from sceneql.simulation.lanes_kernels import BYTES, fma, folded, load, spread, store
from sceneql.simulation.linear.fronts_plan_kernels import (
    BACKWARD,
    ENTRY,
    FIELDS,
    FORWARD,
    HEAD,
    PAD,
    PIECES,
    PIECES_AT,
    THREADS,
)
from sceneql.simulation.threads_kernels import over_threads
from sceneql.system_kernels import A, I, N

ROWS = 4
WORTH_THREADS = 500_000
"""Numbers of the factors from which on threads share the fronts."""

PASS = types.void(I, A, A, A, N, N)
SOLVE = types.void(I, A, A, A)


@lean_inlined
def take_in(own, child, runs):
    """Add what a child carries at its places in the front's ``own``: ``runs`` (end, place) of them."""
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
    if rows == ROWS:
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
def substitute(panel, height, k, rows, own):
    """Solve rows k.. of U, all that comes after them in ``own`` being known."""
    lanes = BYTES // own.itemsize
    p = q = r = s = spread(own.dtype.type(0.0))
    if rows == ROWS:
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
def at_front(plan, s):
    """Where the numbers that are carried to a front start: behind each front's there is room for lanes beyond it."""
    return plan[HEAD + FIELDS * s + 3] + PAD * s


@lean_inlined
def forward_of(plan, factors, x, carried, begin, end):
    """Fronts begin..end of U^T D^-1 y = b, in x; children come before. All of float64, or all of float32."""
    widest()
    maps = plan[4]
    for s in range(begin, end):
        t = HEAD + FIELDS * s
        first, width, height, at = plan[t], plan[t + 1], plan[t + 2], at_front(plan, s)
        panel, own = factors[plan[t + 5] :], carried[at : at + height + PAD]
        for k in range(width):
            own[k] = x[first + k]
        for k in range(width, height + PAD):
            own[k] = 0.0
        child = plan[t + 7]
        while child >= 0:
            c = HEAD + FIELDS * child
            low = at_front(plan, child)
            take_in(own, carried[low + plan[c + 1] : low + plan[c + 2]], plan[maps + plan[c + 4] :])
            child = plan[c + 8]
        for k in range(0, width, ROWS):
            subtract(panel, height, k, min(ROWS, width - k), own)
        for k in range(width):
            x[first + k] = own[k]


@lean_inlined
def backward_of(plan, factors, x, carried, begin, end):
    """Fronts begin..end of U x = y, parents first."""
    widest()
    rows = plan[3]
    for s in range(end - 1, begin - 1, -1):
        t = HEAD + FIELDS * s
        first, width, height, at = plan[t], plan[t + 1], plan[t + 2], at_front(plan, s)
        panel, own, row = factors[plan[t + 5] :], carried[at : at + height + PAD], rows + plan[t + 3]
        for j in range(height):
            own[j] = x[plan[row + j]]
        for j in range(height, height + PAD):
            own[j] = 0.0
        last = (width - 1) // ROWS * ROWS
        for k in range(last, -1, -ROWS):
            substitute(panel, height, k, min(ROWS, width - k), own)
        for k in range(width):
            x[first + k] = own[k]


@lean(PASS, inner=True)
def forward(plan, factors, x, carried, begin, end):
    """The first pass in double precision."""
    forward_of(plan, factors, x, carried, begin, end)


@lean(PASS, inner=True)
def backward(plan, factors, x, carried, begin, end):
    """The second."""
    backward_of(plan, factors, x, carried, begin, end)


@lean(SOLVE, inner=True)
def solve_symmetric(plan, factors, b, work):
    """Solve as fronts_kernels.solve_system does."""
    n, fronts, order, pieces = plan[0], plan[1], plan[2], plan[PIECES]
    x, carried = work[:n], work[n:]
    entry = plan[ENTRY] if plan[HEAD + FIELDS * fronts + 5] >= WORTH_THREADS else 0
    for k in range(n):
        x[k] = b[plan[order + k]]
    if pieces > 0:
        over_threads(entry, plan[THREADS], plan[FORWARD], pieces, 0.0, factors, x, carried, plan)
    done = 0
    for at in range(plan[PIECES_AT], plan[PIECES_AT] + 3 * pieces, 3):
        forward(plan, factors, x, carried, done, plan[at])
        done = plan[at + 1]
    forward(plan, factors, x, carried, done, fronts)
    last = fronts
    for at in range(plan[PIECES_AT] + 3 * (pieces - 1), plan[PIECES_AT] - 3, -3):
        backward(plan, factors, x, carried, plan[at + 1], last)
        last = plan[at]
    backward(plan, factors, x, carried, 0, last)
    if pieces > 0:
        over_threads(entry, plan[THREADS], plan[BACKWARD], pieces, 0.0, factors, x, carried, plan)
    for k in range(n):
        b[plan[order + k]] = x[k]
