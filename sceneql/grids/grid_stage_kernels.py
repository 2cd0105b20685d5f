# mypy: ignore-errors
"""One step of a diagonally implicit Runge-Kutta method on an island that is one field on a grid (system.Grid).

Every stage y = base + a f(t, y) is solved to a small residual by the linear solver of the plan, and then its slope
f(t, y) is evaluated at the solution. So the fluxes conserve to rounding, however inexactly the systems are solved.
Nonlinear stages and error estimates are compiled at the first step that needs them (iterate_kernels, embedded_kernels).

``settings``: relative and absolute size of a residual that is small, the diagonal g of the tableau, then c (s), b (s),
b - b_hat (s), the rows of a below the diagonal, packed. ``numbers``: [stages, 1 if the first is explicit, 1 if there is
an embedded method, order of its error], then the plan (see the names below; all indices count from its start).
``work``: s + 2 arrays of y's size (the first holds the step to try next in its first entry; slopes; scratch), then the
store of the plan: p, q (cells), what the linear solver keeps, RECORD entries of what it did.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.grids.multigrid import layout
from sceneql.grids.multigrid.linear_kernels import solver_at
from sceneql.system.signatures_kernels import DENSE, STEP, A, F, I

ITERATE = types.boolean(I, F, F, A, A, A, A, A, A, I, A, A, I)
EMBEDDED_ERROR = types.float64(F, F, A, A, A, A, I, A)

iterate = lazy("sceneql.grids.iterate_kernels:iterate", ITERATE)
embedded_error = lazy("sceneql.grids.embedded_kernels:embedded_error", EMBEDDED_ERROR)

STAGES, EXPLICIT_FIRST, EMBEDDED, ERROR_ORDER, HEAD = range(5)
RELATIVE, ABSOLUTE, DIAGONAL, TABLEAU = range(4)

SHARE = 0.02
"""Largest residual relative to the tolerance of adaptive steps: settings hold it times the tolerance."""


@lean_inlined
def solve_stage(functions, t, a, base, y, slope, r, d, store, plan, settings, floats, ints):
    """Solve y = base + a f(t, y) from a guess, and set slope = f(t, y); False where it is not solved."""
    at = plan[layout.AT]
    n = plan[layout.NX] * plan[layout.NY] * plan[layout.NZ]
    r, d = r[:n], d[:n]
    if plan[layout.EXACT] == 1 and plan[layout.FED] >= 0:
        # Linear and solved to rounding: once is enough.
        volume = floats[plan[layout.VOLUME] : plan[layout.VOLUME] + n]
        fed = floats[plan[layout.FED] : plan[layout.FED] + n]
        for c in range(n):
            r[c] = volume[c] * base[at + c] / a + fed[c]
        if not solver_at(plan[layout.SOLVER])(plan, a, 0.0, floats, r, d, store):
            return False
        for c in range(n):
            y[at + c] = d[c]
        rate_at(functions[AT_RATE])(t, y, slope, floats, ints)
        return True
    return iterate(functions, t, a, base, y, slope, r, d, store, plan, settings, floats, ints)


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
    base, scratch = work[:n], work[(1 + stages) * n : (2 + stages) * n]
    change = work[(2 + stages) * n : (3 + stages) * n]
    store = work[(3 + stages) * n :]
    plan = numbers[HEAD:]
    b = TABLEAU + stages
    row = b + 2 * stages
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
            functions, t_stage, a, base, y1, slope, scratch, change, store, plan, settings, floats, ints
        ):
            y1[plan[layout.AT]] = math.nan
            work[0] = 0.25 * h
            return math.inf
        for k in range(n):
            y1[k] = base[k] + a * slope[k]
    add_slopes(settings, b, stages, h, y0, work, y1)
    if numbers[EMBEDDED] == 0:
        return 0.0
    return embedded_error(h, a, y0, y1, work, settings, numbers, floats)


@lean(DENSE)
def linear(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out):
    """Linear dense output, which stays within the bounds of the ends: of order 2, as the methods of fixed steps are."""
    for k in range(y0.size):
        out[k] = (1.0 - theta) * y0[k] + theta * y1[k]
