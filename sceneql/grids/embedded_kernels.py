# mypy: ignore-errors
"""The error of a step on a grid, by the embedded method (grid_stage_kernels)."""

import math

from sceneql.compiled.kernels import lean
from sceneql.grids import grid_stage_kernels as stage
from sceneql.grids.multigrid import layout
from sceneql.grids.multigrid.linear_kernels import solver_at

KEPT = 1.2
"""Increase of the step below which a new factorization does not pay."""


@lean(stage.EMBEDDED_ERROR, inner=True)
def embedded_error(h, a, y0, y1, work, settings, numbers, floats):
    """The error in units of the tolerance, filtered by the stage system; the length to try next in work[0]."""
    n, stages = y0.size, numbers[stage.STAGES]
    base, scratch = work[:n], work[(1 + stages) * n : (2 + stages) * n]
    change, store = work[(2 + stages) * n : (3 + stages) * n], work[(3 + stages) * n :]
    plan = numbers[stage.HEAD :]
    solve = solver_at(plan[layout.SOLVER])
    e = stage.TABLEAU + 2 * stages
    at = plan[layout.AT]
    size = 0.0
    for k in range(n):
        total = 0.0
        for j in range(stages):
            total += settings[e + j] * work[(1 + j) * n + k]
        base[k] = h * total
    cells = plan[layout.NX] * plan[layout.NY] * plan[layout.NZ]
    for c in range(cells):
        scratch[c] = floats[plan[layout.VOLUME] + c] / a * base[at + c]
        size += scratch[c] * scratch[c]
    if size > 0.0 and not solve(plan, a, 1e-2 * math.sqrt(size), floats, scratch, change, store):
        work[0] = 0.25 * h
        return math.inf
    error = 0.0
    for c in range(cells if size > 0.0 else 0):
        allowed = settings[stage.ABSOLUTE] + settings[stage.RELATIVE] * max(abs(y0[at + c]), abs(y1[at + c]))
        error += (stage.SHARE * change[c] / allowed) ** 2
    error = math.sqrt(error / cells)
    factor = min(5.0, max(0.2, 0.9 * max(error, 1e-8) ** (-1.0 / numbers[stage.ERROR_ORDER])))
    work[0] = h if 1.0 <= factor <= KEPT else h * factor
    return error
