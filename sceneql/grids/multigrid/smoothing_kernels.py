# mypy: ignore-errors
"""The passes of a multigrid cycle over a grid's operator (stencil_kernels), on float32 arrays.

Kernels of their own: where they stand in the cycle twice, they are compiled once.
"""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.system.signatures_kernels import N

S = types.float32[::1]


@lean_inlined
def pull_row(nx, row, low, high, down, up, deep, gx, gy, gz, x, out):
    """out = sum of g neighbor of every cell of a row; the offsets are those of the rows around.

    The whole row is done, also where cells of one color are asked for: in order it fills the processor's lanes.
    """
    own, below, above = x[row : row + nx], x[row + low : row + low + nx], x[row + high : row + high + nx]
    g, g_below, g_above = gx[row : row + nx], gy[row : row + nx], gy[row + high : row + high + nx]
    last = nx - 1
    right = 1 if nx > 1 else 0
    out[0] = g[0] * own[last] + g[right] * own[right] + g_below[0] * below[0] + g_above[0] * above[0]
    if nx > 1:
        out[last] = g[last] * own[last - 1] + g[0] * own[0] + g_below[last] * below[last] + g_above[last] * above[last]
    for i in range(1, last):
        out[i] = g[i] * own[i - 1] + g[i + 1] * own[i + 1] + g_below[i] * below[i] + g_above[i] * above[i]
    if deep:
        back, front = x[row + down : row + down + nx], x[row + up : row + up + nx]
        g_back, g_front = gz[row : row + nx], gz[row + up : row + up + nx]
        for i in range(nx):
            out[i] += g_back[i] * back[i] + g_front[i] * front[i]


@lean(types.void(N, N, N, S, S, S, S, S, S, N, S), inner=True)
def sweep(nx, ny, nz, inverse, gx, gy, gz, x, b, color, line):
    """Gauss-Seidel on the cells of one color of the checkerboard (Young 1971); ``inverse``: of the diagonal of M.

    ``line``: scratch of nx numbers.
    """
    deep = nz > 1
    plane = nx * ny
    for k in range(nz):
        down, up = ((k - 1) % nz - k) * plane, ((k + 1) % nz - k) * plane
        for j in range(ny):
            row = nx * j + plane * k
            low, high = ((j - 1) % ny - j) * nx, ((j + 1) % ny - j) * nx
            pull_row(nx, row, low, high, down, up, deep, gx, gy, gz, x, line)
            own, right_side, over = x[row : row + nx], b[row : row + nx], inverse[row : row + nx]
            mine = (j + k + color) & 1
            for i in range(nx):
                found = (right_side[i] + line[i]) * over[i]
                own[i] = found if i & 1 == mine else own[i]


@lean_inlined
def first_sweep(nx, ny, nz, inverse, x, b, color):
    """As `sweep`, for x = 0."""
    for k in range(nz):
        for j in range(ny):
            row = nx * (j + ny * k)
            start = (j + k + color) & 1
            for c in range(row + start, row + nx, 2):
                x[c] = b[c] * inverse[c]
            for c in range(row + 1 - start, row + nx, 2):
                x[c] = 0.0


@lean(types.void(N, N, N, S, S, S, S, S, S, N, N, N, N, S, S), inner=True)
def restrict_residual(nx, ny, nz, inverse, gx, gy, gz, x, b, color, mx, my, mz, coarse, line):
    """Sum the residuals b - M x of the cells of one color over the coarse cells (those of the other color are 0).

    ``line``: scratch of nx numbers.
    """
    deep = nz > 1
    plane = nx * ny
    half = 1 if mx < nx else 0
    for c in range(mx * my * mz):
        coarse[c] = 0.0
    for k in range(nz):
        down, up = ((k - 1) % nz - k) * plane, ((k + 1) % nz - k) * plane
        for j in range(ny):
            row = nx * j + plane * k
            target = mx * ((j >> 1 if my < ny else j) + my * (k >> 1 if mz < nz else k))
            low, high = ((j - 1) % ny - j) * nx, ((j + 1) % ny - j) * nx
            pull_row(nx, row, low, high, down, up, deep, gx, gy, gz, x, line)
            own, right_side, over = x[row : row + nx], b[row : row + nx], inverse[row : row + nx]
            for i in range(nx):
                line[i] += right_side[i] - own[i] / over[i]
            for i in range((j + k + color) & 1, nx, 2):
                coarse[target + (i >> half)] += line[i]


@lean_inlined
def add_coarse(nx, ny, nz, x, mx, my, mz, coarse):
    """Add to every cell the value of its coarse cell."""
    for k in range(nz):
        for j in range(ny):
            row = nx * (j + ny * k)
            source = mx * ((j >> 1 if my < ny else j) + my * (k >> 1 if mz < nz else k))
            if mx < nx:
                for i in range(nx):
                    x[row + i] += coarse[source + (i >> 1)]
            else:
                for i in range(nx):
                    x[row + i] += coarse[source + i]
