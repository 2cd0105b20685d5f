# mypy: ignore-errors
"""One step of a diagonally implicit Runge-Kutta method on an island that is one field on a grid (system.Grid).

Every stage y = base + a f(t, y) is solved to a small residual by the linear solver of the plan, and then its slope is
evaluated: f of what was found. So what the fluxes conserve is conserved to rounding, however the systems are solved.

``settings``: relative and absolute size of a residual that is small, the diagonal g of the tableau, then c (s), b (s),
b - b_hat (s), the rows of a below the diagonal, packed. ``numbers``: [stages, 1 if the first is explicit, 1 if there is
an embedded method, order of its error], then the plan (see the names below; all indices count from its start).
``work``: s + 2 arrays of y's size (the first holds the step to try next in its first entry; slopes; scratch), then the
store of the plan: p, q (cells), what the linear solver keeps, RECORD entries of what it did.
"""

import math

from sceneql.kernels import lean, lean_inlined
from sceneql.simulation.grids.linear_kernels import (
    AT,
    EXACT,
    FED,
    GX,
    GY,
    GZ,
    NX,
    NY,
    NZ,
    SINK,
    SOLVER,
    VARYING,
    VOLUME,
    solver_at,
)
from sceneql.simulation.grids.stencil_kernels import dot
from sceneql.simulation.pointers_kernels import AT_RATE, rate_at
from sceneql.system_kernels import DENSE, STEP

STAGES, EXPLICIT_FIRST, EMBEDDED, ERROR_ORDER, HEAD = range(5)
RELATIVE, ABSOLUTE, DIAGONAL, TABLEAU = range(4)

MOST_NEWTON = 40
KEPT = 1.2
"""A longer step by less than that is not worth new factors."""
SHARE = 0.02
"""Part of the tolerance of adaptive steps that a residual may be: settings hold it times the tolerance."""
UNSOLVED = 1e-13
"""Part of what cancels in a residual that counts as rounding."""


@lean_inlined
def residual(n, a, volume, base, y, slope, r, d):
    """r = V ((base - y)/a + slope), and the 2-norms of it, of V base/a and of V y/a; d is scratch."""
    inverse = 1.0 / a
    for c in range(n):
        d[c] = volume[c] * base[c]
    whole = inverse * math.sqrt(dot(d, d))
    for c in range(n):
        d[c] = volume[c] * y[c]
    largest = inverse * math.sqrt(dot(d, d))
    for c in range(n):
        r[c] = volume[c] * (inverse * (base[c] - y[c]) + slope[c])
    return math.sqrt(dot(r, r)), whole, largest


@lean_inlined
def stiffest(plan, floats):
    """Largest (faces + sink)/V of a cell, but for a factor of 2."""
    n = plan[NX] * plan[NY] * plan[NZ]
    most = 0.0
    for c in range(n):
        total = floats[plan[GX] + c] + floats[plan[GY] + c] + floats[plan[SINK] + c]
        if plan[NZ] > 1:
            total += floats[plan[GZ] + c]
        most = max(most, total / floats[plan[VOLUME] + c])
    return most


@lean_inlined
def solve_stage(rate, solve, t, a, base, y, slope, r, d, store, plan, settings, floats, ints):
    """y = base + a f(t, y) from a guess, and slope = f(t, y) of what was found; False where it was not."""
    at = plan[AT]
    n = plan[NX] * plan[NY] * plan[NZ]
    volume = floats[plan[VOLUME] : plan[VOLUME] + n]
    x, r, d = y[at : at + n], r[:n], d[:n]
    if plan[EXACT] == 1 and plan[FED] >= 0:
        # Linear and solved to rounding: once is enough.
        fed = floats[plan[FED] : plan[FED] + n]
        for c in range(n):
            r[c] = volume[c] * base[at + c] / a + fed[c]
        if not solve(plan, a, 0.0, floats, r, d, store):
            return False
        for c in range(n):
            x[c] = d[c]
        rate(t, y, slope, floats, ints)
        return True
    cells = math.sqrt(dot(volume, volume))
    before = math.inf
    for iteration in range(MOST_NEWTON):
        rate(t, y, slope, floats, ints)
        size, whole, largest = residual(n, a, volume, base[at:], x, slope[at:], r, d)
        if not size < math.inf:
            return False
        if iteration == 0 and size > 2.0 * whole and plan[VARYING] == 0:
            # Far from the solution: nothing is a better guess than what changes fast.
            for c in range(n):
                x[c] = 0.0
            rate(t, y, slope, floats, ints)
            size, whole, largest = residual(n, a, volume, base[at:], x, slope[at:], r, d)
        target = settings[RELATIVE] * max(whole, largest) + settings[ABSOLUTE] * cells / a
        rounding = UNSOLVED * (1.0 + a * stiffest(plan, floats)) * max(whole, largest)
        if size <= max(target, rounding) or (size > 0.5 * before and size <= 100.0 * rounding):
            return True
        before = size
        # Where all was 0 the size of what is to come is not known yet, but that of the residual is.
        target = max(target, rounding, settings[RELATIVE] * size)
        if not solve(plan, a, 0.5 * target, floats, r, d, store):
            return False
        for c in range(n):
            x[c] += d[c]
    return False


@lean_inlined
def add_slopes(settings, at, count, h, y0, work, out):
    """out = y0 + h times the sum of the first slopes, weighted by settings[at:]."""
    n = y0.size
    for k in range(n):
        out[k] = y0[k]
    for j in range(count):
        weight = h * settings[at + j]
        if weight != 0.0:
            slope = work[(1 + j) * n : (2 + j) * n]
            for k in range(n):
                out[k] += weight * slope[k]


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h; the embedded error, filtered by the stage system (Hosea & Shampine 1996)."""
    n, stages = y0.size, numbers[STAGES]
    rate = rate_at(functions[AT_RATE])
    base, scratch = work[:n], work[(1 + stages) * n : (2 + stages) * n]
    change = work[(2 + stages) * n : (3 + stages) * n]
    store = work[(3 + stages) * n :]
    plan = numbers[HEAD:]
    solve = solver_at(plan[SOLVER])
    b = TABLEAU + stages
    e, row = b + stages, b + 2 * stages
    a = h * settings[DIAGONAL]
    first = numbers[EXPLICIT_FIRST]
    for k in range(n * first):
        work[n + k] = rate0[k]
    for k in range(n):
        y1[k] = y0[k]
    for i in range(first, stages):
        slope = work[(1 + i) * n : (2 + i) * n]
        add_slopes(settings, row, i, h, y0, work, base)
        row += i
        t_stage = t + settings[TABLEAU + i] * h
        if not solve_stage(
            rate, solve, t_stage, a, base, y1, slope, scratch, change, store, plan, settings, floats, ints
        ):
            y1[plan[AT]] = math.nan
            work[0] = 0.25 * h
            return math.inf
        for k in range(n):
            y1[k] = base[k] + a * slope[k]
    add_slopes(settings, b, stages, h, y0, work, y1)
    if numbers[EMBEDDED] == 0:
        return 0.0
    at = plan[AT]
    size = 0.0
    for k in range(n):
        total = 0.0
        for j in range(stages):
            total += settings[e + j] * work[(1 + j) * n + k]
        base[k] = h * total
    cells = plan[NX] * plan[NY] * plan[NZ]
    for c in range(cells):
        scratch[c] = floats[plan[VOLUME] + c] / a * base[at + c]
        size += scratch[c] * scratch[c]
    if size > 0.0 and not solve(plan, a, 1e-2 * math.sqrt(size), floats, scratch, change, store):
        work[0] = 0.25 * h
        return math.inf
    error = 0.0
    for c in range(cells if size > 0.0 else 0):
        allowed = settings[ABSOLUTE] + settings[RELATIVE] * max(abs(y0[at + c]), abs(y1[at + c]))
        error += (SHARE * change[c] / allowed) ** 2
    error = math.sqrt(error / cells)
    factor = min(5.0, max(0.2, 0.9 * max(error, 1e-8) ** (-1.0 / numbers[ERROR_ORDER])))
    work[0] = h if 1.0 <= factor <= KEPT else h * factor
    return error


@lean(DENSE)
def linear(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out):
    """The line between the ends, which stays between them: of order 2, as the methods of fixed steps here are."""
    for k in range(y0.size):
        out[k] = (1.0 - theta) * y0[k] + theta * y1[k]
