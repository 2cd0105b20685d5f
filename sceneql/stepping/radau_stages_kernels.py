# mypy: ignore-errors
"""The stages of radau: the layout of its work, and Newton's iteration on the stages (see radau_kernels.py).

``settings``: [relative tolerance, tolerance of Newton's iteration relative to that of the step, contraction of that
iteration below which the Jacobian serves one more step; then the absolute tolerance of each entry or the scales of
error_scales_kernels.py, and the factors of rows of what solves the linear systems]. ``numbers``: [1 if steps are fixed,
length of ``values``, tallies, length of the plan of error_scales_kernels.py, which is 0 where absolute tolerances are
given, where the factors of rows start, the numbers of the kernels of radau_systems_kernels.py; then the tallies, that
plan, the plan of the linear solver]. ``work``: MEMORY scalars; vectors: 3 of the stages z, 3 of those before, 3 of w, 3
of scratch, y0, the weights of entries in the error and in Newton's iteration, the last stage as guessed; the values,
the store of the linear solver.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.stepping import radau_layout as layout
from sceneql.stepping.radau_systems_kernels import ALPHA, BETA, REAL, solve_at
from sceneql.system.signatures_kernels import A, F, I, N

ITERATE = types.Tuple((N, F))(I, F, F, A, A, A, A, I, A, I, A, I, A, A)
ITERATIONS = 7
ENOUGH = 0.03
"""Error of the stages, in units of the step's tolerance, that is good enough where the iteration stops."""

ROOT6 = math.sqrt(6.0)
C1, C2 = (4.0 - ROOT6) / 10.0, (4.0 + ROOT6) / 10.0

T11, T12, T13 = 0.09123239487089294279, -0.14125529502095420843, -0.03002919410514742449
T21, T22, T23 = 0.24171793270710701896, 0.20412935229379993199, 0.38294211275726193779
T31 = 0.96604818261509293619
"""T; its last row is (T31, 1, 0)."""
I11, I12, I13 = 4.3255798900631553510, 0.33919925181580986954, 0.54177053993587487119
I21, I22, I23 = -4.1787185915519047273, -0.32768282076106238708, 0.47662355450055045196
I31, I32, I33 = -0.50287263494578687595, 2.5719269498556054292, -0.59603920482822492497
"""Its inverse."""


@lean_inlined
def evaluate_stages(rate, t, h, y0, y1, z, f, floats, ints):
    """f = the rate at the three stages; y1 is scratch."""
    n = y0.size
    for k in range(n):
        y1[k] = y0[k] + z[k]
    rate(t + C1 * h, y1, f[:n], floats, ints)
    for k in range(n):
        y1[k] = y0[k] + z[n + k]
    rate(t + C2 * h, y1, f[n : 2 * n], floats, ints)
    for k in range(n):
        y1[k] = y0[k] + z[2 * n + k]
    rate(t + h, y1, f[2 * n :], floats, ints)


@lean(ITERATE, inner=True)
def iterate(functions, t, h, y0, y1, work, settings, numbers, floats, ints, values, plan, rows, store):
    """Newton's iteration on the stages: (iterations, factor for h to try after a failure; 0: it has converged)."""
    rate, solve = rate_at(functions[AT_RATE]), solve_at(numbers[layout.SOLVE])
    n = y0.size
    z, w = work[layout.MEMORY : layout.MEMORY + 3 * n], work[layout.MEMORY + 6 * n : layout.MEMORY + 9 * n]
    f = work[layout.MEMORY + 9 * n : layout.MEMORY + 12 * n]
    weights = work[layout.MEMORY + 14 * n : layout.MEMORY + 15 * n]
    g, a, b = REAL / h, ALPHA / h, BETA / h
    tolerance = settings[layout.NEWTON]
    enough = max(tolerance, ENOUGH)
    convergence = max(work[layout.CONVERGENCE], 2.2e-16) ** 0.8
    size = before = rate_before = 0.0
    work[layout.CONTRACTION] = settings[layout.CONTRACTS]
    for count in range(1, ITERATIONS + 1):
        evaluate_stages(rate, t, h, y0, y1, z, f, floats, ints)
        for k in range(n):
            f1, f2, f3 = f[k], f[n + k], f[2 * n + k]
            w2, w3 = w[n + k], w[2 * n + k]
            f[k] = I11 * f1 + I12 * f2 + I13 * f3 - g * w[k]
            f[n + k] = I21 * f1 + I22 * f2 + I23 * f3 - a * w2 + b * w3
            f[2 * n + k] = I31 * f1 + I32 * f2 + I33 * f3 - a * w3 - b * w2
        if not solve(plan, work[layout.FACTORED], values, rows, store, weights, f):
            return count, 0.5
        total = 0.0
        for k in range(n):
            d1, d2, d3 = f[k], f[n + k], f[2 * n + k]
            total += (d1 * d1 + d2 * d2 + d3 * d3) * (weights[k] * weights[k])
            w1, w2, w3 = w[k] + d1, w[n + k] + d2, w[2 * n + k] + d3
            w[k], w[n + k], w[2 * n + k] = w1, w2, w3
            z[k] = T11 * w1 + T12 * w2 + T13 * w3
            z[n + k] = T21 * w1 + T22 * w2 + T23 * w3
            z[2 * n + k] = T31 * w1 + w2
        size = math.sqrt(total / (3 * n))
        if not size < math.inf:
            return count, 0.5
        if count > 1:
            now = size / before
            contraction = now if count == 2 else math.sqrt(now * rate_before)
            rate_before = now
            if count == 2 and contraction >= 0.99 and size > enough:
                # Stiff springs that rotate: every other change is large, so compare two together.
                before = size
                continue
            if contraction >= 0.99:
                # Rounding keeps very stiff systems from converging further.
                return (count, 0.0) if size <= enough else (count, 0.5)
            work[layout.CONTRACTION] = contraction
            convergence = contraction / (1.0 - contraction)
            left = ITERATIONS - count
            ahead = convergence * size * contraction**left / enough
            if ahead >= 1.0:
                return count, 0.8 * min(20.0, max(1e-4, ahead)) ** (-1.0 / (4.0 + left))
        if convergence * size <= tolerance:
            work[layout.CONVERGENCE] = convergence
            return count, 0.0
        before = max(size, 2.2e-16)
    return ITERATIONS, 0.0 if convergence * size <= enough else 0.5
