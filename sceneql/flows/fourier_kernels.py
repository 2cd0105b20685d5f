# mypy: ignore-errors
"""Cosine, sine and Hartley transforms along an axis of a box, many rows side by side, each pair as a complex one.

The complex transform is Stockham's, of any length, by factors 4, 2, 3, 5 and other primes (Van Loan, Computational
Frameworks for the Fast Fourier Transform (1992), 1.7); cosines come from it by Makhoul (1980), IEEE Trans. ASSP 28,
27-34. There and back a number comes out times the length of the complex transform.
"""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows.layout import (
    FACTORS,
    FREE_FREE,
    FREE_NODES,
    KIND,
    LANES,
    LENGTH,
    NODES,
    NODES_FREE,
    PLAN,
    QUARTER_COSINES,
    QUARTER_SINES,
    SINES,
    TWIDDLES,
    TWISTS,
    WAVES,
)
from sceneql.system.signatures_kernels import A, I, N


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
                c, s = wave[p * fold], -wave[n + p * fold]
                first, second, into = p * width, (p + m) * width, 2 * p * width
                for q in range(width):
                    ar, ai, br, bi = re[first + q], im[first + q], re[second + q], im[second + q]
                    other_re[into + q], other_im[into + q] = ar + br, ai + bi
                    dr, di = ar - br, ai - bi
                    other_re[into + width + q], other_im[into + width + q] = dr * c - di * s, dr * s + di * c
            elif r == 4:
                c1, s1 = wave[p * fold], -wave[n + p * fold]
                c2, s2 = wave[2 * p * fold], -wave[n + 2 * p * fold]
                c3, s3 = wave[3 * p * fold], -wave[n + 3 * p * fold]
                at, into, far = p * width, 4 * p * width, m * width
                for q in range(width):
                    k = at + q
                    er, ei = re[k] + re[k + 2 * far], im[k] + im[k + 2 * far]
                    fr, fi = re[k] - re[k + 2 * far], im[k] - im[k + 2 * far]
                    gr, gi = re[k + far] + re[k + 3 * far], im[k + far] + im[k + 3 * far]
                    hr, hi = re[k + far] - re[k + 3 * far], im[k + far] - im[k + 3 * far]
                    o = into + q
                    other_re[o], other_im[o] = er + gr, ei + gi
                    xr, xi = fr + hi, fi - hr
                    other_re[o + width], other_im[o + width] = xr * c1 - xi * s1, xr * s1 + xi * c1
                    xr, xi = er - gr, ei - gi
                    other_re[o + 2 * width], other_im[o + 2 * width] = xr * c2 - xi * s2, xr * s2 + xi * c2
                    xr, xi = fr - hi, fi + hr
                    other_re[o + 3 * width], other_im[o + 3 * width] = xr * c3 - xi * s3, xr * s3 + xi * c3
            else:
                for k in range(r):
                    o = (r * p + k) * width
                    for q in range(width):
                        other_re[o + q] = other_im[o + q] = 0.0
                    for j in range(r):
                        turn = (j * k * (n // r) + p * k * fold) % n
                        c, s, at = wave[turn], -wave[n + turn], (p + j * m) * width
                        for q in range(width):
                            other_re[o + q] += re[at + q] * c - im[at + q] * s
                            other_im[o + q] += re[at + q] * s + im[at + q] * c
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


@lean(types.void(A, N, N, N, N, N, types.boolean, A, A, I), inner=True)
def along(x, count, stride, rows, inner, outer, forward, tables, scratch, plan):
    """Transform x in place along an axis of ``count`` numbers ``stride`` apart, forward or back.

    Row c begins at (c // inner) outer + c % inner. ``scratch``: 4 LANES (length of the complex transform).
    """
    kind, n = plan[KIND], plan[LENGTH]
    wave = tables[plan[TWIDDLES] : plan[TWIDDLES] + 2 * n]
    cosines = tables[plan[TWISTS] : plan[TWISTS] + n]
    sines = tables[plan[TWISTS] + n : plan[TWISTS] + 2 * n]
    size = n * LANES
    halves = kind == QUARTER_COSINES or kind == QUARTER_SINES
    whole = kind >= WAVES
    for begin in range(0, rows, 2 * LANES):
        re, im = scratch[:size], scratch[size : 2 * size]
        more_re, more_im = scratch[2 * size : 3 * size], scratch[3 * size : 4 * size]
        lanes = min(LANES, (rows - begin + 1) // 2)
        for k in range(2 * size if lanes < LANES else 0):
            scratch[k] = 0.0
        for lane in range(lanes):
            row, both = begin + 2 * lane, begin + 2 * lane + 1 < rows
            base = (row // inner) * outer + row % inner
            other = ((row + 1) // inner) * outer + (row + 1) % inner if both else base
            if forward or whole:
                for j in range(n):
                    place, sign = extended(j, kind, count, n, forward)
                    to = j
                    if not whole:
                        to = j // 2 if j % 2 == 0 else n - 1 - j // 2
                    re[to * LANES + lane] = sign * x[base + place * stride] if sign != 0.0 else 0.0
                    im[to * LANES + lane] = sign * x[other + place * stride] if sign != 0.0 else 0.0
                continue
            for k in range(n):
                c, s = cosines[k], sines[k]
                a = an = b = bn = 0.0
                if not halves:
                    a, b = x[base + k * stride], x[other + k * stride]
                    if k > 0:
                        an, bn = x[base + (n - k) * stride], x[other + (n - k) * stride]
                elif k % 2 == 1:
                    here, there = (k // 2) * stride, ((n - k) // 2) * stride
                    a, b, an, bn = x[base + here], x[other + here], x[base + there], x[other + there]
                # The inverse is the forward transform with real and imaginary parts swapped.
                im[k * LANES + lane] = (c * a + s * an) - (s * b - c * bn)
                re[k * LANES + lane] = (s * a - c * an) + (c * b + s * bn)
        if fourier(re, im, more_re, more_im, n, wave, plan[FACTORS:]):
            re, im = more_re, more_im
        for lane in range(lanes):
            row, both = begin + 2 * lane, begin + 2 * lane + 1 < rows
            base = (row // inner) * outer + row % inner
            other = ((row + 1) // inner) * outer + (row + 1) % inner if both else base
            for q in range(count):
                to = q
                if forward or whole:
                    k = 2 * q + 1 if halves else q
                    if (kind == NODES_FREE or kind == FREE_NODES) and forward:
                        k = 2 * q - 1 if q > 0 else 0
                    here, mirror = k * LANES + lane, ((n - k) % n) * LANES + lane
                    ar, ai = 0.5 * (re[here] + re[mirror]), 0.5 * (im[here] - im[mirror])
                    br, bi = 0.5 * (im[here] + im[mirror]), -0.5 * (re[here] - re[mirror])
                    if kind == WAVES:
                        a, b = ar - ai, br - bi
                    elif kind == FREE_FREE:
                        a, b = ar, br
                    elif whole:
                        a, b = ai, bi
                        if kind == FREE_NODES and not forward:
                            to = count - 1 - q
                    else:
                        c, s = cosines[k], sines[k]
                        a, b = ar * c + ai * s, br * c + bi * s
                else:
                    at = (q // 2 if q % 2 == 0 else n - 1 - q // 2) * LANES + lane
                    to = count - 1 - q if kind == QUARTER_SINES else q
                    sign = -1.0 if kind == SINES and q % 2 == 1 else 1.0
                    a, b = sign * im[at], sign * re[at]
                if both:
                    x[other + to * stride] = b
                x[base + to * stride] = a


@lean(types.void(A, N, N, N, types.boolean, A, A, I), inner=True)
def transform(x, nx, ny, nz, forward, tables, scratch, plans):
    """Transform x in place along all its axes."""
    along(x, nx, 1, ny * nz, 1, nx, forward, tables, scratch, plans[:PLAN])
    along(x, ny, nx, nx * nz, nx, nx * ny, forward, tables, scratch, plans[PLAN : 2 * PLAN])
    if nz > 1:
        along(x, nz, nx * ny, nx * ny, nx * ny, nx * ny * nz, forward, tables, scratch, plans[2 * PLAN : 3 * PLAN])
