# mypy: ignore-errors
"""Sparse factorization of a grid's systems by the multifrontal kernels of linear/.

The plan: [values of the matrix, factors, scratch], then for every value its cell and what it is (0: the diagonal; 1, 2,
3: the face on the low side along x, y, z; 4, 5, 6: that on the high side), then the integers of the fronts. ``own``:
values, factors, scratch.
"""

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.grids.multigrid import layout
from sceneql.grids.multigrid.linear_kernels import SOLVE, divided, forget, matrix, noted, to_prepare
from sceneql.linear.multifrontal.solve_kernels import solve_symmetric
from sceneql.linear.multifrontal.symmetric_kernels import factor_symmetric

VALUES, FACTORS, SCRATCH, ENTRIES = range(4)


@lean_inlined
def factor_direct(plan, nx, ny, nz, scale, volume, sink, gx, gy, gz, own):
    """Factor M = scale V + K; False where a pivot is 0."""
    count = plan[VALUES]
    plane = nx * ny
    for e in range(count):
        c, face = plan[ENTRIES + 2 * e], plan[ENTRIES + 2 * e + 1]
        i, j, k = c % nx, c // nx % ny, c // plane
        right = c + (1 if i < nx - 1 else 1 - nx)
        above = c + (nx if j < ny - 1 else nx - plane)
        front = c + (plane if k < nz - 1 else plane - plane * nz)
        value = scale * volume[c] + sink[c] if face == 0 else 0.0
        if face == 0:
            value += gx[c] + gx[right] + gy[c] + gy[above]
            if nz > 1:
                value += gz[c] + gz[front]
        elif face == 1:
            value -= gx[c]
        elif face == 2:
            value -= gy[c]
        elif face == 3:
            value -= gz[c]
        elif face == 4:
            value -= gx[right]
        elif face == 5:
            value -= gy[above]
        else:
            value -= gz[front]
        own[e] = value
    factors = own[count:]
    return factor_symmetric(plan[ENTRIES + 2 * count :], own, factors, factors[plan[FACTORS] :])


@lean_inlined
def solve_direct(plan, r, d, own):
    """d from r by the factors."""
    count = plan[VALUES]
    for c in range(r.size if r.size < d.size else d.size):
        d[c] = r[c]
    factors = own[count:]
    solve_symmetric(plan[ENTRIES + 2 * count :], factors, d, factors[plan[FACTORS] :])


@lean(SOLVE, inner=True)
def solve(plan, a, target, floats, r, d, store):
    """The linear solver (linear_kernels)."""
    nx, ny, nz, volume, sink, gx, gy, gz = matrix(plan, floats)
    _, _, own, record = divided(plan, store)
    forget(record)
    entries = plan[layout.PLAN :]
    if to_prepare(plan, a, record):
        if not factor_direct(entries, nx, ny, nz, 1.0 / a, volume, sink, gx, gy, gz, own):
            return False
        record[layout.FACTORED] = a
    solve_direct(entries, r, d, own)
    return noted(record, 1)
