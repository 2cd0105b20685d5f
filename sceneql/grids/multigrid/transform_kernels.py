# mypy: ignore-errors
"""M d = r of a flat box by a transform along x and tridiagonal systems along y (Buzbee, Golub & Nielson 1970).

``table``: float64 numbers kept as integers: the modes of a row, one a row, (nx, nx), the same transposed, eigenvalues
(nx,), the conductances along y (ny,), what sinks along y (ny,), the volume of a cell. ``own``: the eliminated factors
(cells), the inverse pivots (cells), the transform of the right side (cells).
"""

import numpy as np

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.grids.multigrid import layout
from sceneql.grids.multigrid.linear_kernels import SOLVE, divided, forget, noted, to_prepare


@lean_inlined
def combine(weights, rows, out):
    """out = weights @ rows; four rows at a time, over contiguous numbers."""
    n = out.size
    for i in range(n):
        out[i] = 0.0
    whole = n - n % 4
    for m in range(0, whole, 4):
        a, b, c, d = weights[m], weights[m + 1], weights[m + 2], weights[m + 3]
        row_a, row_b = rows[m * n : (m + 1) * n], rows[(m + 1) * n : (m + 2) * n]
        row_c, row_d = rows[(m + 2) * n : (m + 3) * n], rows[(m + 3) * n : (m + 4) * n]
        for i in range(n):
            out[i] += (a * row_a[i] + b * row_b[i]) + (c * row_c[i] + d * row_d[i])
    for m in range(whole, n):
        for i in range(n):
            out[i] += weights[m] * rows[m * n + i]


@lean_inlined
def factor_transform(table, nx, ny, scale, own):
    """Eliminate the tridiagonal system of every mode."""
    numbers = table.view(np.float64)[nx * nx :]
    n = nx * ny
    values = numbers[nx * nx : nx * nx + nx]
    gy, sink = numbers[nx * nx + nx : nx * nx + nx + ny], numbers[nx * nx + nx + ny : nx * nx + nx + 2 * ny]
    volume = numbers[nx * nx + nx + 2 * ny]
    factors, pivots = own[:n], own[n : 2 * n]
    for j in range(ny):
        low = gy[j] if j > 0 else 0.0
        high = gy[j + 1] if j < ny - 1 else 0.0
        for m in range(nx):
            whole = scale * volume + values[m] + sink[j] + low + high
            if j > 0:
                whole -= low * factors[(j - 1) * nx + m]
            pivots[j * nx + m] = 1.0 / whole
            factors[j * nx + m] = high / whole


@lean_inlined
def solve_transform(table, nx, ny, r, d, own):
    """d from r."""
    numbers = table.view(np.float64)
    n = nx * ny
    modes, across = numbers[: nx * nx], numbers[nx * nx : 2 * nx * nx]
    gy = numbers[2 * nx * nx + nx : 2 * nx * nx + nx + ny]
    factors, pivots, w = own[:n], own[n : 2 * n], own[2 * n : 3 * n]
    for j in range(ny):
        combine(r[j * nx : (j + 1) * nx], across, w[j * nx : (j + 1) * nx])
        if j == 0:
            for m in range(nx):
                w[m] *= pivots[m]
        else:
            for m in range(nx):
                c = j * nx + m
                w[c] = (w[c] + gy[j] * w[c - nx]) * pivots[c]
    for j in range(ny - 1, -1, -1):
        if j < ny - 1:
            for m in range(nx):
                c = j * nx + m
                w[c] += factors[c] * w[c + nx]
        combine(w[j * nx : (j + 1) * nx], modes, d[j * nx : (j + 1) * nx])


@lean(SOLVE, inner=True)
def solve(plan, a, target, floats, r, d, store):
    """The linear solver (linear_kernels)."""
    nx, ny, table = plan[layout.NX], plan[layout.NY], plan[layout.PLAN :]
    _, _, own, record = divided(plan, store)
    forget(record)
    if to_prepare(plan, a, record):
        factor_transform(table, nx, ny, 1.0 / a, own)
        record[layout.FACTORED] = a
    solve_transform(table, nx, ny, r, d, own)
    return noted(record, 1)
