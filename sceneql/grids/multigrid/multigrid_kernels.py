# mypy: ignore-errors
"""Conjugate gradients for M d = r, M = V/a + K of a grid (stencil_kernels), preconditioned by one multigrid cycle.

The cycle is a symmetric V(2,2)-cycle in float32: red-black Gauss-Seidel before, black-red after, sums of residuals
down, constants up. A coarse face has half the sum of the conductances of its fine faces: the sum alone, the Galerkin
product of constants, is twice what a grid of twice the spacing has (Braess 1995, Computing 55, 379-393).
The conjugate gradients are the flexible ones (Notay 2000, SIAM J. Sci. Comput. 22, 1444-1460), since rounding makes the
cycle a slightly different operator every time.

The plan: the number of levels, then of each a row of LEVEL integers: nx, ny, nz, where its float32 arrays start; they
lie one after another: gx, gy, gz (where nz > 1), volume, sink, inverse diagonal, x, b. After the last level come nx
numbers of scratch.
"""

import math

import numpy as np

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.grids.multigrid import layout
from sceneql.grids.multigrid.linear_kernels import SOLVE, divided, forget, matrix, noted, to_prepare
from sceneql.grids.multigrid.smoothing_kernels import add_coarse, first_sweep, restrict_residual, sweep
from sceneql.grids.multigrid.stencil_kernels import dot, multiply

LEVEL = 4
SWEEPS = 2
"""Smoothing sweeps before and after the coarser levels: one would need twice as many iterations and cost more."""
BOTTOM = 16
"""Sweeps on the coarsest level."""


@lean_inlined
def parts(table, level, arrays):
    """Shape and arrays of a level."""
    at = LEVEL * level
    nx, ny, nz, start = table[at], table[at + 1], table[at + 2], table[at + 3]
    n = nx * ny * nz
    gx, gy = arrays[start : start + n], arrays[start + n : start + 2 * n]
    gz = arrays[start + 2 * n : start + 3 * n]
    start += 3 * n if nz > 1 else 2 * n
    volume, sink = arrays[start : start + n], arrays[start + n : start + 2 * n]
    start += 2 * n
    inverse, x, b = arrays[start : start + n], arrays[start + n : start + 2 * n], arrays[start + 2 * n : start + 3 * n]
    return nx, ny, nz, gx, gy, gz, volume, sink, inverse, x, b


@lean_inlined
def take_in(table, levels, arrays, unit, volume, sink, gx, gy, gz):
    """Fill all levels from the grid's float64 arrays, in units of ``unit`` (a cell's volume over a typical a)."""
    nx, ny, nz, fx, fy, fz, fv, fs, _, _, _ = parts(table, 0, arrays)
    scale = 1.0 / unit
    for c in range(nx * ny * nz):
        fx[c], fy[c], fv[c], fs[c] = scale * gx[c], scale * gy[c], scale * volume[c], scale * sink[c]
    if nz > 1:
        for c in range(nx * ny * nz):
            fz[c] = scale * gz[c]
    for level in range(1, levels):
        coarsen(table, level, arrays)


@lean_inlined
def coarsen(table, level, arrays):
    """A level's arrays from those of the finer one."""
    nx, ny, nz, fx, fy, fz, fv, fs, _, _, _ = parts(table, level - 1, arrays)
    mx, my, mz, cx, cy, cz, cv, cs, _, _, _ = parts(table, level, arrays)
    half = np.float32(0.5)
    sx, sy, sz = mx < nx, my < ny, mz < nz
    for c in range(mx * my * mz):
        cx[c] = cy[c] = cv[c] = cs[c] = 0.0
    if nz > 1 and mz > 1:
        for c in range(mx * my * mz):
            cz[c] = 0.0
    for k in range(nz):
        for j in range(ny):
            row = nx * (j + ny * k)
            target = mx * ((j >> 1 if sy else j) + my * (k >> 1 if sz else k))
            for i in range(nx):
                c, f = target + (i >> 1 if sx else i), row + i
                cv[c] += fv[f]
                cs[c] += half * fs[f]
                if not sx or i & 1 == 0:
                    cx[c] += half * fx[f] if sx else fx[f]
                if not sy or j & 1 == 0:
                    cy[c] += half * fy[f] if sy else fy[f]
                if mz > 1 and (not sz or k & 1 == 0):
                    cz[c] += half * fz[f] if sz else fz[f]


@lean_inlined
def shift(table, levels, arrays, scale):
    """The inverse diagonals of scale * volume + K on all levels; 1 for a cell whose diagonal is 0."""
    for level in range(levels):
        nx, ny, nz, gx, gy, gz, volume, sink, inverse, _, _ = parts(table, level, arrays)
        plane = nx * ny
        for k in range(nz):
            up = ((k + 1) % nz - k) * plane
            for j in range(ny):
                row = nx * j + plane * k
                high = ((j + 1) % ny - j) * nx
                for c in range(row, row + nx):
                    right = c + 1 if c < row + nx - 1 else row
                    total = gx[c] + gx[right] + gy[c] + gy[c + high] + sink[c] + np.float32(scale) * volume[c]
                    if nz > 1:
                        total += gz[c] + gz[c + up]
                    inverse[c] = 1.0 / total if total > 0.0 else 1.0


@lean_inlined
def cycle(table, levels, arrays):
    """One V-cycle on level 0: its x from its b, from x = 0; the last numbers of ``arrays`` are scratch."""
    line = arrays[arrays.size - table[0] :]
    for stage in range(2 * levels):
        # Down and up in one loop, so that inlined kernels are compiled once.
        down = stage < levels
        level = stage if down else 2 * levels - 1 - stage
        nx, ny, nz, gx, gy, gz, _, _, inverse, x, b = parts(table, level, arrays)
        mx, my, mz, _, _, _, _, _, _, coarse_x, coarse_b = parts(table, min(level + 1, levels - 1), arrays)
        count = 2 * (SWEEPS if level + 1 < levels or down else BOTTOM)
        if down:
            first_sweep(nx, ny, nz, inverse, x, b, 0)
        elif level + 1 < levels:
            add_coarse(nx, ny, nz, x, mx, my, mz, coarse_x)
        for number in range(1 if down else 0, count):
            sweep(nx, ny, nz, inverse, gx, gy, gz, x, b, number & 1 if down else (number + 1) & 1, line)
        if down and level + 1 < levels:
            restrict_residual(nx, ny, nz, inverse, gx, gy, gz, x, b, 0, mx, my, mz, coarse_b, line)


@lean_inlined
def iterate(nx, ny, nz, scale, volume, sink, gx, gy, gz, table, levels, arrays, r, d, p, q, target, most, history):
    """d from d = 0 with the residual left in r; the iterations taken, negative where ``target`` was not reached.

    ``target``: largest 2-norm of the residual. ``history``: its norm after every iteration, as many as there is room.
    """
    n = nx * ny * nz
    _, _, _, _, _, _, _, _, _, z, b = parts(table, 0, arrays)
    r, d = r[:n], d[:n]
    for c in range(n):
        d[c] = 0.0
    size = math.sqrt(dot(r, r))
    alpha = before = 0.0
    for iteration in range(most):
        if history.size > iteration:
            history[iteration] = size
        if size <= target:
            return iteration
        # float32 holds the residual in units of its own size.
        unit = 1.0 / size
        for c in range(n):
            b[c] = unit * r[c]
        cycle(table, levels, arrays)
        product = size * dot(z, r)
        beta = -alpha * size * dot(z, q) / before if iteration > 0 else 0.0
        for c in range(n):
            p[c] = size * z[c] + (beta * p[c] if iteration > 0 else 0.0)
        before = product
        alpha = before / multiply(nx, ny, nz, scale, volume, sink, gx, gy, gz, p, q)
        for c in range(n):
            d[c] += alpha * p[c]
            r[c] -= alpha * q[c]
        size = math.sqrt(dot(r, r))
        if not size < math.inf:
            return -iteration - 1
    return -most if size > target else most


@lean(SOLVE, inner=True)
def solve(plan, a, target, floats, r, d, store):
    """The linear solver (linear_kernels)."""
    nx, ny, nz, volume, sink, gx, gy, gz = matrix(plan, floats)
    p, q, own, record = divided(plan, store)
    levels, table, arrays = plan[layout.PLAN], plan[layout.PLAN + 1 :], own.view(np.float32)
    if to_prepare(plan, a, record):
        if record[layout.TAKEN_IN] == 0.0 or plan[layout.VARYING] == 1:
            unit = 0.0
            for c in range(nx * ny * nz):
                unit = max(unit, gx[c], gy[c])
            # The float32 arrays are in units of the largest conductance.
            take_in(table, levels, arrays, unit if unit > 0.0 else 1.0, volume, sink, gx, gy, gz)
            record[layout.TAKEN_IN] = 1.0
        shift(table, levels, arrays, 1.0 / a)
        record[layout.FACTORED] = a
    forget(record)
    return noted(
        record,
        iterate(
            nx, ny, nz, 1.0 / a, volume, sink, gx, gy, gz, table, levels, arrays, r, d, p, q, target, plan[layout.MOST],
            record[layout.HISTORY:],
        ),
    )  # fmt: skip
