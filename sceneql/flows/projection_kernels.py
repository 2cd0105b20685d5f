# mypy: ignore-errors
"""Projection of face velocities, or of their rates, onto those free of divergence (Chorin 1968), as a term.

The pressure's equation is solved by fast transforms on a box whose sides are each closed, open or periodic; elsewhere
by conjugate gradients with these as preconditioner.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows.fourier_kernels import transform
from sceneql.flows.layout import (
    AREAS,
    AT,
    AXES,
    CELLS,
    CONDUCTANCES,
    FACES,
    INVERSES,
    ITERATES,
    MOVES,
    PERIODIC,
    PLANS,
    PRESSURE,
    SCALES,
    SINGULAR,
    SINK,
    SKIP,
    SPECTRUM,
    STARTS,
    WORK,
)
from sceneql.grids.multigrid.stencil_kernels import dot, multiply
from sceneql.system.signatures_kernels import TERM, A, F, I

SMALL = 1e-11
"""Residual of iterations, in parts of the right side."""
MOST = 400
"""Iterations."""


@lean(types.void(A, A, I), inner=True)
def by_transform(x, floats, ints):
    """Solve the equation of the box, in place."""
    nx, ny, nz = ints[CELLS], ints[CELLS + 1], ints[CELLS + 2]
    n = nx * ny * nz
    scratch, plans = floats[ints[WORK] :], ints[PLANS:]
    transform(x, nx, ny, nz, True, floats, scratch, plans)
    spectrum = floats[ints[SPECTRUM] : ints[SPECTRUM] + n]
    for c in range(n):
        x[c] *= spectrum[c]
    transform(x, nx, ny, nz, False, floats, scratch, plans)


@lean_inlined
def centered(x, sink, ints):
    """0 in solids (sinks below 0); elsewhere less the mean where the pressure is known up to a constant."""
    total, count = 0.0, 1
    if ints[SINGULAR] == 1:
        count = 0
        for c in range(x.size):
            if sink[c] >= 0.0:
                total += x[c]
                count += 1
    for c in range(x.size):
        x[c] = x[c] - total / count if sink[c] >= 0.0 else 0.0


@lean(types.void(A, A, I), inner=True)
def by_iterations(b, floats, ints):
    """Solve the pressure's equation in place, by conjugate gradients from 0."""
    nx, ny, nz = ints[CELLS], ints[CELLS + 1], ints[CELLS + 2]
    n = nx * ny * nz
    room = floats[ints[WORK] - 5 * n : ints[WORK]]
    r, z, p, q, volume = room[:n], room[n : 2 * n], room[2 * n : 3 * n], room[3 * n : 4 * n], room[4 * n :]
    sink = floats[ints[SINK] : ints[SINK] + n]
    gx = floats[ints[CONDUCTANCES] : ints[CONDUCTANCES] + n]
    gy = floats[ints[CONDUCTANCES + 1] : ints[CONDUCTANCES + 1] + n]
    gz = floats[ints[CONDUCTANCES + 2] : ints[CONDUCTANCES + 2] + (n if nz > 1 else 0)]
    centered(b, sink, ints)
    for c in range(n):
        r[c], b[c], volume[c] = b[c], 0.0, 0.0
    whole = math.sqrt(dot(r, r))
    before = 0.0
    for count in range(MOST):
        if not math.sqrt(dot(r, r)) > SMALL * whole:
            break
        for c in range(n):
            z[c] = r[c]
        by_transform(z, floats, ints)
        centered(z, sink, ints)
        now = dot(r, z)
        part = now / before if count > 0 else 0.0
        for c in range(n):
            p[c] = z[c] + part * p[c]
        multiply(nx, ny, nz, 0.0, volume, sink, gx, gy, gz, p, q)
        step = now / dot(p, q)
        for c in range(n):
            b[c] += step * p[c]
            r[c] -= step * q[c]
        before = now


@lean_inlined
def face(cell, place, axis, ints):
    """The face on the low side of a cell (i, j, k), and the step to the one on its high side, of all faces."""
    i, j, k = place
    nx, ny = ints[CELLS], ints[CELLS + 1]
    sx = nx + (1 if axis == 0 and ints[PERIODIC] == 0 else 0)
    sy = ny + (1 if axis == 1 and ints[PERIODIC + 1] == 0 else 0)
    low = ints[STARTS + axis] + i + sx * (j + sy * k)
    stride = 1 if axis == 0 else (sx if axis == 1 else sx * sy)
    number = i if axis == 0 else (j if axis == 1 else k)
    count = ints[CELLS + axis]
    around = ints[PERIODIC + axis] == 1 and number == count - 1
    return low, low - (count - 1) * stride if around else low + stride


@lean(types.void(A, A, A, I))
def outflow(x, out, floats, ints):
    """Net outflow of each cell (cells,) of velocities x, at ints[AT] and on [m^3/s]."""
    nx, ny, nz, at, areas = ints[CELLS], ints[CELLS + 1], ints[CELLS + 2], ints[AT], ints[AREAS]
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                cell = i + nx * (j + ny * k)
                total = 0.0
                for axis in range(ints[AXES]):
                    low, high = face(cell, (i, j, k), axis, ints)
                    total += floats[areas + high] * x[at + high] - floats[areas + low] * x[at + low]
                out[cell] = total


@lean(types.void(A, A, F, A, I), inner=True)
def less_gradient(x, q, factor, floats, ints):
    """x minus factor times the gradient of q, which is 0 beyond open sides, at the faces whose velocity is free."""
    nx, ny, nz, at, scales = ints[CELLS], ints[CELLS + 1], ints[CELLS + 2], ints[AT], ints[SCALES]
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                cell = i + nx * (j + ny * k)
                for axis in range(ints[AXES]):
                    low, high = face(cell, (i, j, k), axis, ints)
                    x[at + low] -= factor * floats[scales + low] * q[cell]
                    x[at + high] += factor * floats[scales + high] * q[cell]


@lean(types.void(A, A, I))
def project(x, floats, ints):
    """Make x free of divergence; floats[ints[PRESSURE]:] is then what its gradient takes away."""
    n = ints[CELLS] * ints[CELLS + 1] * ints[CELLS + 2]
    q = floats[ints[PRESSURE] : ints[PRESSURE] + n]
    outflow(x, q, floats, ints)
    for c in range(n):
        q[c] = -q[c]
    if ints[ITERATES] == 1:
        by_iterations(q, floats, ints)
    else:
        by_transform(q, floats, ints)
    less_gradient(x, q, 1.0, floats, ints)


@lean(TERM, inner=True)
def constrain(t, y, rate, floats, ints):
    """The rate of velocities that are given is theirs; that of all others loses its divergence."""
    at = ints[AT]
    for k in range(ints[FACES]):
        if floats[ints[INVERSES] + k] == 0.0:
            rate[at + k] = floats[ints[MOVES] + k]
    if floats[ints[SKIP]] == 0.0:
        project(rate, floats, ints)
