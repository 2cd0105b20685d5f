# mypy: ignore-errors
"""The complex Fourier transform of many sequences side by side.

It is Stockham's, of any length, by factors 4 (two at once), 2, 3, 5 and other primes (Van Loan, Computational
Frameworks for the Fast Fourier Transform (1992), 1.7). A complex number of LANES sequences is 2 LANES numbers: the
real parts, then the imaginary ones. ``wave`` holds n cosines and n sines of the angles 2 pi k/n.
"""

from math import cos, pi, sin

import numpy as np
from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.lanes_kernels import load, spread, store
from sceneql.flows.layout import BOTH, LANES
from sceneql.system.signatures_kernels import A, I, N

SINE_3 = sin(2 * pi / 3)
COSINE_5, COSINE_52, SINE_5, SINE_52 = cos(2 * pi / 5), cos(4 * pi / 5), sin(2 * pi / 5), sin(4 * pi / 5)


@lean_inlined
def turned(to, o, xr, xi, wave, n, turn):
    """Store a number times exp(-2 pi i turn/n)."""
    k = np.uint64(turn)
    c, s = wave[k], wave[np.uint64(n) + k]
    store(to, o, xr * c + xi * s)
    store(to, o + LANES, xi * c - xr * s)


@lean_inlined
def by_two(z, to, at, far, into, width, wave, n, turn):
    """One butterfly of two for all lanes."""
    for q in range(0, width, BOTH):
        k, o = at + q, into + q
        ar, ai, br, bi = load(z, k), load(z, k + LANES), load(z, k + far), load(z, k + far + LANES)
        store(to, o, ar + br)
        store(to, o + LANES, ai + bi)
        turned(to, o + width, ar - br, ai - bi, wave, n, turn)


@lean_inlined
def four(z, to, k, far, o, apart, wave, n, turn):
    """One butterfly of four; its numbers stand ``far`` apart and get ``apart`` apart."""
    ar, ai, br, bi = load(z, k), load(z, k + LANES), load(z, k + far), load(z, k + far + LANES)
    cr, ci = load(z, k + 2 * far), load(z, k + 2 * far + LANES)
    dr, di = load(z, k + 3 * far), load(z, k + 3 * far + LANES)
    er, ei, fr, fi, gr, gi, hr, hi = ar + cr, ai + ci, ar - cr, ai - ci, br + dr, bi + di, br - dr, bi - di
    store(to, o, er + gr)
    store(to, o + LANES, ei + gi)
    turned(to, o + apart, fr + hi, fi - hr, wave, n, turn)
    turned(to, o + 2 * apart, er - gr, ei - gi, wave, n, 2 * turn)
    turned(to, o + 3 * apart, fr - hi, fi + hr, wave, n, 3 * turn)


@lean_inlined
def by_four(z, to, at, far, into, width, wave, n, turn):
    """One butterfly of four for all lanes."""
    for q in range(0, width, BOTH):
        four(z, to, at + q, far, into + q, width, wave, n, turn)


@lean_inlined
def by_sixteen(z, to, near, p, m, width, wave, n, fold):
    """Four butterflies of four and four of their results, for all lanes; these stand ``near``, which saves a way to
    memory and back. The arithmetic is that of two turns by four."""
    for q in range(0, width, BOTH):
        for j in range(4):
            four(z, near, (p + m * j) * width + q, 4 * m * width, 4 * BOTH * j, BOTH, wave, n, (p + m * j) * fold)
        for k in range(4):
            four(near, to, BOTH * k, 4 * BOTH, (16 * p + k) * width + q, 4 * width, wave, n, 4 * p * fold)


@lean_inlined
def by_three(z, to, at, far, into, width, wave, n, turn):
    """One butterfly of three for all lanes."""
    for q in range(0, width, BOTH):
        k, o = at + q, into + q
        ar, ai, br, bi = load(z, k), load(z, k + LANES), load(z, k + far), load(z, k + far + LANES)
        cr, ci = load(z, k + 2 * far), load(z, k + 2 * far + LANES)
        er, ei, fr, fi = br + cr, bi + ci, SINE_3 * (br - cr), SINE_3 * (bi - ci)
        gr, gi = ar - 0.5 * er, ai - 0.5 * ei
        store(to, o, ar + er)
        store(to, o + LANES, ai + ei)
        turned(to, o + width, gr + fi, gi - fr, wave, n, turn)
        turned(to, o + 2 * width, gr - fi, gi + fr, wave, n, 2 * turn)


@lean_inlined
def by_five(z, to, at, far, into, width, wave, n, turn):
    """One butterfly of five for all lanes."""
    for q in range(0, width, BOTH):
        k, o = at + q, into + q
        ar, ai, br, bi = load(z, k), load(z, k + LANES), load(z, k + far), load(z, k + far + LANES)
        cr, ci = load(z, k + 2 * far), load(z, k + 2 * far + LANES)
        dr, di = load(z, k + 3 * far), load(z, k + 3 * far + LANES)
        er, ei = load(z, k + 4 * far), load(z, k + 4 * far + LANES)
        pr, pm, qr, qi, ur, ui, vr, vi = br + er, bi + ei, br - er, bi - ei, cr + dr, ci + di, cr - dr, ci - di
        store(to, o, ar + (pr + ur))
        store(to, o + LANES, ai + (pm + ui))
        xr, xi = ar + (COSINE_5 * pr + COSINE_52 * ur), ai + (COSINE_5 * pm + COSINE_52 * ui)
        yr, yi = SINE_5 * qr + SINE_52 * vr, SINE_5 * qi + SINE_52 * vi
        turned(to, o + width, xr + yi, xi - yr, wave, n, turn)
        turned(to, o + 4 * width, xr - yi, xi + yr, wave, n, 4 * turn)
        xr, xi = ar + (COSINE_52 * pr + COSINE_5 * ur), ai + (COSINE_52 * pm + COSINE_5 * ui)
        yr, yi = SINE_52 * qr - SINE_5 * vr, SINE_52 * qi - SINE_5 * vi
        turned(to, o + 2 * width, xr + yi, xi - yr, wave, n, 2 * turn)
        turned(to, o + 3 * width, xr - yi, xi + yr, wave, n, 3 * turn)


@lean_inlined
def by_many(z, to, p, m, r, width, wave, n, fold):
    """One butterfly of r for all lanes."""
    for k in range(r):
        o, begin, apart = (r * p + k) * width, p * k * fold % n, k * (n // r)
        for q in range(0, width, BOTH):
            sum_re, sum_im, turn = spread(0.0), spread(0.0), begin
            for j in range(r):
                c, s, at = wave[turn], wave[n + turn], (p + j * m) * width + q
                xr, xi = load(z, at), load(z, at + LANES)
                sum_re, sum_im = sum_re + (xr * c + xi * s), sum_im + (xi * c - xr * s)
                turn += apart
                turn -= n if turn >= n else 0
            store(to, o + q, sum_re)
            store(to, o + q + LANES, sum_im)


@lean(types.boolean(A, A, A, N, A, I), inner=True)
def fourier(z, other, near, n, wave, factors):
    """sum over j of z_j exp(-2 pi i j k/n), entry j of all lanes at BOTH j.

    ``near``: 16 BOTH of scratch. Whether the result stands in the other array.
    """
    swapped = False
    left, width, number = n, BOTH, 0
    while number < factors[0]:
        number += 1
        r = factors[number]
        if r == 4 and number < factors[0] and factors[number + 1] == 4:
            r = 16
            number += 1
        m = left // r
        fold = n // left
        for p in range(m):
            if r == 16:
                by_sixteen(z, other, near, p, m, width, wave, n, fold)
            elif r == 2:
                by_two(z, other, p * width, m * width, 2 * p * width, width, wave, n, p * fold)
            elif r == 4:
                by_four(z, other, p * width, m * width, 4 * p * width, width, wave, n, p * fold)
            elif r == 3:
                by_three(z, other, p * width, m * width, 3 * p * width, width, wave, n, p * fold)
            elif r == 5:
                by_five(z, other, p * width, m * width, 5 * p * width, width, wave, n, p * fold)
            else:
                by_many(z, other, p, m, r, width, wave, n, fold)
        z, other = other, z
        swapped = not swapped
        left = m
        width *= r
    return swapped
