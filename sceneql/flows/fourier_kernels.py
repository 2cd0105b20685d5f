# mypy: ignore-errors
"""Cosine, sine and Hartley transforms along an axis of a box, many rows side by side, each pair as a complex one.

The complex transform is Stockham's, of any length, by factors 4, 2, 3, 5 and other primes (Van Loan, Computational
Frameworks for the Fast Fourier Transform (1992), 1.7); cosines come from it by Makhoul (1980), IEEE Trans. ASSP 28,
27-34. There and back a number comes out times the length of the complex transform.
"""

from math import cos, pi, sin

from numba import types

from sceneql.compiled.arithmetic_kernels import widest
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.lanes_kernels import load, spread, store, turn_over
from sceneql.flows.layout import (
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
from sceneql.system.signatures_kernels import A, I, N

SINE_3 = sin(2 * pi / 3)
COSINE_5, COSINE_52, SINE_5, SINE_52 = cos(2 * pi / 5), cos(4 * pi / 5), sin(2 * pi / 5), sin(4 * pi / 5)


@lean_inlined
def by_two(re, im, to_re, to_im, at, far, into, width, wave, n, turn):
    """One butterfly of two for all lanes."""
    c, s = wave[turn], -wave[n + turn]
    for q in range(0, width, LANES):
        first, o = at + q, into + q
        ar, ai, br, bi = load(re, first), load(im, first), load(re, first + far), load(im, first + far)
        dr, di = ar - br, ai - bi
        store(to_re, o, ar + br)
        store(to_im, o, ai + bi)
        store(to_re, o + width, dr * c - di * s)
        store(to_im, o + width, dr * s + di * c)


@lean_inlined
def by_four(re, im, to_re, to_im, at, far, into, width, wave, n, turn):
    """One butterfly of four for all lanes."""
    c1, s1, c2, s2 = wave[turn], -wave[n + turn], wave[2 * turn], -wave[n + 2 * turn]
    c3, s3 = wave[3 * turn], -wave[n + 3 * turn]
    for q in range(0, width, LANES):
        k, o = at + q, into + q
        ar, ai, br, bi = load(re, k), load(im, k), load(re, k + far), load(im, k + far)
        cr, ci = load(re, k + 2 * far), load(im, k + 2 * far)
        dr, di = load(re, k + 3 * far), load(im, k + 3 * far)
        er, ei, fr, fi, gr, gi, hr, hi = ar + cr, ai + ci, ar - cr, ai - ci, br + dr, bi + di, br - dr, bi - di
        store(to_re, o, er + gr)
        store(to_im, o, ei + gi)
        xr, xi = fr + hi, fi - hr
        store(to_re, o + width, xr * c1 - xi * s1)
        store(to_im, o + width, xr * s1 + xi * c1)
        xr, xi = er - gr, ei - gi
        store(to_re, o + 2 * width, xr * c2 - xi * s2)
        store(to_im, o + 2 * width, xr * s2 + xi * c2)
        xr, xi = fr - hi, fi + hr
        store(to_re, o + 3 * width, xr * c3 - xi * s3)
        store(to_im, o + 3 * width, xr * s3 + xi * c3)


@lean_inlined
def turned(to_re, to_im, o, xr, xi, wave, n, turn):
    """Store a number times exp(-2 pi i turn/n)."""
    c, s = wave[turn], -wave[n + turn]
    store(to_re, o, xr * c - xi * s)
    store(to_im, o, xr * s + xi * c)


@lean_inlined
def by_three(re, im, to_re, to_im, at, far, into, width, wave, n, turn):
    """One butterfly of three for all lanes."""
    for q in range(0, width, LANES):
        k, o = at + q, into + q
        ar, ai, br, bi = load(re, k), load(im, k), load(re, k + far), load(im, k + far)
        cr, ci = load(re, k + 2 * far), load(im, k + 2 * far)
        er, ei, fr, fi = br + cr, bi + ci, SINE_3 * (br - cr), SINE_3 * (bi - ci)
        gr, gi = ar - 0.5 * er, ai - 0.5 * ei
        store(to_re, o, ar + er)
        store(to_im, o, ai + ei)
        turned(to_re, to_im, o + width, gr + fi, gi - fr, wave, n, turn)
        turned(to_re, to_im, o + 2 * width, gr - fi, gi + fr, wave, n, 2 * turn)


@lean_inlined
def by_five(re, im, to_re, to_im, at, far, into, width, wave, n, turn):
    """One butterfly of five for all lanes."""
    for q in range(0, width, LANES):
        k, o = at + q, into + q
        ar, ai, br, bi = load(re, k), load(im, k), load(re, k + far), load(im, k + far)
        cr, ci = load(re, k + 2 * far), load(im, k + 2 * far)
        dr, di = load(re, k + 3 * far), load(im, k + 3 * far)
        er, ei = load(re, k + 4 * far), load(im, k + 4 * far)
        pr, pm, qr, qi, ur, ui, vr, vi = br + er, bi + ei, br - er, bi - ei, cr + dr, ci + di, cr - dr, ci - di
        store(to_re, o, ar + (pr + ur))
        store(to_im, o, ai + (pm + ui))
        xr, xi = ar + (COSINE_5 * pr + COSINE_52 * ur), ai + (COSINE_5 * pm + COSINE_52 * ui)
        yr, yi = SINE_5 * qr + SINE_52 * vr, SINE_5 * qi + SINE_52 * vi
        turned(to_re, to_im, o + width, xr + yi, xi - yr, wave, n, turn)
        turned(to_re, to_im, o + 4 * width, xr - yi, xi + yr, wave, n, 4 * turn)
        xr, xi = ar + (COSINE_52 * pr + COSINE_5 * ur), ai + (COSINE_52 * pm + COSINE_5 * ui)
        yr, yi = SINE_52 * qr - SINE_5 * vr, SINE_52 * qi - SINE_5 * vi
        turned(to_re, to_im, o + 2 * width, xr + yi, xi - yr, wave, n, 2 * turn)
        turned(to_re, to_im, o + 3 * width, xr - yi, xi + yr, wave, n, 3 * turn)


@lean_inlined
def by_many(re, im, to_re, to_im, p, m, r, width, wave, n, fold):
    """One butterfly of r for all lanes."""
    for k in range(r):
        o, begin, apart = (r * p + k) * width, p * k * fold % n, k * (n // r)
        for q in range(0, width, LANES):
            sum_re, sum_im, turn = spread(0.0), spread(0.0), begin
            for j in range(r):
                c, s, at = wave[turn], -wave[n + turn], (p + j * m) * width + q
                xr, xi = load(re, at), load(im, at)
                sum_re, sum_im = sum_re + (xr * c - xi * s), sum_im + (xr * s + xi * c)
                turn += apart
                turn -= n if turn >= n else 0
            store(to_re, o + q, sum_re)
            store(to_im, o + q, sum_im)


@lean(types.boolean(A, A, A, A, N, A, I), inner=True)
def fourier(re, im, other_re, other_im, n, wave, factors):
    """sum over j of x_j exp(-2 pi i j k/n) of LANES sequences, entry j of lane l at LANES j + l; ``wave``: (2 n,).

    Whether the result stands in the other pair of arrays.
    """
    swapped = False
    left, width = n, LANES
    for number in range(1, factors[0] + 1):
        r = factors[number]
        m = left // r
        fold = n // left
        for p in range(m):
            if r == 2:
                by_two(re, im, other_re, other_im, p * width, m * width, 2 * p * width, width, wave, n, p * fold)
            elif r == 4:
                by_four(re, im, other_re, other_im, p * width, m * width, 4 * p * width, width, wave, n, p * fold)
            elif r == 3:
                by_three(re, im, other_re, other_im, p * width, m * width, 3 * p * width, width, wave, n, p * fold)
            elif r == 5:
                by_five(re, im, other_re, other_im, p * width, m * width, 5 * p * width, width, wave, n, p * fold)
            else:
                by_many(re, im, other_re, other_im, p, m, r, width, wave, n, fold)
        re, other_re, im, other_im = other_re, re, other_im, im
        swapped = not swapped
        left = m
        width *= r
    return swapped


@lean_inlined
def extended(j, kind, count, n, forward):
    """Which of an axis's numbers stands at place j of the sequence that is transformed, and its sign (0: none)."""
    if kind == WAVES:
        return j, 1.0
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
    if lanes == 2 * LANES and step == 1:
        for j in range(count):
            store(raw, 2 * LANES * j, load(x, j * stride))
            store(raw, 2 * LANES * j + LANES, load(x, j * stride + LANES))
        return
    first = 0
    if lanes == 2 * LANES and stride == 1:
        first = count - count % LANES
        for j in range(0, first, LANES):
            turn_over(x, j, step, raw, 2 * LANES * j, 2 * LANES)
            turn_over(x, j + LANES * step, step, raw, 2 * LANES * j + LANES, 2 * LANES)
    for lane in range(2 * LANES):
        for j in range(first, count):
            raw[2 * LANES * j + lane] = x[j * stride + lane * step] if lane < lanes else 0.0


@lean_inlined
def take_back(raw, x, count, stride, step, lanes):
    """The way back of `bring`."""
    if lanes == 2 * LANES and step == 1:
        for j in range(count):
            store(x, j * stride, load(raw, 2 * LANES * j))
            store(x, j * stride + LANES, load(raw, 2 * LANES * j + LANES))
        return
    first = 0
    if lanes == 2 * LANES and stride == 1:
        first = count - count % LANES
        for j in range(0, first, LANES):
            turn_over(raw, 2 * LANES * j, 2 * LANES, x, j, step)
            turn_over(raw, 2 * LANES * j + LANES, 2 * LANES, x, j + LANES * step, step)
    for lane in range(lanes):
        for j in range(first, count):
            x[j * stride + lane * step] = raw[2 * LANES * j + lane]


@lean_inlined
def laid_out(raw, re, im, kind, count, n, forward):
    """The sequences whose transforms are sought, of rows and of those LANES further on as imaginary parts."""
    for j in range(n):
        place, sign = extended(j, kind, count, n, forward)
        to = LANES * j
        if kind < WAVES:
            to = LANES * (j // 2 if j % 2 == 0 else n - 1 - j // 2)
        at = 2 * LANES * place
        store(re, to, sign * load(raw, at))
        store(im, to, sign * load(raw, at + LANES))


@lean_inlined
def turned_back(raw, re, im, halves, n, cosines, sines):
    """The sequences whose transforms are the numbers of which cosines are the modes (Makhoul 1980).

    The inverse is the forward transform with real and imaginary parts swapped.
    """
    for k in range(n):
        c, s, to = cosines[k], sines[k], LANES * k
        here, there, first, second = 2 * LANES * k, 2 * LANES * (n - k), 1.0, (1.0 if k > 0 else 0.0)
        if halves:
            first = second = 1.0 * (k % 2)
            here, there = 2 * LANES * (k // 2), 2 * LANES * ((n - k) // 2)
        there = there if second > 0.0 else here
        a, b = first * load(raw, here), first * load(raw, here + LANES)
        an, bn = second * load(raw, there), second * load(raw, there + LANES)
        store(im, to, (c * a + s * an) - (s * b - c * bn))
        store(re, to, (s * a - c * an) + (c * b + s * bn))


@lean_inlined
def modes_of(re, im, raw, kind, count, n, forward, cosines, sines):
    """The modes of rows, two of which are in each complex sequence."""
    halves = kind == QUARTER_COSINES or kind == QUARTER_SINES
    for q in range(count):
        k = 2 * q + 1 if halves else q
        if (kind == NODES_FREE or kind == FREE_NODES) and forward:
            k = 2 * q - 1 if q > 0 else 0
        to = 2 * LANES * (count - 1 - q if kind == FREE_NODES and not forward else q)
        here, mirror = LANES * k, LANES * ((n - k) % n)
        even, odd = 0.0, 1.0  # parts of the symmetric and of the antisymmetric sum
        if kind == WAVES:
            even, odd = 1.0, -1.0
        elif kind == FREE_FREE:
            even, odd = 1.0, 0.0
        elif kind < WAVES:
            even, odd = cosines[k], sines[k]
        cr, ci, dr, di = load(re, here), load(im, here), load(re, mirror), load(im, mirror)
        store(raw, to, 0.5 * (even * (cr + dr) + odd * (ci - di)))
        store(raw, to + LANES, 0.5 * (even * (ci + di) + odd * (dr - cr)))


@lean_inlined
def values_of(re, im, raw, kind, count, n):
    """The numbers of which cosines are the modes."""
    for q in range(count):
        at = LANES * (q // 2 if q % 2 == 0 else n - 1 - q // 2)
        to = 2 * LANES * (count - 1 - q if kind == QUARTER_SINES else q)
        sign = -1.0 if kind == SINES and q % 2 == 1 else 1.0
        store(raw, to, sign * load(im, at))
        store(raw, to + LANES, sign * load(re, at))


@lean(types.void(A, N, N, N, N, N, N, types.boolean, A, A, I), inner=True)
def along(x, count, stride, rows, step, groups, outer, forward, tables, scratch, plan):
    """Transform x in place along an axis of ``count`` numbers ``stride`` apart, forward or back.

    Of each of ``groups`` groups, ``outer`` apart, there are ``rows`` rows, ``step`` apart. ``scratch``: 2 LANES count +
    4 LANES (length of the complex transform) + 3 PAD; without these the four arrays of a length of a power of two would
    share their lines of the cache.
    """
    widest()
    kind, n = plan[KIND], plan[LENGTH]
    wave = tables[plan[TWIDDLES] : plan[TWIDDLES] + 2 * n]
    cosines = tables[plan[TWISTS] : plan[TWISTS] + n]
    sines = tables[plan[TWISTS] + n : plan[TWISTS] + 2 * n]
    size, at, apart = n * LANES, 2 * LANES * count, n * LANES + PAD
    raw = scratch[:at]
    for number in range(groups * ((rows + 2 * LANES - 1) // (2 * LANES))):
        batches = (rows + 2 * LANES - 1) // (2 * LANES)
        begin = 2 * LANES * (number % batches)
        here = x[(number // batches) * outer + begin * step :]
        lanes = min(2 * LANES, rows - begin)
        re, im = scratch[at : at + size], scratch[at + apart : at + apart + size]
        more_re, more_im = scratch[at + 2 * apart :][:size], scratch[at + 3 * apart :][:size]
        bring(here, raw, count, stride, step, lanes)
        back = kind < WAVES and not forward
        if back:
            turned_back(raw, re, im, kind == QUARTER_COSINES or kind == QUARTER_SINES, n, cosines, sines)
        else:
            laid_out(raw, re, im, kind, count, n, forward)
        if fourier(re, im, more_re, more_im, n, wave, plan[FACTORS:]):
            re, im = more_re, more_im
        if back:
            values_of(re, im, raw, kind, count, n)
        else:
            modes_of(re, im, raw, kind, count, n, forward, cosines, sines)
        take_back(raw, here, count, stride, step, lanes)


@lean(types.void(A, N, N, N, N, N, N, N, types.boolean, A, A, I), inner=True)
def transform_of_rows(x, nx, ny, nz, first, last, back, front, forward, tables, scratch, plans):
    """`transform`, forward where all is 0 but rows from ``first`` to before ``last`` along y, ``back`` to before
    ``front`` along z; back where no others are wanted."""
    plane, deep = nx * ny, front - back
    for turn in range(3):
        axis = turn if forward else 2 - turn
        if axis == 0 and last - first == ny:
            along(x[back * plane :], nx, 1, ny * deep, nx, 1, 0, forward, tables, scratch, plans[:PLAN])
        elif axis == 0:
            here = x[back * plane + first * nx :]
            along(here, nx, 1, last - first, nx, deep, plane, forward, tables, scratch, plans[:PLAN])
        elif axis == 1:
            along(x[back * plane :], ny, nx, nx, 1, deep, plane, forward, tables, scratch, plans[PLAN : 2 * PLAN])
        elif nz > 1:
            along(x, nz, plane, plane, 1, 1, 0, forward, tables, scratch, plans[2 * PLAN : 3 * PLAN])


@lean(types.void(A, N, N, N, types.boolean, A, A, I), inner=True)
def transform(x, nx, ny, nz, forward, tables, scratch, plans):
    """Transform x in place along all its axes."""
    along(x, nx, 1, ny * nz, nx, 1, 0, forward, tables, scratch, plans[:PLAN])
    along(x, ny, nx, nx, 1, nz, nx * ny, forward, tables, scratch, plans[PLAN : 2 * PLAN])
    if nz > 1:
        along(x, nz, nx * ny, nx * ny, 1, 1, 0, forward, tables, scratch, plans[2 * PLAN : 3 * PLAN])
