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
from sceneql.system.signatures_kernels import A, F, I

SOLVER, EXACT, NX, NY, NZ, AT, VOLUME, SINK, GX, GY, GZ, VARYING, MOST, FED, PLAN = range(15)
"""EXACT: 1 where a system is solved to rounding at once."""

FACTORED, TAKEN_IN, SOLVES, ITERATIONS, HISTORY, RECORD = 0, 1, 2, 3, 4, 132
"""Of the store's last entries: the a that is prepared (0: none), whether what does not depend on it is, systems solved,
iterations of all of them, then the residuals of the last one."""

SOLVE = types.boolean(I, F, F, A, A, A, A)
solver_at = kernel_at(SOLVE)


@lean_inlined
def matrix(plan, floats):
    """nx, ny, nz, volume, sink, gx, gy, gz."""
    nx, ny, nz = plan[NX], plan[NY], plan[NZ]
    n = nx * ny * nz
    volume, sink = floats[plan[VOLUME] : plan[VOLUME] + n], floats[plan[SINK] : plan[SINK] + n]
    gx, gy = floats[plan[GX] : plan[GX] + n], floats[plan[GY] : plan[GY] + n]
    gz = floats[plan[GZ] : plan[GZ] + (n if nz > 1 else 0)]
    return nx, ny, nz, volume, sink, gx, gy, gz


@lean_inlined
def divided(plan, store):
    """Two arrays of scratch, the solver's own, its record."""
    n = plan[NX] * plan[NY] * plan[NZ]
    end = store.size - RECORD
    return store[:n], store[n : 2 * n], store[2 * n : end], store[end:]


@lean_inlined
def to_prepare(plan, a, record):
    """Whether the solver is not ready for this a."""
    return record[FACTORED] != a or plan[VARYING] == 1


@lean_inlined
def forget(record):
    """No residuals of a system yet."""
    for k in range(HISTORY, record.size):
        record[k] = -1.0


@lean_inlined
def noted(record, count):
    """Note the iterations of a system; whether it was solved (they are not below 0)."""
    record[SOLVES] += 1.0
    record[ITERATIONS] += abs(count)
    return count >= 0
