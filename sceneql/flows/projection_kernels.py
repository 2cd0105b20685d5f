# mypy: ignore-errors
"""Projection of face velocities, or of their rates, onto those free of divergence (Chorin 1968), as a term.

The pressure's equation is solved by fast transforms on a box whose sides are each closed, open or periodic; elsewhere
by conjugate gradients with these as preconditioner.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows.box_modes_kernels import along, through_modes, through_modes_of_rows
from sceneql.flows.layout import (
    AREAS,
    AT,
    AXES,
    CELLS,
    CONDUCTANCES,
    CUT,
    FACES,
    GIVEN,
    INVERSES,
    ITERATES,
    LED,
    MOVES,
    PERIODIC,
    PLAIN,
    PLAN,
    PLANS,
    PRESSURE,
    RATE,
    SCALES,
    SEEPING,
    SINGULAR,
    SINK,
    SKIP,
    SOLVER_AT,
    SPECTRUM,
    STARTS,
    STORE,
    STORE_SIZE,
    VELOCITY,
    WORK,
)
from sceneql.flows.lines_kernels import through_lines
from sceneql.flows.near_solids_kernels import by_few, by_lines, near_solids
from sceneql.grids.multigrid.layout import SOLVER
from sceneql.grids.multigrid.linear_kernels import solver_at
from sceneql.grids.multigrid.stencil_kernels import dot, multiply
from sceneql.system.signatures_kernels import TERM, A, F, I, N

SMALL = 2e-12
"""Residual of iterations, in parts of what flows through faces."""
MOST = 400
"""Iterations."""
LISTED = 2
"""What the number of cells near solids is kept more by, so that 0 is none that is known."""


@lean(types.void(A, A, I), inner=True)
def by_transform(x, floats, ints):
    """Solve the equation of the box, in place."""
    nx, ny, nz = ints[CELLS], ints[CELLS + 1], ints[CELLS + 2]
    spectrum, none, scratch = floats[ints[SPECTRUM] :], floats[:0], floats[ints[WORK] :]
    if by_lines(ints):
        through_lines(x, nx, ny, floats, scratch, ints[PLANS:], spectrum, (0, ny), False, False)
    else:
        through_modes(x, nx, ny, nz, floats, scratch, ints[PLANS:], spectrum, none, none, none, 0.0, 0.0)


@lean_inlined
def rows_of_box(x, first, count, forward, floats, ints):
    """Transform rows of cells along x, forward or back, which is the beginning and the end of `by_transform`."""
    nx = ints[CELLS]
    along(x[first * nx :], nx, 1, count, nx, 1, 0, forward, floats, floats[ints[WORK] :], ints[PLANS : PLANS + PLAN])


@lean(types.void(A, A, I), inner=True)
def by_transform_of_rows(x, floats, ints):
    """What stands between, of deep boxes; of flat ones bands have done it."""
    if by_lines(ints):
        return
    nx, ny, nz = ints[CELLS], ints[CELLS + 1], ints[CELLS + 2]
    spectrum, none = floats[ints[SPECTRUM] : ints[SPECTRUM] + nx * ny * nz], floats[:0]
    scratch, plans = floats[ints[WORK] :], ints[PLANS:]
    through_modes_of_rows(x, nx, ny, nz, floats, scratch, plans, spectrum, none, none, none, 0.0, 0.0)


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


@lean_inlined
def pushed_at(what, ints):
    """Offset of what walls push through cells of velocities or of their rates; -1: nothing."""
    if what == VELOCITY:
        return ints[SEEPING]
    return ints[SEEPING] + ints[CELLS] * ints[CELLS + 1] * ints[CELLS + 2] if what == RATE and ints[LED] > 0 else -1


@lean_inlined
def through_faces(x, what, floats, ints):
    """The root of the sum of squares of what flows through all faces, and through cells from walls [m^3/s]."""
    faces = ints[FACES]
    u, areas = x[ints[AT] : ints[AT] + faces], floats[ints[AREAS] : ints[AREAS] + faces]
    total = 0.0
    for k in range(faces):
        total += (areas[k] * u[k]) ** 2
    pushed = pushed_at(what, ints)
    if pushed >= 0:
        for c in range(ints[CELLS] * ints[CELLS + 1] * ints[CELLS + 2]):
            total += floats[pushed + c] ** 2
    return math.sqrt(total)


@lean(types.boolean(A, F, A, I), inner=True)
def by_iterations(b, small, floats, ints):
    """Solve the pressure's equation in place, by conjugate gradients from 0, to a residual; whether it was reached.

    The transform alone as preconditioner would take the more iterations the less is left of a cell: so a step of
    Jacobi's method in cut cells goes before it and comes after it. Where few cells are near solids these alone are
    iterated on.
    """
    nx, ny, nz = ints[CELLS], ints[CELLS + 1], ints[CELLS + 2]
    n = nx * ny * nz
    room = floats[ints[WORK] - 5 * n : ints[WORK]]
    most, sink = n // 3, floats[ints[SINK] : ints[SINK] + n]
    few, known = -1, floats[ints[WORK] - 5 * n - 1 : ints[WORK] - 5 * n]
    if ints[LED] == 0 and known[0] > 0.0:  # solids that stand still are listed once
        few = int(known[0]) - LISTED
    else:
        few = near_solids(room[4 * n :], room, room[most:], most, floats, ints)
        known[0] = few + LISTED
    if few >= 0:
        centered(b, sink, ints)
        solved = by_few(b, small, few, room, floats, ints)
        centered(b, sink, ints)
        return solved
    r, z, p, q, volume = room[:n], room[n : 2 * n], room[2 * n : 3 * n], room[3 * n : 4 * n], room[4 * n :]
    cut = floats[ints[CUT] : ints[CUT] + n]
    gx = floats[ints[CONDUCTANCES] : ints[CONDUCTANCES] + n]
    gy = floats[ints[CONDUCTANCES + 1] : ints[CONDUCTANCES + 1] + n]
    gz = floats[ints[CONDUCTANCES + 2] : ints[CONDUCTANCES + 2] + (n if nz > 1 else 0)]
    centered(b, sink, ints)
    for c in range(n):
        r[c], b[c], volume[c] = b[c], 0.0, 0.0
    before = 0.0
    for count in range(MOST):
        left = math.sqrt(dot(r, r))
        if not left > small:
            return left <= small
        for c in range(n):
            z[c] = cut[c] * r[c]
        multiply(nx, ny, nz, 0.0, volume, sink, gx, gy, gz, z, q)
        for c in range(n):
            z[c] = r[c] - q[c]
        by_transform(z, floats, ints)
        for c in range(n):
            z[c] = z[c] + cut[c] * r[c] if sink[c] >= 0.0 else 0.0
        multiply(nx, ny, nz, 0.0, volume, sink, gx, gy, gz, z, q)
        for c in range(n):
            z[c] += cut[c] * (r[c] - q[c])
        centered(z, sink, ints)
        now = dot(r, z)
        part = now / before if count > 0 else 0.0
        for c in range(n):
            p[c] = z[c] + part * p[c]
        length = now / multiply(nx, ny, nz, 0.0, volume, sink, gx, gy, gz, p, q)
        for c in range(n):
            b[c] += length * p[c]
            r[c] -= length * q[c]
        before = now
    return math.sqrt(dot(r, r)) <= small


@lean_inlined
def by_name(b, small, floats, ints):
    """Solve the pressure's equation in place by the linear solver that the script names; whether it was reached."""
    n, at = b.size, ints[STORE]
    plan, found = ints[ints[SOLVER_AT] :], floats[at : at + n]
    centered(b, floats[ints[SINK] : ints[SINK] + n], ints)
    store = floats[at + n : at + n + ints[STORE_SIZE]]
    solved = solver_at(plan[SOLVER])(plan, 1.0, small, floats, b, found, store)
    for c in range(n):
        b[c] = found[c]
    return solved


@lean_inlined
def first_face(axis, j, k, ints):
    """The face across an axis on the low side of the first cell of row (j, k), and how far on that on the high side of
    the row is (along x: of its first cell), of all faces."""
    nx = ints[CELLS] + (1 if axis == 0 and ints[PERIODIC] == 0 else 0)
    ny = ints[CELLS + 1] + (1 if axis == 1 and ints[PERIODIC + 1] == 0 else 0)
    stride = 1 if axis == 0 else (nx if axis == 1 else nx * ny)
    place = j if axis == 1 else k
    around = axis > 0 and ints[PERIODIC + axis] == 1 and place == ints[CELLS + axis] - 1
    return ints[STARTS + axis] + nx * (j + ny * k), -place * stride if around else stride


@lean_inlined
def net(v, w, a, b, own, plain, more, count):
    """Flow out on the high side of a row's cells less that in on the low side: to what there is, or alone."""
    if plain:
        area = a[0]
        for i in range(count):
            own[i] = (own[i] if more else 0.0) + (area * w[i] - area * v[i])
    else:
        for i in range(count):
            own[i] = (own[i] if more else 0.0) + (b[i] * w[i] - a[i] * v[i])


@lean_inlined
def outflow_row(u, areas, own, j, k, ints):
    """What velocities u take out of each cell of row (j, k)."""
    nx, around, plain = ints[CELLS], ints[PERIODIC] == 1, ints[PLAIN] == 1
    low, _ = first_face(0, j, k, ints)
    v, w, a, b = u[low:], u[low + 1 :], areas[low:], areas[low + 1 :]
    net(v, w, areas if plain else a, b, own, plain, False, nx - 1 if around else nx)
    if around:
        own[nx - 1] = a[0] * v[0] - a[nx - 1] * v[nx - 1]
    for axis in range(1, ints[AXES]):
        low, up = first_face(axis, j, k, ints)
        a, b = (areas[ints[STARTS + axis] :] if plain else areas[low:]), areas[low + up :]
        net(u[low:], u[low + up :], a, b, own, plain, True, nx)


@lean(types.void(A, A, N, A, I))
def outflow(x, out, what, floats, ints):
    """Net outflow of each cell (cells,) of velocities x, at ints[AT] and on [m^3/s], less what walls that move push
    through it; of rates where solids move, and else, as they turn steadily in their places, of velocities alone.

    ``what``: one of VELOCITY, RATE and CHANGE.
    """
    nx, ny, nz, faces = ints[CELLS], ints[CELLS + 1], ints[CELLS + 2], ints[FACES]
    u, areas = x[ints[AT] : ints[AT] + faces], floats[ints[AREAS] : ints[AREAS] + faces]
    for k in range(nz):
        for j in range(ny):
            outflow_row(u, areas, out[nx * (j + ny * k) :], j, k, ints)
    pushed = pushed_at(what, ints)
    if pushed >= 0:
        for c in range(nx * ny * nz):
            out[c] -= floats[pushed + c]


@lean_inlined
def lessen(u, scales, factor, here, before, has_here, has_before, plain, count):
    """A row of velocities, less the gradient between two rows of pressures, one of which may be missing: 0.

    ``plain``: all scales of the row are the same.
    """
    if plain:
        scale = factor * scales[0]
        for i in range(count):
            u[i] -= scale * (here[i] - before[i])
    elif has_here and has_before:
        for i in range(count):
            u[i] -= factor * scales[i] * (here[i] - before[i])
    else:
        one, sign = (here, factor) if has_here else (before, -factor)
        for i in range(count):
            u[i] -= sign * scales[i] * one[i]


@lean_inlined
def lessen_row(u, scales, q, factor, j, k, ints):
    """`less_gradient` at the faces on the low sides of the cells of row (j, k), and at the high ends of the box."""
    nx, ny, plain = ints[CELLS], ints[CELLS + 1], ints[PLAIN] == 1
    around, row = ints[PERIODIC] == 1, nx * (j + ny * k)
    low, _ = first_face(0, j, k, ints)
    lessen(u[low + 1 :], scales[low + 1 :], factor, q[row + 1 :], q[row:], True, True, plain, nx - 1)
    lessen(u[low:], scales[low:], factor, q[row:], q[row + nx - 1 :], True, around, False, 1)
    if not around:
        lessen(u[low + nx :], scales[low + nx :], factor, q, q[row + nx - 1 :], False, True, False, 1)
    for axis in range(1, ints[AXES]):
        low, up = first_face(axis, j, k, ints)
        place, count = (j if axis == 1 else k), ints[CELLS + axis]
        stride, periodic = (nx if axis == 1 else nx * ny), ints[PERIODIC + axis] == 1
        before = q[row + (count - 1) * stride :] if place == 0 else q[row - stride :]
        if place == 0 and not periodic:
            before = q[row:]
        inner = place > 0 or periodic
        lessen(u[low:], scales[low:], factor, q[row:], before, True, inner, plain and inner, nx)
        if place == count - 1 and not periodic:
            lessen(u[low + up :], scales[low + up :], factor, q, q[row:], False, True, False, nx)


@lean(types.void(A, A, F, A, I), inner=True)
def less_gradient(x, q, factor, floats, ints):
    """x minus factor times the gradient of q, which is 0 beyond open sides, at the faces whose velocity is free."""
    faces = ints[FACES]
    u, scales = x[ints[AT] : ints[AT] + faces], floats[ints[SCALES] : ints[SCALES] + faces]
    for k in range(ints[CELLS + 2]):
        for j in range(ints[CELLS + 1]):
            lessen_row(u, scales, q, factor, j, k, ints)


@lean(types.boolean(A, N, A, I), inner=True)
def rid(x, what, floats, ints):
    """`project`, where floats[ints[PRESSURE]:] are the inflows of cells."""
    n = ints[CELLS] * ints[CELLS + 1] * ints[CELLS + 2]
    q = floats[ints[PRESSURE] : ints[PRESSURE] + n]
    solved = True
    small = SMALL * through_faces(x, what, floats, ints) if ints[ITERATES] > 0 else 0.0
    if ints[ITERATES] == 1:
        solved = by_iterations(q, small, floats, ints)
    elif ints[ITERATES] == 2:
        solved = by_name(q, small, floats, ints)
    else:
        by_transform(q, floats, ints)
    less_gradient(x, q, 1.0, floats, ints)
    return solved


@lean(types.boolean(A, N, A, I))
def project(x, what, floats, ints):
    """Make x free of divergence; floats[ints[PRESSURE]:] is then what its gradient takes away. Whether it is.

    ``what``: VELOCITY, RATE or CHANGE (outflow).
    """
    n = ints[CELLS] * ints[CELLS + 1] * ints[CELLS + 2]
    q = floats[ints[PRESSURE] : ints[PRESSURE] + n]
    outflow(x, q, what, floats, ints)
    for c in range(n):
        q[c] = -q[c]
    return rid(x, what, floats, ints)


@lean(TERM, inner=True)
def constrain(t, y, rate, floats, ints):
    """The rate of velocities that are given is theirs; that of all others loses its divergence."""
    at = ints[AT]
    if ints[GIVEN] == 1:
        for k in range(ints[FACES]):
            if floats[ints[INVERSES] + k] == 0.0:
                rate[at + k] = floats[ints[MOVES] + k]
    if floats[ints[SKIP]] == 0.0 and not project(rate, RATE, floats, ints):
        rate[at] = math.nan
