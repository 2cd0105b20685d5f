# mypy: ignore-errors
"""The five- or seven-point operator on a grid: M x = s x + sum over faces of g (x - neighbor), s and g at least 0.

Cell (i, j, k) stands at i + nx (j + ny k). A face's conductance g stands with the cell on its high side: ``gx[cell]``
between the cell and the one before it along x, and round the grid from the last to the first. Where a domain is not
periodic those are 0, so that no loop asks for the boundary. ``gz`` is read where nz > 1 alone. The functions work on
float64 and on float32 arrays.
"""

from sceneql.kernels import lean_inlined


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
            for c in range(row + 1, last):
                total = flow(x, gx, gy, gz, c, c - 1, c + 1, c + low, c + high, c + down, c + up, deep)
                out[c] = (scale * volume[c] + sink[c]) * x[c] - total
            for c in range(row, last + 1, max(1, nx - 1)):
                left, right = (last if c == row else c - 1), (row if c == last else c + 1)
                total = flow(x, gx, gy, gz, c, left, right, c + low, c + high, c + down, c + up, deep)
                out[c] = (scale * volume[c] + sink[c]) * x[c] - total
    return dot(x, out)


@lean_inlined
def pulled(x, gx, gy, gz, c, left, right, below, above, back, front, deep):
    """Sum of g neighbor of a cell."""
    total = gx[c] * x[left] + gx[right] * x[right] + gy[c] * x[below] + gy[above] * x[above]
    if deep:
        total += gz[c] * x[back] + gz[front] * x[front]
    return total


@lean_inlined
def sweep(nx, ny, nz, inverse, gx, gy, gz, x, b, color):
    """Make the equations of the cells of one color of the checkerboard true (Young 1971); ``inverse`` diagonal of M."""
    deep = nz > 1
    plane = nx * ny
    for k in range(nz):
        down, up = ((k - 1) % nz - k) * plane, ((k + 1) % nz - k) * plane
        for j in range(ny):
            row = nx * j + plane * k
            last = row + nx - 1
            low, high = ((j - 1) % ny - j) * nx, ((j + 1) % ny - j) * nx
            start = row + ((j + k + color) & 1)
            if start == row:
                right = row + 1 if nx > 1 else row
                total = pulled(x, gx, gy, gz, row, last, right, row + low, row + high, row + down, row + up, deep)
                x[row] = (b[row] + total) * inverse[row]
                start = row + 2
            for c in range(start, last, 2):
                total = pulled(x, gx, gy, gz, c, c - 1, c + 1, c + low, c + high, c + down, c + up, deep)
                x[c] = (b[c] + total) * inverse[c]
            if nx > 1 and (last - row + j + k + color) & 1 == 0:
                total = pulled(
                    x, gx, gy, gz, last, last - 1, row, last + low, last + high, last + down, last + up, deep
                )
                x[last] = (b[last] + total) * inverse[last]


@lean_inlined
def first_sweep(nx, ny, nz, inverse, x, b, color):
    """The same where all of x is 0."""
    for k in range(nz):
        for j in range(ny):
            row = nx * (j + ny * k)
            start = (j + k + color) & 1
            for c in range(row + start, row + nx, 2):
                x[c] = b[c] * inverse[c]
            for c in range(row + 1 - start, row + nx, 2):
                x[c] = 0.0


@lean_inlined
def restrict_residual(nx, ny, nz, inverse, gx, gy, gz, x, b, color, mx, my, mz, coarse):
    """Sum the residuals b - M x of the cells of one color over the coarse cells (those of the other color are 0)."""
    deep = nz > 1
    plane = nx * ny
    half = 1 if mx < nx else 0
    for c in range(mx * my * mz):
        coarse[c] = 0.0
    for k in range(nz):
        down, up = ((k - 1) % nz - k) * plane, ((k + 1) % nz - k) * plane
        for j in range(ny):
            row = nx * j + plane * k
            last = row + nx - 1
            target = mx * ((j >> 1 if my < ny else j) + my * (k >> 1 if mz < nz else k))
            low, high = ((j - 1) % ny - j) * nx, ((j + 1) % ny - j) * nx
            start = (j + k + color) & 1
            for c in range(row + (start if start else 2), last, 2):
                total = b[c] + pulled(x, gx, gy, gz, c, c - 1, c + 1, c + low, c + high, c + down, c + up, deep)
                coarse[target + ((c - row) >> half)] += total - x[c] / inverse[c]
            for c in range(row, last + 1, max(1, nx - 1)):
                if (c - row + start) & 1 == 0:
                    left, right = (last if c == row else c - 1), (row if c == last else c + 1)
                    total = b[c] + pulled(x, gx, gy, gz, c, left, right, c + low, c + high, c + down, c + up, deep)
                    coarse[target + ((c - row) >> half)] += total - x[c] / inverse[c]


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
