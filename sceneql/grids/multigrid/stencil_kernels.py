# mypy: ignore-errors
"""The five- or seven-point operator on a grid: M x = s x + sum over faces of g (x - neighbor), s and g at least 0.

Cell (i, j, k) stands at i + nx (j + ny k). A face's conductance g stands with the cell on its high side: ``gx[cell]``
between the cell and the one before it along x, and round the grid from the last to the first. Where a domain is not
periodic those are 0, so that no loop asks for the boundary. ``gz`` is read where nz > 1 alone.
"""

from sceneql.compiled.kernels import lean_inlined
from sceneql.compiled.lanes_kernels import load, store

LANE = 8
"""Numbers of a lane."""


@lean_inlined
def flow(x, gx, gy, gz, cell, left, right, below, above, back, front, deep):
    """Sum of g (neighbor - x) of a cell."""
    own = x[cell]
    total = gx[cell] * (x[left] - own) + gx[right] * (x[right] - own)
    total += gy[cell] * (x[below] - own) + gy[above] * (x[above] - own)
    if deep:
        total += gz[cell] * (x[back] - own) + gz[front] * (x[front] - own)
    return total


@lean_inlined
def flow_of_lanes(x, gx, gy, gz, cell, below, above, back, front, deep):
    """`flow` of as many cells of a row as a lane has numbers, all of them with neighbors along it."""
    own = load(x, cell)
    total = load(gx, cell) * (load(x, cell - 1) - own) + load(gx, cell + 1) * (load(x, cell + 1) - own)
    total = total + (load(gy, cell) * (load(x, below) - own) + load(gy, above) * (load(x, above) - own))
    if deep:
        total = total + (load(gz, cell) * (load(x, back) - own) + load(gz, front) * (load(x, front) - own))
    return total


@lean_inlined
def dot(a, b):
    """The inner product in float64, in four parts so that additions need not wait for each other."""
    s0 = s1 = s2 = s3 = 0.0
    n = a.size - a.size % 4
    for k in range(0, n, 4):
        s0 += a[k] * b[k]
        s1 += a[k + 1] * b[k + 1]
        s2 += a[k + 2] * b[k + 2]
        s3 += a[k + 3] * b[k + 3]
    for k in range(n, a.size):
        s0 += a[k] * b[k]
    return (s0 + s1) + (s2 + s3)


@lean_inlined
def multiply(nx, ny, nz, scale, volume, sink, gx, gy, gz, x, out):
    """out = M x with s = scale * volume + sink; returns x . out."""
    deep = nz > 1
    plane = nx * ny
    for k in range(nz):
        down, up = ((k - 1) % nz - k) * plane, ((k + 1) % nz - k) * plane
        for j in range(ny):
            row = nx * j + plane * k
            last = row + nx - 1
            low, high = ((j - 1) % ny - j) * nx, ((j + 1) % ny - j) * nx
            rest = row + 1
            for c in range(row + 1, last - LANE + 1, LANE):
                total = flow_of_lanes(x, gx, gy, gz, c, c + low, c + high, c + down, c + up, deep)
                store(out, c, (scale * load(volume, c) + load(sink, c)) * load(x, c) - total)
                rest = c + LANE
            for c in range(rest, last):
                total = flow(x, gx, gy, gz, c, c - 1, c + 1, c + low, c + high, c + down, c + up, deep)
                out[c] = (scale * volume[c] + sink[c]) * x[c] - total
            for c in range(row, last + 1, max(1, nx - 1)):
                left, right = (last if c == row else c - 1), (row if c == last else c + 1)
                total = flow(x, gx, gy, gz, c, left, right, c + low, c + high, c + down, c + up, deep)
                out[c] = (scale * volume[c] + sink[c]) * x[c] - total
    return dot(x, out)
