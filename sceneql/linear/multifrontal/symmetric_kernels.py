# mypy: ignore-errors
"""The multifrontal factorization of symmetric matrices: U alone, in its place, on several threads.

For the plan see systems_kernels; helpers are for arrays of either precision. A front's eliminated rows (width x
rows) are computed in place, among the factors, with the reciprocals of the pivots D^-1 on the diagonal; A = U^T
D^-1 U. Its update is the upper half of the square of its other rows. L = U^T D^-1 is never stored: its entries are
products. Large subtrees of fronts are pieces that threads share; results do not depend on the number of threads.
"""

import math

import numpy as np
from numba import types

from sceneql.compiled.arithmetic_kernels import fma, widest
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.threads_kernels import over_threads
from sceneql.linear.multifrontal import layout
from sceneql.linear.multifrontal.entries_kernels import put
from sceneql.linear.multifrontal.panel_update_kernels import MOST, ROWS, add_rows, coefficients
from sceneql.system.signatures_kernels import A, I, N

FEW = 4
"""Rows of U that are eliminated in registers."""
TINY = 1e-18
"""Entries below this are set to 0 in single precision, where the matrix's largest entry is about 1."""
TILE = 384
"""Columns that are updated at a time: their part of U stays in the cache."""

NOWHERE = np.int64(0)
"""A zero in the type of all shifts: numba would compile `update` once more for a plain 0."""

FACTOR_SYMMETRIC = types.boolean(I, A, A, A)
FACTOR_FRONTS = types.boolean(I, A, A, A, N, N)


@lean_inlined
def update(panel, height, begin, end, target, stride, shift, low, high):
    """Rows low..high of the front less L U of the rows begin..end (MOST at most), from the diagonal on.

    Entry (i, j) of the front is target[(i - shift) stride + j - shift].
    """
    widest()
    weights = coefficients(panel)
    for tile in range(low, height, TILE):
        edge = min(tile + TILE, height)
        i = low
        while i < min(high, edge):
            rows = ROWS if i + ROWS <= high else 1
            at = 0
            for k in range(begin, end):
                row = k * height
                v = -panel[row + k]
                if rows == ROWS:
                    for r in range(ROWS):
                        weights[at + r] = panel[row + i + r] * v
                else:
                    weights[at] = panel[row + i] * v
                at += rows
            first = max(tile, i)
            place = (i - shift) * stride + first - shift
            left = edge - first
            add_rows(target, place, stride, rows, panel, begin * height + first, height, weights, end - begin, left)
            i += rows


@lean_inlined
def eliminate_few(panel, height, begin, end):
    """At most FEW rows of U, among themselves; False where a pivot is 0 or not finite."""
    widest()
    for k in range(begin, end):
        row = k * height
        pivot = panel[row + k]
        if not 0.0 < abs(pivot) < math.inf:
            return False
        panel[row + k] = 1.0 / pivot
        inverse = panel[row + k]
        for i in range(k + 1, end):
            factor = -(panel[row + i] * inverse)
            for j in range(i, end):
                panel[i * height + j] = fma(factor, panel[row + j], panel[i * height + j])
    a = begin * height
    if end - begin == FEW:
        b, c, d = a + height, a + 2 * height, a + 3 * height
        u, v, w = -panel[a + begin], -panel[b + begin + 1], -panel[c + begin + 2]
        p, q, s = panel[a + begin + 1] * u, panel[a + begin + 2] * u, panel[a + begin + 3] * u
        r, t, z = panel[b + begin + 2] * v, panel[b + begin + 3] * v, panel[c + begin + 3] * w
        first, second = panel[a + end : b], panel[b + end : c]
        third, fourth = panel[c + end : d], panel[d + end : d + height]
        for j in range(first.size):
            x = first[j]
            y = fma(p, x, second[j])
            o = fma(r, y, fma(q, x, third[j]))
            second[j], third[j], fourth[j] = y, o, fma(z, o, fma(t, y, fma(s, x, fourth[j])))
    else:
        for k in range(begin, end):
            spread(panel, height, k, k + 1, end, end)
    return True


@lean_inlined
def spread(panel, height, k, low, high, start):
    """Subtract the multiples of row k from rows low..high of U, from column ``start`` on."""
    widest()
    row = panel[k * height + start : (k + 1) * height]
    for i in range(low, high):
        below = panel[i * height + start : (i + 1) * height]
        factor = -(panel[k * height + i] * panel[k * height + k])
        for j in range(row.size):
            below[j] = fma(factor, row[j], below[j])


@lean_inlined
def eliminate(panel, height, begin, end):
    """Rows begin..end of U; False where a pivot is 0 or not finite."""
    for low in range(begin, end, ROWS):
        high = min(low + ROWS, end)
        if low > begin:
            update(panel, height, begin, low, panel, height, NOWHERE, low, high)
        for few in range(low, high, FEW):
            if not eliminate_few(panel, height, few, min(few + FEW, high)):
                return False
            for k in range(few, min(few + FEW, high)):
                spread(panel, height, k, few + FEW, high, few + FEW)
        if panel.itemsize == 4:
            flush(panel, low * height, high * height)
    return True


@lean_inlined
def flush(panel, begin, end):
    """Set to 0 numbers so small that products of two would be subnormal, which processors multiply slowly."""
    widest()
    tiny, zero = panel.dtype.type(TINY), panel.dtype.type(0.0)
    for k in range(begin, end):
        panel[k] = zero if abs(panel[k]) <= tiny else panel[k]


@lean_inlined
def take_in(panel, width, height, square, child, below, runs):
    """Add a child's update (below x below) at its places in the front: ``runs`` (end in the update, place) of them."""
    rest = height - width
    first = run = 0
    while first < below:
        end, place = runs[run], runs[run + 1]
        for i in range(first, end):
            begin, other = i, run
            row, at = place + i - first, place + i - first
            low = row * height if row < width else (row - width) * rest - width
            target = panel if row < width else square
            while begin < below:
                stop = runs[other]
                into, part = target[low + at : low + at + stop - begin], child[i * below + begin : i * below + stop]
                for j in range(part.size):
                    into[j] += part[j]
                begin = stop
                other += 2
                at = runs[other + 1]
        first = end
        run += 2


@lean_inlined
def fronts_of(plan, values, scale, factors, work, begin, end):
    """Fronts begin..end, whose children are factored before them; False where a pivot is 0 or not finite.

    ``factors`` and ``work`` of float64, or both of float32; they are those of the matrix times ``scale``.
    """
    widest()
    maps, entries = plan[4], plan[5]
    for s in range(begin, end):
        t = layout.HEAD + layout.FIELDS * s
        width, height = plan[t + 1], plan[t + 2]
        rest = height - width
        panel = factors[plan[t + 5] : plan[t + 5] + width * height + layout.PAD]
        square = work[plan[t + 9] : plan[t + 9] + rest * rest]
        for k in range(panel.size):
            panel[k] = 0.0
        for i in range(rest):
            for k in range(i * rest + i, (i + 1) * rest):
                square[k] = 0.0
        put(plan, values, scale, panel, height, entries + 2 * plan[t + 6], entries + 2 * plan[t + 10])
        child = plan[t + 7]
        while child >= 0:
            c = layout.HEAD + layout.FIELDS * child
            below = plan[c + 2] - plan[c + 1]
            take_in(panel, width, height, square, work[plan[c + 9] :], below, plan[maps + plan[c + 4] :])
            child = plan[c + 8]
        for low in range(0, width, MOST):
            high = min(low + MOST, width)
            if not eliminate(panel, height, low, high):
                return False
            update(panel, height, low, high, panel, height, NOWHERE, high, width)
            update(panel, height, low, high, square, rest, width, width, height)
    return True


@lean(FACTOR_FRONTS, inner=True)
def factor_fronts(plan, values, factors, work, begin, end):
    """`fronts_of` in double precision."""
    return fronts_of(plan, values, 1.0, factors, work, begin, end)


@lean(FACTOR_SYMMETRIC, inner=True)
def factor_symmetric(plan, values, factors, work):
    """Factor as systems_kernels.factor_system does; half of the values is read."""
    if plan[layout.PIECES] > 0:
        entry, threads, pieces = plan[layout.ENTRY], plan[layout.THREADS], plan[layout.PIECES]
        over_threads(entry, threads, plan[layout.PIECE_AT], pieces, 0.0, values, factors, work, plan)
    done = 0
    for at in range(plan[layout.PIECES_AT], plan[layout.PIECES_AT] + 3 * plan[layout.PIECES], 3):
        if plan[at + 2] == 0 or not factor_fronts(plan, values, factors, work, done, plan[at]):
            return False
        done = plan[at + 1]
    return factor_fronts(plan, values, factors, work, done, plan[1])
