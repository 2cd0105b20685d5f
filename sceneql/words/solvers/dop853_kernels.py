# mypy: ignore-errors
"""One step of Dormand and Prince's method of order 8, and its dense output.

``numbers`` = (1 if the error is wanted, 1 if every step is extended, 1 if the rate at the end is left to the
extension, length of the plan of error_scales_kernels.py, which is 0 where an absolute tolerance is given), then that
plan. ``settings`` = (relative tolerance, absolute tolerance, rows of a below the diagonal for all 16 stages, where row
12 is b, c (16), weights of the fifth-order error (12), of the third-order one (12), of the interpolant's last four
coefficients (4, 16)), then the scales and the time of their last step. ``work``: 16 stages, of which the first is not
used (it is ``rate0``) and the thirteenth is the rate at the end; scratch; those four coefficients; with scales 3 arrays
more.
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.stepping.runge_kutta_kernels import ABSOLUTE, RELATIVE, add_stages, weigh_explicitly
from sceneql.system.signatures_kernels import DENSE, STEP

CONTROLLED, EXTENDED, LATE, SCALED, HEAD = range(5)
STAGES = 12
LAST = 16
ROWS = 2
PLACES = ROWS + LAST * (LAST - 1) // 2
FIFTH = PLACES + LAST
THIRD = FIFTH + STAGES
BENDS = THIRD + STAGES
SCALES = BENDS + 4 * LAST


@lean_inlined
def stage(i, rate, t, h, y0, rate0, state, work, settings, floats, ints):
    """Stage i (from 0) into its place in work; ``state`` is where it is evaluated."""
    n = y0.size
    add_stages(settings, ROWS + i * (i - 1) // 2, i, h, y0, rate0, work, state)
    rate(t + settings[PLACES + i] * h, state, work[i * n : (i + 1) * n], floats, ints)


@lean(STEP)
def extend(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """The three further stages of dense output, and its coefficients from them; before these the rate at the end."""
    rate = rate_at(functions[AT_RATE])
    n = y0.size
    for i in range(STAGES + 1 - numbers[LATE], LAST):
        stage(i, rate, t, h, y0, rate0, work[LAST * n : (LAST + 1) * n], work, settings, floats, ints)
    for row in range(4):
        at = BENDS + row * LAST
        out = work[(LAST + 1 + row) * n : (LAST + 2 + row) * n]
        for k in range(n):
            out[k] = settings[at] * rate0[k]
        for i in range(1, LAST):
            weight = settings[at + i]
            if weight != 0.0:
                for k in range(n):
                    out[k] += weight * work[i * n + k]
    return 0.0


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h, and the error of Hairer, Norsett & Wanner (1993, II.10, eq. 10.17)."""
    rate = rate_at(functions[AT_RATE])
    n = y0.size
    for i in range(1, STAGES + 1 - numbers[LATE]):
        stage(i, rate, t, h, y0, rate0, y1, work, settings, floats, ints)
    if numbers[LATE] != 0:
        add_stages(settings, ROWS + STAGES * (STAGES - 1) // 2, STAGES, h, y0, rate0, work, y1)
    if numbers[EXTENDED] != 0:
        extend(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints)
    if numbers[CONTROLLED] == 0:
        return 0.0
    weights = work[(LAST + 5) * n :]
    scaled = numbers[SCALED] > 0
    if scaled:
        sizes, plan = settings[SCALES:], numbers[HEAD:]
        weigh_explicitly(functions, t, h, y0, rate0, settings[RELATIVE], sizes, plan, weights, floats, ints)
    fifths = 0.0
    thirds = 0.0
    for k in range(n):
        if scaled:
            scale = max(1.0 / weights[k], settings[RELATIVE] * abs(y1[k]))
        else:
            scale = settings[ABSOLUTE] + settings[RELATIVE] * max(abs(y0[k]), abs(y1[k]))
        fifth = settings[FIFTH] * rate0[k]
        third = settings[THIRD] * rate0[k]
        for i in range(5, STAGES):
            fifth += settings[FIFTH + i] * work[i * n + k]
            third += settings[THIRD + i] * work[i * n + k]
        fifths += (fifth / scale) ** 2
        thirds += (third / scale) ** 2
    if fifths == 0.0:
        return 0.0
    return h * fifths / math.sqrt((fifths + 0.01 * thirds) * n)


@lean(DENSE)
def dense(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out):
    """The interpolant of order 7 (Hairer, Norsett & Wanner 1993, II.6, code DOP853), after ``extend``."""
    n = y0.size
    rest = 1.0 - theta
    last = work[STAGES * n :]
    bends = work[(LAST + 1) * n :]
    for k in range(n):
        difference = y1[k] - y0[k]
        start = h * rate0[k] - difference
        end = difference - h * last[k] - start
        high = bends[2 * n + k] + theta * bends[3 * n + k]
        high = h * (bends[k] + theta * (bends[n + k] + rest * high))
        out[k] = y0[k] + theta * (difference + rest * (start + theta * (end + rest * high)))
