# mypy: ignore-errors
"""One step of any explicit Runge-Kutta method: the tableau is data.

``numbers`` = (stages, 1 if there is an embedded method, length of the plan of error_scales_kernels.py, which is 0 where
an absolute tolerance is given), then that plan. ``settings`` = (relative tolerance, absolute tolerance, c (s), b (s),
b - b_hat (s), rows of a below the diagonal, packed: s (s-1)/2 numbers), then the scales and the time of their last
step. ``work``: s arrays, the stages; the first is not used, for stage one is ``rate0``; with scales 3 more.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.system.signatures_kernels import STEP, A, F, I, N

STAGES, EMBEDDED, SCALED, HEAD = range(4)
RELATIVE, ABSOLUTE = range(2)

WEIGH = types.void(I, F, F, A, A, F, A, I, A, A, I)
weigh_explicitly = lazy("sceneql.stepping.error_scales_kernels:weigh_explicitly", WEIGH)


@lean(types.void(A, N, N, F, A, A, A, A), inner=True)
def add_stages(settings, row, count, h, y0, rate0, work, out):
    """out = y0 + h * the sum of the first stages, weighted by settings[row:]."""
    n = y0.size
    weight = h * settings[row]
    for k in range(n):
        out[k] = y0[k] + weight * rate0[k]
    for j in range(1, count):
        weight = h * settings[row + j]
        if weight != 0.0:
            at = j * n
            for k in range(n):
                out[k] += weight * work[at + k]


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h; the embedded error in the norm of Hairer, Norsett & Wanner (1993, eq. II.4.11)."""
    rate = rate_at(functions[AT_RATE])
    stages = numbers[STAGES]
    n = y0.size
    c, b, e = 2, 2 + stages, 2 + 2 * stages
    row = 2 + 3 * stages
    for i in range(1, stages):
        add_stages(settings, row, i, h, y0, rate0, work, y1)
        row += i
        rate(t + settings[c + i] * h, y1, work[i * n : (i + 1) * n], floats, ints)
    add_stages(settings, b, stages, h, y0, rate0, work, y1)
    if numbers[EMBEDDED] == 0:
        return 0.0
    weights = work[stages * n :]
    scaled = numbers[SCALED] > 0
    if scaled:
        sizes, plan = settings[row:], numbers[HEAD:]
        weigh_explicitly(functions, t, h, y0, rate0, settings[RELATIVE], sizes, plan, weights, floats, ints)
    total = 0.0
    for k in range(n):
        error = settings[e] * rate0[k]
        for j in range(1, stages):
            error += settings[e + j] * work[j * n + k]
        if scaled:
            error *= h / max(1.0 / weights[k], settings[RELATIVE] * abs(y1[k]))
        else:
            error *= h / (settings[ABSOLUTE] + settings[RELATIVE] * max(abs(y0[k]), abs(y1[k])))
        total += error * error
    return math.sqrt(total / n)
