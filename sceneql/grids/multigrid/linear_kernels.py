# mypy: ignore-errors
"""What the linear solvers of a grid share: one signature, the plan that they read, the record that they keep.

A solver is a kernel ``solve(plan, a, target, floats, r, d, store)``: d with M d = r, M = V/a + K (stencil_kernels),
until the 2-norm of the residual is at most ``target``; False where that is not reached. r is spent. ``plan`` has the
names below, then numbers of its own from PLAN on. ``store``: two arrays of scratch, what the solver keeps, RECORD
entries of what it did. Each stands in a file of its own and is called by its number, so that a run compiles the one
that it uses.
"""

from numba import types

from sceneql.compiled.kernels import lean_inlined
from sceneql.compiled.numbered_kernels import kernel_at
from sceneql.grids.multigrid import layout
from sceneql.system.signatures_kernels import A, F, I

SOLVE = types.boolean(I, F, F, A, A, A, A)
solver_at = kernel_at(SOLVE)


@lean_inlined
def matrix(plan, floats):
    """nx, ny, nz, volume, sink, gx, gy, gz."""
    nx, ny, nz = plan[layout.NX], plan[layout.NY], plan[layout.NZ]
    n = nx * ny * nz
    volume = floats[plan[layout.VOLUME] : plan[layout.VOLUME] + n]
    sink = floats[plan[layout.SINK] : plan[layout.SINK] + n]
    gx, gy = floats[plan[layout.GX] : plan[layout.GX] + n], floats[plan[layout.GY] : plan[layout.GY] + n]
    gz = floats[plan[layout.GZ] : plan[layout.GZ] + (n if nz > 1 else 0)]
    return nx, ny, nz, volume, sink, gx, gy, gz


@lean_inlined
def divided(plan, store):
    """Two arrays of scratch, the solver's own, its record."""
    n = plan[layout.NX] * plan[layout.NY] * plan[layout.NZ]
    end = store.size - layout.RECORD
    return store[:n], store[n : 2 * n], store[2 * n : end], store[end:]


@lean_inlined
def to_prepare(plan, a, record):
    """Whether the solver is not ready for this a."""
    return record[layout.FACTORED] != a or plan[layout.VARYING] == 1


@lean_inlined
def forget(record):
    """No residuals of a system yet."""
    for k in range(layout.HISTORY, record.size):
        record[k] = -1.0


@lean_inlined
def noted(record, count):
    """Note the iterations of a system; whether it was solved (they are not below 0)."""
    record[layout.SOLVES] += 1.0
    record[layout.ITERATIONS] += abs(count)
    return count >= 0
