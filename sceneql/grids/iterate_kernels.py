# mypy: ignore-errors
"""A nonlinear or inexactly solved stage on a grid: iterations on its residual (grid_stage_kernels)."""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.grids import grid_stage_kernels as stage
from sceneql.grids.multigrid import layout
from sceneql.grids.multigrid.linear_kernels import solver_at
from sceneql.grids.multigrid.stencil_kernels import dot

MOST_NEWTON = 40
LOCAL = 30.0
"""Largest error of one cell by its residual, in mean errors: small cells at a boundary add little to the mean."""
UNSOLVED = 1e-13
"""Rounding error of a residual, relative to the numbers that cancel in it."""


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
def worst(volume, r):
    """The residual that the largest cell would have if it changed as much as the cell whose own changes it most."""
    most = largest = 0.0
    for c in range(r.size):
        if volume[c] > 0.0:
            most = max(most, abs(r[c]) / volume[c])
            largest = max(largest, volume[c])
    return most * largest


@lean_inlined
def stiffest(plan, floats):
    """Largest (faces + sink)/V of a cell, but for a factor of 2."""
    n = plan[layout.NX] * plan[layout.NY] * plan[layout.NZ]
    most = 0.0
    for c in range(n):
        total = floats[plan[layout.GX] + c] + floats[plan[layout.GY] + c] + floats[plan[layout.SINK] + c]
        if plan[layout.NZ] > 1:
            total += floats[plan[layout.GZ] + c]
        most = max(most, total / floats[plan[layout.VOLUME] + c])
    return most


@lean(stage.ITERATE, inner=True)
def iterate(functions, t, a, base, y, slope, r, d, store, plan, settings, floats, ints):
    """Solve y = base + a f(t, y) from a guess, and set slope = f(t, y); False where it does not converge."""
    rate, solve = rate_at(functions[AT_RATE]), solver_at(plan[layout.SOLVER])
    at, n = plan[layout.AT], r.size
    volume, x = floats[plan[layout.VOLUME] : plan[layout.VOLUME] + n], y[at : at + n]
    cells = math.sqrt(dot(volume, volume))
    before = math.inf
    for iteration in range(MOST_NEWTON):
        rate(t, y, slope, floats, ints)
        size, whole, largest = residual(n, a, volume, base[at:], x, slope[at:], r, d)
        if not size < math.inf:
            return False
        if iteration == 0 and size > 2.0 * whole and plan[layout.VARYING] == 0:
            # The guess is far from the solution: y = 0 is better than one that changes fast.
            for c in range(n):
                x[c] = 0.0
            rate(t, y, slope, floats, ints)
            size, whole, largest = residual(n, a, volume, base[at:], x, slope[at:], r, d)
        target = settings[stage.RELATIVE] * max(whole, largest) + settings[stage.ABSOLUTE] * cells / a
        rounding = UNSOLVED * (1.0 + a * stiffest(plan, floats)) * max(whole, largest)
        small = size <= max(target, rounding)
        uneven = worst(volume, r) > LOCAL * max(target, rounding) / math.sqrt(r.size)
        if (small and not uneven) or (size > 0.5 * before and size <= 100.0 * rounding):
            return True
        before = size
        # For y = 0 the solution's size is not known yet, but that of the residual is.
        target = 0.1 * size if small else max(target, rounding, settings[stage.RELATIVE] * size)
        if not solve(plan, a, 0.5 * target, floats, r, d, store):
            return False
        for c in range(n):
            x[c] += d[c]
    return False
