# mypy: ignore-errors
"""Textbook iterations for M d = r of a grid: Gauss-Seidel, successive over-relaxation, conjugate gradients.

All start from d = 0, stop where the 2-norm of the residual is at most ``target`` and return the iterations taken,
negative where that was not reached; ``history`` gets the norm after every CHECKED sweeps (every iteration of the
conjugate gradients), as many as there is room.
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.grids.multigrid import layout
from sceneql.grids.multigrid.linear_kernels import SOLVE, divided, forget, matrix, noted
from sceneql.grids.multigrid.stencil_kernels import multiply

CHECKED = 4
"""Sweeps between two evaluations of the residual."""


@lean_inlined
def diagonal(nx, ny, nz, scale, volume, sink, gx, gy, gz, out):
    """The diagonal of M, and the largest part of it that its faces are: the norm of Jacobi's iteration."""
    largest = 0.0
    plane = nx * ny
    for k in range(nz):
        up = ((k + 1) % nz - k) * plane
        for j in range(ny):
            row = nx * j + plane * k
            high = ((j + 1) % ny - j) * nx
            for i in range(nx):
                c = row + i
                faces = gx[c] + gx[c + 1 if i < nx - 1 else row] + gy[c] + gy[c + high]
                if nz > 1:
                    faces += gz[c] + gz[c + up]
                out[c] = scale * volume[c] + sink[c] + faces
                largest = max(largest, faces / out[c])
    return largest


@lean_inlined
def best_factor(largest, cells):
    """The factor of over-relaxation (Young 1971) for a norm of Jacobi's iteration on so many cells in a row."""
    norm = largest * math.cos(math.pi / (cells + 1))
    return 2.0 / (1.0 + math.sqrt(max(0.0, 1.0 - norm * norm)))


@lean_inlined
def relax_all(nx, ny, nz, gx, gy, gz, parts, r, d, kept):
    """One sweep over the cells in their order: d = kept d + parts (r + sum of g times neighbors).

    What a cell takes from the one before it, which has just changed, is added last: so that the processor has to wait
    for a product and a sum alone.
    """
    plane = nx * ny
    for k in range(nz):
        down, up = ((k - 1) % nz - k) * plane, ((k + 1) % nz - k) * plane
        for j in range(ny):
            row = nx * j + plane * k
            low, high = ((j - 1) % ny - j) * nx, ((j + 1) % ny - j) * nx
            own, known, part, x_ties = d[row:], r[row:], parts[row:], gx[row:]
            low_ties, below, high_ties, above = gy[row:], d[row + low :], gy[row + high :], d[row + high :]
            before = own[nx - 1]
            for i in range(nx):
                right = i + 1 if i < nx - 1 else 0
                total = known[i] + x_ties[right] * own[right] + low_ties[i] * below[i] + high_ties[i] * above[i]
                if nz > 1:
                    total += gz[row + i] * d[row + i + down] + gz[row + i + up] * d[row + i + up]
                before = (kept * own[i] + part[i] * total) + (part[i] * x_ties[i]) * before
                own[i] = before


@lean_inlined
def relaxation(nx, ny, nz, scale, volume, sink, gx, gy, gz, r, d, weights, q, over, target, most, history):
    """Gauss-Seidel sweeps (Seidel 1874), over-relaxed where ``over`` is true (Frankel 1950; Young 1954)."""
    n = nx * ny * nz
    largest = diagonal(nx, ny, nz, scale, volume, sink, gx, gy, gz, weights)
    factor = best_factor(largest, max(nx, ny, nz)) if over else 1.0
    for c in range(n):
        d[c], weights[c] = 0.0, factor / weights[c]
    for iteration in range(0, most + 1, CHECKED):
        multiply(nx, ny, nz, scale, volume, sink, gx, gy, gz, d, q)
        size = 0.0
        for c in range(n):
            size += (r[c] - q[c]) * (r[c] - q[c])
        size = math.sqrt(size)
        if iteration < CHECKED * history.size:
            history[iteration // CHECKED] = size
        if size <= target:
            return iteration
        if not size < math.inf:
            break
        for _ in range(CHECKED):
            relax_all(nx, ny, nz, gx, gy, gz, weights, r, d, 1.0 - factor)
    return -most


@lean_inlined
def conjugate_gradient(nx, ny, nz, scale, volume, sink, gx, gy, gz, r, d, weights, p, q, target, most, history):
    """Conjugate gradients (Hestenes & Stiefel 1952) with the diagonal as preconditioner; the residual is left in r."""
    n = nx * ny * nz
    diagonal(nx, ny, nz, scale, volume, sink, gx, gy, gz, weights)
    size = rz = 0.0
    for c in range(n):
        d[c] = 0.0
        p[c] = r[c] / weights[c]
        rz += r[c] * p[c]
        size += r[c] * r[c]
    for iteration in range(most):
        size = math.sqrt(size)
        if iteration < history.size:
            history[iteration] = size
        if size <= target:
            return iteration
        if not size < math.inf:
            break
        alpha = rz / multiply(nx, ny, nz, scale, volume, sink, gx, gy, gz, p, q)
        before = rz
        rz = size = 0.0
        for c in range(n):
            d[c] += alpha * p[c]
            r[c] -= alpha * q[c]
            rz += r[c] * r[c] / weights[c]
            size += r[c] * r[c]
        for c in range(n):
            p[c] = r[c] / weights[c] + rz / before * p[c]
    return -most


@lean(SOLVE, inner=True)
def solve_gauss_seidel(plan, a, target, floats, r, d, store):
    """A linear solver (linear_kernels)."""
    nx, ny, nz, volume, sink, gx, gy, gz = matrix(plan, floats)
    p, q, _, record = divided(plan, store)
    forget(record)
    history = record[layout.HISTORY :]
    found = relaxation(
        nx, ny, nz, 1.0 / a, volume, sink, gx, gy, gz, r, d, p, q, False, target, plan[layout.MOST], history
    )
    return noted(record, found)


@lean(SOLVE, inner=True)
def solve_sor(plan, a, target, floats, r, d, store):
    """A linear solver (linear_kernels)."""
    nx, ny, nz, volume, sink, gx, gy, gz = matrix(plan, floats)
    p, q, _, record = divided(plan, store)
    forget(record)
    history = record[layout.HISTORY :]
    found = relaxation(
        nx, ny, nz, 1.0 / a, volume, sink, gx, gy, gz, r, d, p, q, True, target, plan[layout.MOST], history
    )
    return noted(record, found)


@lean(SOLVE, inner=True)
def solve_conjugate_gradient(plan, a, target, floats, r, d, store):
    """A linear solver (linear_kernels)."""
    nx, ny, nz, volume, sink, gx, gy, gz = matrix(plan, floats)
    p, q, own, record = divided(plan, store)
    forget(record)
    history = record[layout.HISTORY :]
    found = conjugate_gradient(
        nx, ny, nz, 1.0 / a, volume, sink, gx, gy, gz, r, d, own, p, q, target, plan[layout.MOST], history
    )
    return noted(record, found)
