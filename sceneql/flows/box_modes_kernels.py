# mypy: ignore-errors
"""Cosine, sine and Hartley transforms along an axis of a box, many rows side by side, each pair as a complex one.

Cosines come from the complex transform by Makhoul (1980), IEEE Trans. ASSP 28, 27-34. There and back a number comes out
times the length of the complex transform.
"""

from numba import types

from sceneql.compiled.arithmetic_kernels import widest
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.lanes_kernels import load, spread, store, turn_over
from sceneql.flows.fourier_kernels import fourier
from sceneql.flows.layout import (
    BOTH,
    FACTORS,
    FREE_FREE,
    FREE_NODES,
    KIND,
    LANES,
    LENGTH,
    NODES,
    NODES_FREE,
    PAD,
    PLAN,
    QUARTER_COSINES,
    QUARTER_SINES,
    SINES,
    TWIDDLES,
    TWISTS,
    WAVES,
)
from sceneql.system.signatures_kernels import A, F, I, N


@lean_inlined
def extended(j, kind, count, n, forward):
    """Which of an axis's numbers stands at place j of the sequence that is transformed, and its sign (0: none)."""
    if kind >= NODES:
        last = count - 1
        if kind == FREE_FREE:
            return (j if j <= last else n - j), 1.0
        if kind == NODES:
            return (j if j <= last else n - j), (0.0 if j % last == 0 else (1.0 if j < last else -1.0))
        sign = 1.0 if j <= 2 * last else -1.0
        if forward:
            place = j if j <= 2 * last else j - 2 * last
            place = place if place <= last else 2 * last - place
            sign = 0.0 if place == 0 else sign
            return (last - place if kind == FREE_NODES else place), sign
        k = j if j <= 2 * last else n - j
        return 1 + k // 2, (sign if k % 2 == 1 else 0.0)
    place = j if j < count else 2 * count - 1 - j
    sign = -1.0 if j >= count or (kind == SINES and j % 2 == 1) else 1.0
    return (count - 1 - place if kind == QUARTER_SINES else place), sign


@lean_inlined
def bring(x, raw, count, stride, step, lanes):
    """Numbers of rows ``step`` apart, the j-th of row l at 2 LANES j + l; 0 in rows from ``lanes`` on.

    By squares where rows' numbers are neighbors, so that a line of memory is read at a time.
    """
    first = 0
    if lanes == BOTH and stride == 1:
        first = count - count % LANES
        for j in range(0, first, LANES):
            turn_over(x, j, step, raw, BOTH * j, BOTH)
            turn_over(x, j + LANES * step, step, raw, BOTH * j + LANES, BOTH)
    for lane in range(BOTH):
        for j in range(first, count):
            raw[BOTH * j + lane] = x[j * stride + lane * step] if lane < lanes else 0.0


@lean_inlined
def take_back(raw, x, count, stride, step, lanes):
    """The way back of `bring`."""
    first = 0
    if lanes == BOTH and stride == 1:
        first = count - count % LANES
        for j in range(0, first, LANES):
            turn_over(raw, BOTH * j, BOTH, x, j, step)
            turn_over(raw, BOTH * j + LANES, BOTH, x, j + LANES * step, step)
    for lane in range(lanes):
        for j in range(first, count):
            x[j * stride + lane * step] = raw[BOTH * j + lane]


@lean_inlined
def laid_out(source, apart, z, kind, count, n, forward):
    """The sequences whose transforms are sought, of rows and of those LANES further on as imaginary parts.

    The numbers of a row stand ``apart`` in ``source``.
    """
    for j in range(n):
        place, sign = extended(j, kind, count, n, forward)
        to = BOTH * j
        if kind < WAVES:
            to = BOTH * (j // 2 if j % 2 == 0 else n - 1 - j // 2)
        store(z, to, sign * load(source, apart * place))
        store(z, to + LANES, sign * load(source, apart * place + LANES))


@lean_inlined
def turned_back(source, apart, z, halves, n, cosines, sines):
    """The sequences whose transforms are the numbers of which cosines are the modes (Makhoul 1980).

    The inverse is the forward transform with real and imaginary parts swapped.
    """
    for k in range(n):
        c, s, to = cosines[k], sines[k], BOTH * k
        here, there, first, second = apart * k, apart * (n - k), 1.0, (1.0 if k > 0 else 0.0)
        if halves:
            first = second = 1.0 * (k % 2)
            here, there = apart * (k // 2), apart * ((n - k) // 2)
        there = there if second > 0.0 else here
        a, b = first * load(source, here), first * load(source, here + LANES)
        an, bn = second * load(source, there), second * load(source, there + LANES)
        store(z, to + LANES, (c * a + s * an) - (s * b - c * bn))
        store(z, to, (s * a - c * an) + (c * b + s * bn))


@lean_inlined
def waves_of(z, target, apart, n):
    """Cosines plus sines of rows (Hartley's transform), two of which are in each complex sequence; in place, too."""
    for k in range(n // 2 + 1):
        here, mirror = BOTH * k, BOTH * ((n - k) % n)
        cr, ci, dr, di = load(z, here), load(z, here + LANES), load(z, mirror), load(z, mirror + LANES)
        even_re, even_im, odd_re, odd_im = 0.5 * (cr + dr), 0.5 * (ci + di), 0.5 * (ci - di), 0.5 * (dr - cr)
        to, beyond = apart * k, apart * ((n - k) % n)
        store(target, to, even_re - odd_re)
        store(target, to + LANES, even_im - odd_im)
        store(target, beyond, even_re + odd_re)
        store(target, beyond + LANES, even_im + odd_im)


@lean_inlined
def modes_of(z, target, apart, kind, count, n, forward, cosines, sines):
    """The modes of rows, two of which are in each complex sequence."""
    halves = kind == QUARTER_COSINES or kind == QUARTER_SINES
    for q in range(count):
        k = 2 * q + 1 if halves else q
        if (kind == NODES_FREE or kind == FREE_NODES) and forward:
            k = 2 * q - 1 if q > 0 else 0
        to = apart * (count - 1 - q if kind == FREE_NODES and not forward else q)
        here, mirror = BOTH * k, BOTH * ((n - k) % n)
        even, odd = 0.0, 1.0  # parts of the symmetric and of the antisymmetric sum
        if kind == FREE_FREE:
            even, odd = 1.0, 0.0
        elif kind < WAVES:
            even, odd = cosines[k], sines[k]
        cr, ci, dr, di = load(z, here), load(z, here + LANES), load(z, mirror), load(z, mirror + LANES)
        store(target, to, 0.5 * (even * (cr + dr) + odd * (ci - di)))
        store(target, to + LANES, 0.5 * (even * (ci + di) + odd * (dr - cr)))


@lean_inlined
def values_of(z, target, apart, kind, count, n):
    """The numbers of which cosines are the modes."""
    for q in range(count):
        at = BOTH * (q // 2 if q % 2 == 0 else n - 1 - q // 2)
        to = apart * (count - 1 - q if kind == QUARTER_SINES else q)
        sign = -1.0 if kind == SINES and q % 2 == 1 else 1.0
        store(target, to, sign * load(z, at + LANES))
        store(target, to + LANES, sign * load(z, at))


@lean(types.void(A, N, A, N, N, types.boolean, A, A, I), inner=True)
def one_way(source, apart, target, to_apart, count, forward, room, tables, plan):
    """Transform 2 LANES rows of ``count`` numbers ``apart``, forward or back, into others ``to_apart``.

    ``room``: 2 BOTH (length of the complex transform + 8) + 2 PAD; without these the two arrays of a length of a power
    of two would share their lines of the cache.
    """
    kind, n = plan[KIND], plan[LENGTH]
    wave = tables[plan[TWIDDLES] : plan[TWIDDLES] + 2 * n]
    cosines = tables[plan[TWISTS] : plan[TWISTS] + n]
    sines = tables[plan[TWISTS] + n : plan[TWISTS] + 2 * n]
    size = BOTH * n
    z, other, near = room[:size], room[size + PAD :][:size], room[2 * (size + PAD) :][: 16 * BOTH]
    back = kind < WAVES and not forward
    if kind == WAVES:
        if apart == BOTH:
            z = source
        else:
            for j in range(n):
                store(z, BOTH * j, load(source, apart * j))
                store(z, BOTH * j + LANES, load(source, apart * j + LANES))
    elif back:
        turned_back(source, apart, z, kind == QUARTER_COSINES or kind == QUARTER_SINES, n, cosines, sines)
    else:
        laid_out(source, apart, z, kind, count, n, forward)
    if fourier(z, other, near, n, wave, plan[FACTORS:]):
        z = other
    if kind == WAVES:
        waves_of(z, target, to_apart, n)
    elif back:
        values_of(z, target, to_apart, kind, count, n)
    else:
        modes_of(z, target, to_apart, kind, count, n, forward, cosines, sines)


@lean(types.void(A, N, N, N, N, N, N, types.boolean, A, A, I), inner=True)
def along(x, count, stride, rows, step, groups, outer, forward, tables, scratch, plan):
    """Transform x in place along an axis of ``count`` numbers ``stride`` apart, forward or back.

    Of each of ``groups`` groups, ``outer`` apart, there are ``rows`` rows, ``step`` apart. ``scratch``: 2 LANES count
    and the room of `one_way`.
    """
    widest()
    raw, room = scratch[: BOTH * count], scratch[BOTH * count :]
    batches = (rows + BOTH - 1) // (BOTH)
    for number in range(groups * batches):
        begin = BOTH * (number % batches)
        here = x[(number // batches) * outer + begin * step :]
        lanes = min(BOTH, rows - begin)
        if lanes == BOTH and step == 1:
            one_way(here, stride, here, stride, count, forward, room, tables, plan)
        else:
            bring(here, raw, count, stride, step, lanes)
            one_way(raw, BOTH, raw, BOTH, count, forward, room, tables, plan)
            take_back(raw, here, count, stride, step, lanes)


@lean_inlined
def copied(source, target, lanes):
    """Up to BOTH numbers."""
    if lanes == BOTH:
        store(target, 0, load(source, 0))
        store(target, LANES, load(source, LANES))
    else:
        for lane in range(lanes):
            target[lane] = source[lane]


@lean_inlined
def multiplied(mine, factors, lanes):
    """Up to BOTH numbers times factors, in place."""
    if lanes == BOTH:
        store(mine, 0, load(mine, 0) * load(factors, 0))
        store(mine, LANES, load(mine, LANES) * load(factors, LANES))
    else:
        for lane in range(lanes):
            mine[lane] *= factors[lane]


@lean(types.void(A, N, N, N, A, A, I, A, A, A, A, F, F), inner=True)
def through_modes_of_rows(x, nx, ny, nz, tables, scratch, plans, spectrum, along_x, along_y, along_z, a, size):
    """`through_modes` of x, whose rows along x are transformed already and stay so.

    Along the last axis a row goes there and back while it is in the cache.
    """
    widest()
    deep = nz > 1
    if deep:
        along(x, ny, nx, nx, 1, nz, nx * ny, True, tables, scratch, plans[PLAN : 2 * PLAN])
    count, rows = (nz, nx * ny) if deep else (ny, nx)
    plan = plans[2 * PLAN :] if deep else plans[PLAN : 2 * PLAN]
    own = along_z if deep else along_y
    raw, room = scratch[: BOTH * count], scratch[BOTH * count :]
    for begin in range(0, rows, BOTH):
        lanes, here = min(BOTH, rows - begin), x[begin:]
        if lanes == BOTH:
            one_way(here, rows, raw, BOTH, count, True, room, tables, plan)
        else:
            bring(here, raw, count, rows, 1, lanes)
            one_way(raw, BOTH, raw, BOTH, count, True, room, tables, plan)
        for q in range(count):
            mine = raw[BOTH * q :]
            if spectrum.size > 0:
                multiplied(mine, spectrum[begin * count + lanes * q :], lanes)
            elif deep:
                for lane in range(lanes):
                    j, i = (begin + lane) // nx, (begin + lane) % nx
                    mine[lane] /= size * (1.0 + a * (own[q] + along_y[j])) + size * a * along_x[i]
            else:
                both, beside = size * (1.0 + a * own[q]), along_x[begin:]
                for lane in range(lanes):
                    mine[lane] /= both + size * a * beside[lane]
        if lanes == BOTH:
            one_way(raw, BOTH, here, rows, count, False, room, tables, plan)
        else:
            one_way(raw, BOTH, raw, BOTH, count, False, room, tables, plan)
            take_back(raw, here, count, rows, 1, lanes)
    if deep:
        along(x, ny, nx, nx, 1, nz, nx * ny, False, tables, scratch, plans[PLAN : 2 * PLAN])


@lean(types.void(A, N, N, N, A, A, I, A, A, A, A, F, F), inner=True)
def through_modes(x, nx, ny, nz, tables, scratch, plans, spectrum, along_x, along_y, along_z, a, size):
    """Multiply the eigenmodes of x by ``spectrum`` (cells,), in place; where that is empty, divide them by ``size``
    times 1 + a times the sum of their decay rates along the axes."""
    along(x, nx, 1, ny * nz, nx, 1, 0, True, tables, scratch, plans[:PLAN])
    through_modes_of_rows(x, nx, ny, nz, tables, scratch, plans, spectrum, along_x, along_y, along_z, a, size)
    along(x, nx, 1, ny * nz, nx, 1, 0, False, tables, scratch, plans[:PLAN])


@lean_inlined
def rows_along_x(x, nx, ny, nz, box, few, forward, tables, scratch, plans):
    """Transform rows along x, all or a few of few planes."""
    first, last, back, front = box
    if not few:
        first, last, back, front = 0, ny, 0, nz
    whole = last - first == ny
    here, count = x[nx * (first + ny * back) :], (last - first) * (front - back if whole else 1)
    along(here, nx, 1, count, nx, 1 if whole else front - back, nx * ny, forward, tables, scratch, plans[:PLAN])


@lean(types.void(A, N, N, N, A, A, I, A, types.UniTuple(N, 4), types.boolean, types.boolean), inner=True)
def through_few_rows(x, nx, ny, nz, tables, scratch, plans, spectrum, box, from_few, to_few):
    """`through_modes` where all is 0 but in few rows (``from_few``; of a flat x these are read alone, of a deep one
    their planes) or no others are wanted.

    ``box``: from and to before which row along y, and along z. Along the last axis a row goes there and back while it
    is in the cache, so that memory gives and takes few rows.
    """
    widest()
    first, last, back, front = box
    plane, deep = nx * ny, nz > 1
    rows_along_x(x, nx, ny, nz, box, from_few, True, tables, scratch, plans)
    begin, count = (back, front - back) if from_few else (0, nz)
    if deep:
        along(x[begin * plane :], ny, nx, nx, 1, count, plane, True, tables, scratch, plans[PLAN : 2 * PLAN])
    count, rows = (nz, plane) if deep else (ny, nx)
    low, high = (back, front) if deep else (first, last)
    plan = plans[2 * PLAN :] if deep else plans[PLAN : 2 * PLAN]
    raw, room = scratch[: BOTH * count], scratch[BOTH * count :]
    for begin in range(0, rows, BOTH):
        lanes = min(BOTH, rows - begin)
        for q in range(count):
            mine = raw[BOTH * q :]
            if lanes < BOTH or (from_few and not low <= q < high):
                store(mine, 0, spread(0.0))
                store(mine, LANES, spread(0.0))
            if low <= q < high or not from_few:
                copied(x[rows * q + begin :], mine, lanes)
        one_way(raw, BOTH, raw, BOTH, count, True, room, tables, plan)
        for q in range(count):
            multiplied(raw[BOTH * q :], spectrum[begin * count + lanes * q :], lanes)
        one_way(raw, BOTH, raw, BOTH, count, False, room, tables, plan)
        for q in range(low if to_few else 0, high if to_few else count):
            copied(raw[BOTH * q :], x[rows * q + begin :], lanes)
    begin, count = (back, front - back) if to_few else (0, nz)
    if deep:
        along(x[begin * plane :], ny, nx, nx, 1, count, plane, False, tables, scratch, plans[PLAN : 2 * PLAN])
    rows_along_x(x, nx, ny, nz, box, to_few, False, tables, scratch, plans)
