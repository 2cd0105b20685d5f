# mypy: ignore-errors
"""Sine and cosine together, from multiplications and additions alone: fast, and the same bits on every machine."""

import numpy as np

from sceneql.compiled.kernels import inlined

TWO_OVER_PI = 0.6366197723675814
HALF_PI_1 = 1.57079632673412561417  # the first 33 bits of pi/2, the next 33, and the rest
HALF_PI_2 = 6.07710050630396597660e-11
HALF_PI_3 = 2.02226624879595063154e-21
LARGEST = 1.0e6
"""Beyond this size three parts of pi/2 are too inaccurate, and the library's functions are used."""


@inlined
def reduced(x):
    """(sin x, cos x) where |x| <= LARGEST, within 2 units in the last place; without branches, so that loops vectorize.

    Argument reduced by three parts of pi/2 (Cody & Waite 1980), then minimax polynomials on [-pi/4, pi/4] (coefficients
    of Sun's fdlibm, 1993).
    """
    turns = np.floor(x * TWO_OVER_PI + 0.5)
    r = ((x - turns * HALF_PI_1) - turns * HALF_PI_2) - turns * HALF_PI_3
    z = r * r
    s = 2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)
    s = 8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04 + z * s)
    s = r + r * z * (-1.66666666666666324348e-01 + z * s)
    c = -2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)
    c = -1.38888888888741095749e-03 + z * (2.48015872894767294178e-05 + z * c)
    c = 1.0 - (0.5 * z - z * z * (4.16666666666666019037e-02 + z * c))
    half = np.floor(0.5 * turns)
    odd = turns != 2.0 * half
    back = half != 2.0 * np.floor(0.5 * half)
    first = c if odd else s
    second = -s if odd else c
    return -first if back else first, -second if back else second


@inlined
def sine_cosine(x):
    """(sin x, cos x), within 2 units in the last place."""
    if not abs(x) <= LARGEST:
        return np.sin(x), np.cos(x)
    return reduced(x)


@inlined
def wave_lanes(a, out, n, cosine):
    """``sine_cosine`` at n arguments: the cosines, or else the sines."""
    far = 0
    for i in range(n):
        far += 0 if abs(a[i]) <= LARGEST else 1
    if far > 0:
        for i in range(n):
            s, c = sine_cosine(a[i])
            out[i] = c if cosine else s
    elif cosine:
        for i in range(n):
            out[i] = reduced(a[i])[1]
    else:
        for i in range(n):
            out[i] = reduced(a[i])[0]
