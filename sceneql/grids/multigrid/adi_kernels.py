# mypy: ignore-errors
"""One step by alternating directions: tridiagonal systems along x, then y, then z.

``numbers``: at, nx, ny, nz, offsets of volumes, sink, gx, gy, gz. ``work``: four arrays of y's size.
"""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.grids.multigrid.stencil_kernels import dot
from sceneql.system.signatures_kernels import STEP, A, F, N

AT, NX, NY, NZ, VOLUMES, SINK, FACES = range(7)
LINE = types.void(N, N, N, F, F, A, A, A, A, A, A)


@lean_inlined
def eliminate(start, stride, count, first, last, scale, share, volume, sink, g, d, factors):
    """Solve one line's tridiagonal system (Thomas 1949); ``first`` and ``last`` are added to the ends' diagonals."""
    before = 0.0
    for k in range(count):
        c = start + k * stride
        after = g[c + stride] if k < count - 1 else 0.0
        low = g[c] if k > 0 else 0.0
        whole = scale * volume[c] + share * sink[c] + low + after
        if k == 0:
            whole += first
        if k == count - 1:
            whole += last
        whole -= low * before
        d[c] = (d[c] + (low * d[c - stride] if k > 0 else 0.0)) / whole
        before = after / whole
        factors[c] = before
    for k in range(count - 2, -1, -1):
        c = start + k * stride
        d[c] += factors[c] * d[c + stride]


@lean(LINE, inner=True)
def solve_line(start, stride, count, scale, share, volume, sink, g, d, factors, extra):
    """d from the right side in its place, for one line; where it is closed by Sherman and Morrison's formula."""
    tie = g[start]
    end = start + (count - 1) * stride
    if tie == 0.0 or count < 3:
        eliminate(start, stride, count, 0.0, 0.0, scale, share, volume, sink, g, d, factors)
        return
    # M = T + tie (e_first - e_last)(e_first - e_last)^T
    for k in range(count):
        extra[start + k * stride] = 0.0
    extra[start] = tie
    extra[end] = -tie
    eliminate(start, stride, count, 0.0, 0.0, scale, share, volume, sink, g, d, factors)
    eliminate(start, stride, count, 0.0, 0.0, scale, share, volume, sink, g, extra, factors)
    weight = (d[start] - d[end]) / (1.0 + extra[start] - extra[end])
    for k in range(count):
        d[start + k * stride] -= weight * extra[start + k * stride]


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 = y0 + prod (1 - h/2 A_k)^-1 h f(t + h/2, y0), A_k the operator along axis k; fixed steps."""
    rate = rate_at(functions[AT_RATE])
    at, nx, ny, nz = numbers[AT], numbers[NX], numbers[NY], numbers[NZ]
    plane = nx * ny
    n, m = plane * nz, y0.size
    volume, sink = floats[numbers[VOLUMES] : numbers[VOLUMES] + n], floats[numbers[SINK] : numbers[SINK] + n]
    slope, d, factors, extra = work[:m], work[m : m + n], work[2 * m : 2 * m + n], work[3 * m : 3 * m + n]
    rate(t + 0.5 * h, y0, slope, floats, ints)
    scale = 2.0 / h
    axes = 3 if nz > 1 else 2
    share = 1.0 / axes
    for c in range(n):
        d[c] = h * slope[at + c]
    for axis in range(axes):
        g = floats[numbers[FACES + axis] : numbers[FACES + axis] + n]
        for c in range(n):
            d[c] *= scale * volume[c]
        if axis == 0:
            for row in range(ny * nz):
                solve_line(row * nx, 1, nx, scale, share, volume, sink, g, d, factors, extra)
        elif axis == 1:
            for k in range(nz):
                for i in range(nx):
                    solve_line(i + k * plane, nx, ny, scale, share, volume, sink, g, d, factors, extra)
        else:
            for c in range(plane):
                solve_line(c, plane, nz, scale, share, volume, sink, g, d, factors, extra)
    for k in range(m):
        y1[k] = y0[k]
    for c in range(n):
        y1[at + c] += d[c]
    # Fluxes inside cancel, so the increase of the total is the inflow.
    y1[at + n] += dot(volume, d)
    return 0.0
