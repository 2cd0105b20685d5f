# mypy: ignore-errors
"""Cosine, sine and Hartley transforms along an axis of a box, many rows side by side, each pair as a complex one.

The complex transform is Stockham's, of any length, by factors 4, 2, 3, 5 and other primes (Van Loan, Computational
Frameworks for the Fast Fourier Transform (1992), 1.7); cosines come from it by Makhoul (1980), IEEE Trans. ASSP 28,
27-34. There and back a number comes out times the length of the complex transform.
"""

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.flows.layout import (
    FACTORS,
    KIND,
    LANES,
    LENGTH,
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


@lean(types.void(A, N, N, N, N, N, types.boolean, A, A, I), inner=True)
def along(x, count, stride, rows, inner, outer, forward, floats, scratch, plan):
    """Transform x in place along an axis of ``count`` cells ``stride`` apart, forward or back.

    Row c begins at (c // inner) outer + c % inner. ``scratch``: 4 LANES (length of the complex transform).
    """
    kind, n = plan[KIND], plan[LENGTH]
    wave = floats[plan[TWIDDLES] : plan[TWIDDLES] + 2 * n]
    cosines = floats[plan[TWISTS] : plan[TWISTS] + n]
    sines = floats[plan[TWISTS] + n : plan[TWISTS] + 2 * n]
    size = n * LANES
    halves = kind == QUARTER_COSINES or kind == QUARTER_SINES
    for begin in range(0, rows, 2 * LANES):
        re, im = scratch[:size], scratch[size : 2 * size]
        more_re, more_im = scratch[2 * size : 3 * size], scratch[3 * size : 4 * size]
        for lane in range(LANES):
            for second in range(2):
                row = begin + 2 * lane + second
                into = im if second == 1 else re
                if row >= rows:
                    for j in range(n):
                        into[j * LANES + lane] = 0.0
                    continue
                base = (row // inner) * outer + row % inner
                if kind == WAVES:
                    for j in range(n):
                        into[j * LANES + lane] = x[base + j * stride]
                elif forward:
                    for j in range(n):
                        place = j if j < count else 2 * count - 1 - j
                        if kind == QUARTER_SINES:
                            place = count - 1 - place
                        value = x[base + place * stride]
                        if j >= count or (kind == SINES and j % 2 == 1):
                            value = -value
                        to = j // 2 if j % 2 == 0 else n - 1 - j // 2
                        into[to * LANES + lane] = value
        if not forward and kind != WAVES:
            for lane in range(LANES):
                row, next_row = begin + 2 * lane, begin + 2 * lane + 1
                if row >= rows:
                    break
                base = (row // inner) * outer + row % inner
                other = (next_row // inner) * outer + next_row % inner if next_row < rows else base
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
        for lane in range(LANES):
            row, next_row = begin + 2 * lane, begin + 2 * lane + 1
            if row >= rows:
                break
            both = next_row < rows
            base = (row // inner) * outer + row % inner
            other = (next_row // inner) * outer + next_row % inner if both else base
            if forward or kind == WAVES:
                for q in range(count):
                    k = 2 * q + 1 if halves else q
                    here, mirror = k * LANES + lane, ((n - k) % n) * LANES + lane
                    ar, ai = 0.5 * (re[here] + re[mirror]), 0.5 * (im[here] - im[mirror])
                    br, bi = 0.5 * (im[here] + im[mirror]), -0.5 * (re[here] - re[mirror])
                    if kind == WAVES:
                        a, b = ar - ai, br - bi
                    else:
                        c, s = cosines[k], sines[k]
                        a, b = ar * c + ai * s, br * c + bi * s
                    if both:
                        x[other + q * stride] = b
                    x[base + q * stride] = a
            else:
                for j in range(count):
                    at = (j // 2 if j % 2 == 0 else n - 1 - j // 2) * LANES + lane
                    place = count - 1 - j if kind == QUARTER_SINES else j
                    sign = -1.0 if kind == SINES and j % 2 == 1 else 1.0
                    if both:
                        x[other + place * stride] = sign * re[at]
                    x[base + place * stride] = sign * im[at]
