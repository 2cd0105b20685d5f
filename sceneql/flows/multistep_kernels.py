# mypy: ignore-errors
"""A step that is explicit in advection and implicit in viscosity and diffusion, then projected.

lead u1 = a1 u0 + a2 u_before + h (b1 N0 + b2 N_before) + h L (implicit u* + explicit u0) - h grad p, where L is the sum
over faces of g (neighbor - u) of every field whose g do not vary, and N all other rates, unprojected. u1 is u* without
its divergence; the pressure grows by what that takes away, less viscosity times the divergence (Brown, Cortez & Minion
2001, J. Comput. Phys. 168, 464-499; Guermond & Shen 2004, Math. Comp. 73, 1719-1737), or is left out (Chorin 1968).

``settings``: start and end of the latest step, length of the one before it. ``numbers``: [scheme, 1 if there is a step
before, number of operators, where the flow's integers begin], then of each operator OPERATOR integers (a field's offset
in y, cells along x, y, z, volumes, 0 where nothing is solved, sinks, conductances along x, y, z; offsets into the
tables, which follow the settings, of decay rates by mode along x, y, z and of the length of all transforms; the entry
of y that tells what has come in, or -1; the plans of the transforms, flows/layout).
"""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.flows.fourier_kernels import transform
from sceneql.flows.layout import CELLS, PLAN, PRESSURE, SKIP, WORK
from sceneql.flows.projection_kernels import less_gradient, outflow, project
from sceneql.grids.multigrid.stencil_kernels import dot, flow, multiply
from sceneql.system.signatures_kernels import STEP, A, F, I

CHORIN, CNAB2, SBDF2 = range(3)
SCHEME, HAS_BEFORE, OPERATORS, FLOW_AT, HEAD = range(5)
START, END, LENGTH, VISCOSITY, TABLES = range(5)
DECAYS, SIZES_AT, TALLY, PLANS_AT = 9, 12, 13, 14
OPERATOR = PLANS_AT + 3 * PLAN
ARRAYS = 12
SMALL = 1e-12
"""Residual of implicit parts, in parts of the right side."""
MOST = 200


@lean_inlined
def same(x, y):
    """Whether all entries are equal."""
    for k in range(x.size):
        if x[k] != y[k]:
            return False
    return True


@lean(types.void(A, A, A, I), inner=True)
def spread(y, out, floats, numbers):
    """out = L y; 0 where no operator acts."""
    for k in range(out.size):
        out[k] = 0.0
    for number in range(numbers[OPERATORS]):
        op = numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)]
        at, nx, ny, nz = op[0], op[1], op[2], op[3]
        n, plane, deep = nx * ny * nz, nx * ny, nz > 1
        x, volume, sink = y[at : at + n], floats[op[4] : op[4] + n], floats[op[5] : op[5] + n]
        gx, gy, gz = floats[op[6] : op[6] + n], floats[op[7] : op[7] + n], floats[op[8] : op[8] + (n if deep else 0)]
        for k in range(nz):
            down, up = ((k - 1) % nz - k) * plane, ((k + 1) % nz - k) * plane
            for j in range(ny):
                row = nx * j + plane * k
                last = row + nx - 1
                low, high = ((j - 1) % ny - j) * nx, ((j + 1) % ny - j) * nx
                for c in range(row, last + 1):
                    if volume[c] > 0.0:
                        left, right = (last if c == row else c - 1), (row if c == last else c + 1)
                        total = flow(x, gx, gy, gz, c, left, right, c + low, c + high, c + down, c + up, deep)
                        out[at + c] = (total - sink[c] * x[c]) / volume[c]


@lean(types.void(A, A, A, F, A, A, I), inner=True)
def precondition(r, z, volume, a, tables, scratch, op):
    """z = (1 - a coefficient lap)^-1 (r / V) on the uncut box; 0 where V is 0."""
    nx, ny, nz = op[1], op[2], op[3]
    for c in range(z.size):
        z[c] = r[c] / volume[c] if volume[c] > 0.0 else 0.0
    plans = op[PLANS_AT:]
    transform(z, nx, ny, nz, True, tables, scratch, plans)
    for k in range(nz):
        deep = tables[op[DECAYS + 2] + k] if nz > 1 else 0.0
        for j in range(ny):
            both = deep + tables[op[DECAYS + 1] + j]
            for i in range(nx):
                z[i + nx * (j + ny * k)] /= tables[op[SIZES_AT]] * (1.0 + a * (both + tables[op[DECAYS] + i]))
    transform(z, nx, ny, nz, False, tables, scratch, plans)
    for c in range(z.size):
        z[c] = z[c] if volume[c] > 0.0 else 0.0


@lean(types.void(I, F, A, A, F, A, A, A, A), inner=True)
def solve(op, a, wanted, y, small, floats, tables, scratch, room):
    """Solve (V - a L) x = V wanted for the entries of an operator, in y, from the values there, by conjugate gradients
    with transforms of the box as preconditioner; where V is 0 they stay. ``small``: the residual in parts of wanted."""
    at, nx, ny, nz = op[0], op[1], op[2], op[3]
    n = nx * ny * nz
    x, volume, sink = y[at : at + n], floats[op[4] : op[4] + n], floats[op[5] : op[5] + n]
    gx, gy = floats[op[6] : op[6] + n], floats[op[7] : op[7] + n]
    gz = floats[op[8] : op[8] + (n if nz > 1 else 0)]
    r, p, q, z = room[:n], room[n : 2 * n], room[2 * n : 3 * n], room[3 * n : 4 * n]
    scale = 1.0 / a
    multiply(nx, ny, nz, scale, volume, sink, gx, gy, gz, x, q)
    target = 0.0
    for c in range(n):
        if volume[c] > 0.0:
            r[c] = volume[c] * wanted[at + c] - a * q[c]
            target += volume[c] * wanted[at + c] ** 2
        else:
            r[c] = 0.0
    before = 0.0
    for count in range(MOST):
        left = 0.0
        for c in range(n):
            left += r[c] * r[c] / volume[c] if volume[c] > 0.0 else 0.0
        if not left > small * small * target:
            break
        precondition(r, z, volume, a, tables, scratch, op)
        now = dot(r, z)
        part = now / before if count > 0 else 0.0
        for c in range(n):
            p[c] = z[c] + part * p[c]
        length = now / (a * multiply(nx, ny, nz, scale, volume, sink, gx, gy, gz, p, q))
        for c in range(n):
            x[c] += length * p[c]
            r[c] = r[c] - length * a * q[c] if volume[c] > 0.0 else 0.0
        before = now


@lean(types.void(I, A, A, A), inner=True)
def tally(op, y0, y1, floats):
    """What has come into a field in a step: what there is more of it, for fluxes between cells cancel."""
    if op[TALLY] >= 0:
        total = 0.0
        for c in range(op[1] * op[2] * op[3]):
            total += floats[op[4] + c] * (y1[op[0] + c] - y0[op[0] + c])
        y1[op[TALLY]] = y0[op[TALLY]] + total


@lean_inlined
def remember(t, y0, latest, n_before, start, before, end, settings, numbers):
    """Whether this step goes on from the latest, whose start and rates are then those before, or repeats it."""
    if t == settings[END] and same(y0, end):
        for k in range(y0.size):
            before[k], n_before[k] = start[k], latest[k]
        settings[LENGTH] = settings[END] - settings[START]
        numbers[HAS_BEFORE] = 1
    elif not (t == settings[START] and same(y0, start)):
        numbers[HAS_BEFORE] = 0
    for k in range(y0.size):
        start[k] = y0[k]


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h; returns 0."""
    n = y0.size
    rate1, latest, n_before = work[:n], work[n : 2 * n], work[2 * n : 3 * n]
    start, before, end = work[3 * n : 4 * n], work[4 * n : 5 * n], work[5 * n : 6 * n]
    wanted, spreading, room, pressure = work[6 * n : 7 * n], work[7 * n : 8 * n], work[8 * n :], work[12 * n :]
    one = numbers[numbers[FLOW_AT] :]
    cells = one[CELLS] * one[CELLS + 1] * one[CELLS + 2]
    q = floats[one[PRESSURE] : one[PRESSURE] + cells]
    scheme = numbers[SCHEME]
    rate = rate_at(functions[AT_RATE])
    remember(t, y0, latest, n_before, start, before, end, settings, numbers)
    has_before = numbers[HAS_BEFORE] == 1
    if not has_before and t != settings[START]:  # the pressure of the start, or after a change from outside
        rate(t, y0, latest, floats, ints)
        for c in range(cells):
            pressure[c] = q[c]
    elif t == settings[START]:
        for c in range(cells):
            pressure[c] = pressure[cells + c]
    settings[START], settings[END] = t, t + h
    for c in range(cells):
        pressure[cells + c] = pressure[c]
    floats[one[SKIP]] = 1.0
    rate(t, y0, latest, floats, ints)
    floats[one[SKIP]] = 0.0
    spread(y0, spreading, floats, numbers)
    w = h / settings[LENGTH] if has_before else 0.0
    lead, a1, a2, b1, b2, implicit = 1.0, 1.0, 0.0, 1.0, 0.0, 1.0
    if scheme == CNAB2:
        b1, b2, implicit = 1.0 + 0.5 * w, -0.5 * w, 0.5
    elif scheme == SBDF2:
        lead, a1, a2 = (1.0 + 2.0 * w) / (1.0 + w), 1.0 + w, -w * w / (1.0 + w)
        b1, b2 = 1.0 + w, -w
    for k in range(n):
        latest[k] -= spreading[k]
        other, old = (n_before[k], before[k]) if has_before else (latest[k], y0[k])
        change = b1 * latest[k] + b2 * other + (1.0 - implicit) * spreading[k]
        wanted[k] = (a1 * y0[k] + a2 * old + h * change) / lead
    if scheme != CHORIN:
        less_gradient(wanted, pressure, h / lead, floats, one)
    for k in range(n):
        y1[k] = wanted[k]
    for number in range(numbers[OPERATORS]):
        op = numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)]
        size = op[1] * op[2] * op[3]
        for c in range(size):
            if floats[op[4] + c] > 0.0:
                k = op[0] + c
                y1[k] = y0[k] + (w * (y0[k] - before[k]) if has_before else 0.0)
        solve(op, h * implicit / lead, wanted, y1, SMALL, floats, settings[TABLES:], floats[one[WORK] :], room)
    if scheme != CHORIN:
        gathered = room[:cells]
        outflow(y1, gathered, floats, one)
    project(y1, floats, one)
    if scheme != CHORIN:
        for c in range(cells):
            pressure[c] += q[c] * lead / h - implicit * settings[VISCOSITY] * gathered[c]
    for number in range(numbers[OPERATORS]):
        tally(numbers[HEAD + OPERATOR * number : HEAD + OPERATOR * (number + 1)], y0, y1, floats)
    for k in range(n):
        slope = (y1[k] - y0[k]) / h
        if has_before:
            slope += w / (1.0 + w) * (slope - (y0[k] - before[k]) / settings[LENGTH])
        rate1[k] = slope
        end[k] = y1[k]
    return 0.0
