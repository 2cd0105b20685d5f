# mypy: ignore-errors
"""The equation of a flat box by transforms along x alone: of each mode there is left one along y, which is tridiagonal
and solved by elimination, row after row as memory gives them (Hockney 1965, J. ACM 12, 95-113; Buzbee, Golub & Nielson
1970, SIAM J. Numer. Anal. 7, 627-656).

Of a mode it is b x_j - x_(j-1) - x_(j+1) = w_j. Up the rows f_j = c_j (w_j + f_(j-1)) with c_j = 1/(b - c_(j-1)), then
down again x_j = f_j + c_j x_(j+1). After some rows c_j does not change any more, so that only the modes where it still
does, a row's first and last, have it kept for each row. Around a periodic axis x of the last row is an unknown of its
own: its part in x_j is the product l of all c up to c_j. The mode that is known up to a constant alone is summed up.
"""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows.box_modes_kernels import along
from sceneql.flows.layout import (
    BOTH,
    FREE_FREE,
    FREE_NODES,
    LANES,
    NODES,
    NODES_FREE,
    QUARTER_COSINES,
    QUARTER_SINES,
    SINES,
    WAVES,
)
from sceneql.system.signatures_kernels import A, F, I, N

FEWEST = 4
"""Rows that this needs."""
BAND = 4096
"""Cells of a band of rows that the cache holds."""
SCALE, AROUND, SINGULAR, LOW, HIGH, HEAD = range(6)
VECTORS = 8
"""What a store begins with: the factor of what is given; 1 where the rows are periodic; what the mean of the first mode
is multiplied by where that is known up to a constant, else 0; what of the first and of the last row counts. Then for
each row from and to before which mode c is as at the end, and where the others' c begin; VECTORS numbers a mode: what b
is above 2, c at the end, c of the last row, sums, x of the row above and of the last row, and two while the store is
filled; and for each row the first mode where it is summed up."""
SAME, NOTHING, TINY = 2.3e-16, 1e-18, 1e-280
"""A change of c that is rounding; l that is none; numbers that count as 0, below which processors are slow."""


@lean_inlined
def prior(kind, high):
    """What c before the first row, or after the last, would stand for an end where values are at centers."""
    if kind == WAVES or kind >= NODES:
        return 0.0
    zero = kind == SINES or kind == (QUARTER_COSINES if high else QUARTER_SINES)
    return -1.0 if zero else 1.0


@lean_inlined
def at_node(kind, high):
    """Of an end with a face on it: 1 where values are 0 there, 2 where they are free; else 0."""
    if kind < NODES:
        return 0
    free = kind == FREE_FREE or kind == (NODES_FREE if high else FREE_NODES)
    return 2 if free else 1


@lean_inlined
def next_entry(above, before, beyond, node, own):
    """c of a row from that of the one before it, by what stands beyond an end."""
    if node == 1:
        return 0.0
    return 1.0 / ((2.0 + above) * (0.5 if node == 2 else 1.0) - before - beyond)


@lean(types.int64(A, N, N, N, F, F, F, A, F, F))
def prepare(store, nx, ny, kind, least, shift, factor, along_x, tie, length):
    """Fill a store for the equation (shift + factor along_x(mode)) x_j + tie (2 x_j - x_(j-1) - x_(j+1)) = given, along
    an axis with modes of a kind, of rows that are transformed there and back times ``length``; how many numbers that
    took, -1: it is too small. ``least``: what the sum of the first mode is divided by, where that is known up to a
    constant; else 0.
    """
    singular = least > 0.0
    rows, modes, zero = HEAD, HEAD + 3 * ny, HEAD + 3 * ny + VECTORS * nx
    free = zero + ny
    if ny < FEWEST or not tie > 0.0 or free > store.size:
        return -1
    above, limit, top = store[modes:], store[modes + nx :], store[modes + 2 * nx :]
    c, product = store[modes + 6 * nx :], store[modes + 7 * nx :]
    around = kind == WAVES
    low, high = at_node(kind, False), at_node(kind, True)
    store[SCALE], store[AROUND] = 1.0 / (tie * length), 1.0 * around
    store[SINGULAR] = tie / least if singular else 0.0
    store[LOW], store[HIGH] = 0.5 if low == 2 else 1.0, 0.5 if high == 2 else 1.0
    most = 0
    for i in range(nx):
        above[i] = (shift + factor * along_x[i]) / tie
        most = i if above[i] > above[most] else most
        c[i], product[i], limit[i] = 0.0, 1.0, 0.0
    if singular:
        above[0] = 1.0
    first = nx if most >= nx - 1 else (0 if most == 0 else most - most % LANES)
    last = first
    for j in range(ny - 1):
        count = first + nx - last
        store[rows + j], store[rows + ny + j], store[rows + 2 * ny + j] = first, last, free
        if free + 2 * count > store.size:
            return -1
        begin, node = (prior(kind, False), low) if j == 0 else (0.0, 0)
        for way in range(2):
            a, b, to = (0, first, free) if way == 0 else (last, nx, free + first - last)
            for i in range(a, b):
                new = next_entry(above[i], c[i], begin, node, 0.0)
                limit[i] = new if j > 0 and abs(new - c[i]) <= SAME * new else -1.0
                c[i] = new
                store[to + i] = new
                if around:
                    product[i] = product[i] * new
                    product[i] = 0.0 if product[i] < NOTHING else product[i]
                    limit[i] = -1.0 if product[i] > 0.0 else limit[i]
                    store[to + count + i] = product[i]
        free += 2 * count if around else count
        while first > 0:
            begin_of, done = (first - 1) // LANES * LANES, True
            for i in range(begin_of, first):
                done &= limit[i] >= 0.0
            if not done:
                break
            first = begin_of
        while last < nx:
            end_of, done = min(nx, (last // LANES + 1) * LANES), True
            for i in range(last, end_of):
                done &= limit[i] >= 0.0
            if not done:
                break
            last = end_of
    for i in range(nx):
        if around:
            top[i] = 1.0 / (2.0 + above[i] - 2.0 * (c[i] + product[i]))
        else:
            top[i] = next_entry(above[i], c[i], prior(kind, True), high, 0.0)
        limit[i] = c[i]
    return free


@lean_inlined
def up(own, before, c, products, sums, scale, given, more, keeps, count):
    """Elimination in some modes of a row: ``given``: whether there is anything in it; ``more``: in those before it."""
    for i in range(count):
        g = (scale * own[i] if given else 0.0) + (before[i] if more else 0.0)
        g = g if abs(g) > TINY else 0.0
        if keeps:
            sums[i] += products[i] * g
        own[i] = c[i] * g


@lean_inlined
def down(own, after, c, products, last, keeps, count):
    """The way back."""
    for i in range(count):
        found = own[i] + c[i] * after[i]
        if keeps:
            found += products[i] * last[i]
        own[i] = found if abs(found) > TINY else 0.0


@lean_inlined
def summed_up(line, ny, around, part):
    """Solve -x_(j-1) + 2 x_j - x_(j+1) = w_j less its mean, of which x has a part, where nothing crosses the ends."""
    total = 0.0
    for j in range(ny):
        total += line[j]
    mean, slope, slopes = total / ny, 0.0, 0.0
    for j in range(ny):
        slope -= line[j] - mean
        slopes += slope
    slope, x, total = (-slopes / ny if around else 0.0), 0.0, 0.0
    for j in range(ny):
        given = line[j] - mean
        line[j] = x
        total += x
        slope -= given
        x += slope
    more = part * mean - total / ny
    for j in range(ny):
        line[j] += more


@lean(types.void(A, N, N, N, N, N, N, A), inner=True)
def rows_up(x, nx, ny, begin, end, first, last, store):
    """Elimination in rows of x from ``begin`` to before ``end``: all that is given stands in those from ``first`` to
    before ``last``, the others are not read, and those before ``first`` are left alone."""
    modes, zero = HEAD + 3 * ny, HEAD + 3 * ny + VECTORS * nx
    limit, top, sums = store[modes + nx :], store[modes + 2 * nx :], store[modes + 3 * nx :]
    around, singular = store[AROUND] == 1.0, store[SINGULAR] > 0.0
    line = store[zero : zero + ny]
    if begin <= first:
        for i in range(nx):
            sums[i] = 0.0
        for j in range(ny):
            line[j] = 0.0
    for j in range(max(begin, first), end):
        scale = store[SCALE] * (store[LOW] if j == 0 else (store[HIGH] if j == ny - 1 else 1.0))
        given, more = j < last, j > first
        own, before = x[nx * j :], x[nx * (j - 1 if more else j) :]
        if singular and given:
            line[j] = scale * own[0]
        if j == ny - 1:
            if around:
                for i in range(nx):
                    g = (scale * own[i] if given else 0.0) + sums[i] + (before[i] if more else 0.0)
                    own[i] = top[i] * g
            else:
                up(own, before, top, top, sums, scale, given, more, False, nx)
            if singular:
                summed_up(line, ny, around, store[SINGULAR])
                own[0] = line[j]
            after, beyond = store[modes + 4 * nx :], store[modes + 5 * nx :]
            for i in range(nx):
                after[i] = beyond[i] = own[i]
            continue
        a, b, at = int(store[HEAD + j]), int(store[HEAD + ny + j]), int(store[HEAD + 2 * ny + j])
        c, count = store[at:], a + nx - b
        products = store[at + count :] if around else c
        up(own, before, c, products, sums, scale, given, more, around, a)
        up(own[a:], before[a:], limit[a:], limit, sums, scale, given, more, False, b - a)
        up(own[b:], before[b:], c[a:], products[a:], sums[b:], scale, given, more, around, nx - b)


@lean(types.void(A, N, N, N, N, N, A), inner=True)
def rows_down(x, nx, ny, begin, end, first, store):
    """The way back, from row ``end`` - 1 to row ``begin``; nothing was given before row ``first``."""
    modes, zero = HEAD + 3 * ny, HEAD + 3 * ny + VECTORS * nx
    limit, around, singular = store[modes + nx :], store[AROUND] == 1.0, store[SINGULAR] > 0.0
    kept, top = store[modes + 4 * nx :], store[modes + 5 * nx :]
    after = kept
    for number in range(begin, min(end, ny - 1)):
        j = begin + min(end, ny - 1) - 1 - number
        own = x[nx * j :]
        if j < first:
            for i in range(nx):
                own[i] = 0.0
        a, b, at = int(store[HEAD + j]), int(store[HEAD + ny + j]), int(store[HEAD + 2 * ny + j])
        c, count = store[at:], a + nx - b
        products = store[at + count :] if around else c
        down(own, after, c, products, top, around, a)
        down(own[a:], after[a:], limit[a:], limit, top, False, b - a)
        down(own[b:], after[b:], c[a:], products[a:], top[b:], around, nx - b)
        if singular:
            own[0] = store[zero + j]
        after = own
    for i in range(nx):
        kept[i] = after[i]


@lean(types.void(A, N, N, A, A, I, A, types.UniTuple(N, 2), types.boolean, types.boolean), inner=True)
def through_lines(x, nx, ny, tables, scratch, plan, store, few, from_few, to_few):
    """Solve the equation of a store for x (ny, nx), in place; ``plan``: of the transforms along x.

    ``few``: from and to before which row; where ``from_few`` all else is 0 and not read, where ``to_few`` not wanted.
    """
    rows = BOTH * max(1, BAND // (BOTH * nx))
    first, last = few if from_few else (0, ny)
    for begin in range(first, last, rows):
        end = min(last, begin + rows)
        along(x[nx * begin :], nx, 1, end - begin, nx, 1, 0, True, tables, scratch, plan)
        rows_up(x, nx, ny, begin, end, first, last, store)
    if last < ny:
        rows_up(x, nx, ny, last, ny, first, last, store)
    begin, end = few if to_few else (0, ny)
    if end < ny:
        rows_down(x, nx, ny, end, ny, first, store)
    for number in range((end - begin + rows - 1) // rows):
        stop = end - number * rows
        start = max(begin, stop - rows)
        rows_down(x, nx, ny, start, stop, first, store)
        along(x[nx * start :], nx, 1, stop - start, nx, 1, 0, False, tables, scratch, plan)
