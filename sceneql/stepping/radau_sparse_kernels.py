# mypy: ignore-errors
"""Radau's linear systems by one real sparse factorization, that of (g - J) for the real eigenvalue g = REAL/h.

The complex system (g + d - J) z = r, d = (ALPHA + i BETA)/h - g, is solved by relaxed iterations with these factors,
z <- z + w ((g - J)^-1 (r - d z) - z), which need no product with J (Cooper & Butcher 1983, IMA J. Numer. Anal. 3).
Each takes an error e of a mode to (1 - w q) e with q = (g + d - lambda)/(g - lambda). As lambda runs through the left
half-plane, q fills the disc about c = 1 + d/(2 g) whose rim holds 1 (lambda infinite) and 1 + d/g (lambda = 0): its
radius is |d|/(2 g). So with w = 1/c no mode keeps more than |d|/|2 g + d| = 0.456 of its error, however stiff. The
first two iterations take w = 1 and w = 1/(1 + d/g): all of the error in what is far stiffer or slower than the step.

``plan``, ``rows``: of stage_kernels.py. ``store``: four vectors, then what stage_kernels.py keeps.
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.linear.stage_kernels import SIZE, factor_stage, solve_stage
from sceneql.stepping.radau_systems_kernels import ALPHA, BETA, FACTOR_STAGES, FILTER, REAL, SOLVE_STAGES

ENOUGH = 0.01
"""Relative change of the solution that ends the iterations: Newton's method corrects the remaining error."""
MOST = 25
"""Most iterations: in growing modes they may not converge."""

RE, IM = ALPHA / REAL - 1.0, BETA / REAL
"""d/g."""
FAR = (1.0 + RE) * (1.0 + RE) + IM * IM
MEAN = (1.0 + 0.5 * RE) * (1.0 + 0.5 * RE) + 0.25 * IM * IM


@lean_inlined
def relaxation(count):
    """w of an iteration: 1, then that of lambda = 0, then that of the disc."""
    if count == 0:
        return 1.0, 0.0
    if count == 1:
        return (1.0 + RE) / FAR, -IM / FAR
    return (1.0 + 0.5 * RE) / MEAN, -0.5 * IM / MEAN


@lean(FACTOR_STAGES)
def factor(plan, h, values, rows, store):
    """Factor 1 - J/g."""
    return factor_stage(plan, h / REAL, values, rows, store[4 * plan[SIZE] :])


@lean(FILTER)
def solve_one(plan, h, values, rows, store, r):
    """Solve the real system."""
    a = h / REAL
    for k in range(r.size):
        r[k] *= a
    return solve_stage(plan, a, values, rows, store[4 * r.size :], r)


@lean(SOLVE_STAGES)
def solve(plan, h, values, rows, store, weights, r):
    """Solve both systems."""
    n, a = weights.size, h / REAL
    inner = store[4 * n :]
    if not solve_one(plan, h, values, rows, store, r[:n]):
        return False
    b, c = r[n : 2 * n], r[2 * n :]
    x, y, u, v = store[:n], store[n : 2 * n], store[2 * n : 3 * n], store[3 * n : 4 * n]
    for k in range(n):
        x[k] = 0.0
        y[k] = 0.0
    for count in range(MOST):
        for k in range(n):
            u[k] = a * b[k] - RE * x[k] + IM * y[k]
            v[k] = a * c[k] - RE * y[k] - IM * x[k]
        if not (solve_stage(plan, a, values, rows, inner, u) and solve_stage(plan, a, values, rows, inner, v)):
            return False
        p, q = relaxation(count)
        change = size = 0.0
        for k in range(n):
            re, im = u[k] - x[k], v[k] - y[k]
            re, im = p * re - q * im, p * im + q * re
            x[k] += re
            y[k] += im
            square = weights[k] * weights[k]
            change += (re * re + im * im) * square
            size += (x[k] * x[k] + y[k] * y[k]) * square
        if not change < math.inf:
            return False
        if count > 0 and change <= ENOUGH * ENOUGH * size:
            break
    else:
        return False
    for k in range(n):
        b[k] = x[k]
        c[k] = y[k]
    return True
