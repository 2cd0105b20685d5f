# mypy: ignore-errors
"""Advection and viscosity of face velocities, as terms: what crosses the faces of each velocity's own cell.

Momentum is conserved; values at faces of these cells are central (energy is conserved too: Harlow & Welch 1965;
Morinishi et al. 1998), upwind, or upwind with half a limited slope (Koren 1993). Where fluid comes in through an open
side, it brings half the momentum of what is there: so the pressure given is that of fluid at rest outside (Bernoulli),
and what comes back in brings no energy and cannot grow (Bruneau & Fabrie 1994).
"""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.lanes_kernels import below, load, store
from sceneql.flows.layout import (
    AREAS,
    AT,
    AXES,
    CELLS,
    CENTRAL,
    EDGE_FACES,
    EDGE_FIRST,
    EDGE_VALUES,
    EDGE_WEIGHTS,
    EDGES,
    FACES,
    FRICTION,
    INVERSES,
    LANES,
    PERIODIC,
    PLAIN,
    PUSHED,
    PUSHES,
    SCHEME,
    SKIP,
    STARTS,
    UPWIND,
    VISCOUS,
    WORK,
)
from sceneql.grids.drift_kernels import koren, koren_of_lanes
from sceneql.grids.multigrid.stencil_kernels import multiply
from sceneql.system.signatures_kernels import TERM, A, I


@lean_inlined
def sides(component, ints):
    """Faces of a component along x, y, z."""
    nx = ints[CELLS] + (1 if component == 0 and ints[PERIODIC] == 0 else 0)
    ny = ints[CELLS + 1] + (1 if component == 1 and ints[PERIODIC + 1] == 0 else 0)
    nz = ints[CELLS + 2] + (1 if component == 2 and ints[PERIODIC + 2] == 0 else 0)
    return nx, ny, nz


@lean_inlined
def mean(first, second, area, out, has_first, has_second, count):
    """Area times half the sum of two rows, of which one may be missing."""
    a, b = (0.5 * area if has_first else 0.0), (0.5 * area if has_second else 0.0)
    for i in range(count):
        out[i] = a * first[i] + b * second[i]


@lean_inlined
def passing(through, area, component, axis, place, j, k, out, ints):
    """What flows along an axis between the own cells of a row of a component's faces and those before them, ``place``
    being their number along it: the mean of the flows through the faces of both cells; of one, on the boundary.

    ``through``: by face, which times ``area`` is [m^3/s]. Along x of all places (the first two arguments of place are
    not read), else of one.
    """
    nx, ny, _ = sides(axis, ints)
    own_nx, own_ny, _ = sides(component, ints)
    start = ints[STARTS + axis]
    if component == axis:
        stride = own_nx if axis == 1 else own_nx * own_ny
        count = ints[CELLS + axis]
        row = start + own_nx * ((0 if axis == 1 else j) + own_ny * (0 if axis == 2 else k))
        before = place - 1 if place > 0 else count - 1
        mean(through[row + before * stride :], through[row + place * stride :], area, out, True, True, own_nx)
        return
    if axis == 1:
        row = start + nx * (place + ny * k)
    elif axis == 2:
        row = start + nx * (j + ny * place)
    else:
        row = start + nx * (j + ny * k)
    if component == 0:
        last, half = ints[CELLS], 0.5 * area
        for i in range(1, last):
            out[i] = half * through[row + i] + half * through[row + i - 1]
        if ints[PERIODIC] == 1:
            out[0] = half * through[row] + half * through[row + last - 1]
        else:
            out[0], out[last] = half * through[row], half * through[row + last - 1]
        return
    here, count = (j if component == 1 else k), ints[CELLS + component]
    stride = nx if component == 1 else nx * ny
    around = here == 0 and ints[PERIODIC + component] == 1
    behind = row + (count - 1) * stride if around else row - stride
    has_behind, has_here = here > 0 or around, here < count
    first = through[behind:] if has_behind else through[row:]
    second = through[row:] if has_here else first
    mean(first, second, area, out, has_behind, has_here, own_nx if axis != 0 else nx)


@lean_inlined
def carried(scheme, flows, a, b, c, d, out, count):
    """What flows carry between values b and c: ``a`` stands before b, ``d`` behind c."""
    if scheme == CENTRAL:
        for i in range(count):
            out[i] = flows[i] * (0.5 * (b[i] + c[i]))
    elif scheme == UPWIND:
        for i in range(count):
            out[i] = flows[i] * (b[i] if flows[i] > 0.0 else c[i])
    else:
        whole = count - count % LANES
        for i in range(0, whole, LANES):
            flow, first, second = load(flows, i), load(b, i), load(c, i)
            across, before, behind = second - first, first - load(a, i), second - load(d, i)
            slope = koren_of_lanes(below(0.0, flow, before, behind), below(0.0, flow, across, -1.0 * across))
            store(out, i, flow * (below(0.0, flow, first, second) + slope))
        for i in range(whole, count):
            forth = flows[i] > 0.0
            behind, ahead = (b[i] - a[i] if forth else c[i] - d[i]), (c[i] - b[i] if forth else b[i] - c[i])
            out[i] = flows[i] * ((b[i] if forth else c[i]) + koren(behind, ahead))


@lean_inlined
def beyond(value, weight, own):
    """The value beyond the boundary that has the given one on it; the same as within where none is given."""
    return 2.0 * value - own if weight != 0.0 else own


@lean_inlined
def leaving(out):
    """What flows out of an open side; of what comes in half, as it brings half the momentum."""
    return out if out > 0.0 else 0.5 * out


@lean_inlined
def along_row(u, through, area, component, j, k, room, floats, ints):
    """Momentum that crosses the ends of the own cells of a row along x: flux[i] and flux[i + 1] those of face i."""
    nx, ny, _ = sides(component, ints)
    row = ints[STARTS + component] + nx * (j + ny * k)
    room_of = nx + 8
    flux, flows, padded = room[:room_of], room[room_of : 2 * room_of], room[2 * room_of : 3 * room_of]
    for i in range(nx):
        padded[i + 2] = u[row + i]
    low, high, edges = ints[EDGE_FIRST + 6 * component], ints[EDGE_FIRST + 6 * component + 1], j + ny * k
    values, weights = floats[ints[EDGE_VALUES] :], floats[ints[EDGE_WEIGHTS] :]
    if component == 0:
        mean(through[row:], through[row + 1 :], area, flows[1:], True, True, nx - 1)
        flows[0] = 0.5 * area * through[row] + 0.5 * area * through[row + nx - 1]
    else:
        passing(through, area, component, 0, 0, j, k, flows, ints)
    if ints[PERIODIC] == 1:
        padded[0], padded[1], padded[nx + 2] = u[row + nx - 2], u[row + nx - 1], u[row]
        padded[nx + 3] = u[row + 1]
        carried(ints[SCHEME], flows, padded, padded[1:], padded[2:], padded[3:], flux, nx)
        flux[nx] = flux[0]
        return
    padded[1], padded[nx + 2] = u[row], u[row + nx - 1]
    if low >= 0:
        padded[1] = beyond(values[low + edges], weights[low + edges], u[row])
        padded[nx + 2] = beyond(values[high + edges], weights[high + edges], u[row + nx - 1])
    carried(ints[SCHEME], flows[1:], padded[1:], padded[2:], padded[3:], padded[4:], flux[1:], nx - 1)
    if component == 0:
        out, last = area * through[row], area * through[row + nx - 1]
        flux[0], flux[nx] = leaving(-out) * -u[row], leaving(last) * u[row + nx - 1]
    else:
        flux[0] = flows[0] * (values[low + edges] if flows[0] > 0.0 else u[row])
        flux[nx] = flows[nx] * (values[high + edges] if flows[nx] < 0.0 else u[row + nx - 1])


@lean_inlined
def across_row(u, through, area, component, axis, place, j, k, flux, room, floats, ints):
    """Momentum that crosses the low sides along y or z of the own cells of a row, whose number along it is ``place``:
    from 0 to the number of faces, which stands for the high sides of the last."""
    nx, ny, nz = sides(component, ints)
    count, stride, periodic = (ny if axis == 1 else nz), (nx if axis == 1 else nx * ny), ints[PERIODIC + axis] == 1
    base = ints[STARTS + component] + (nx * ny * k if axis == 1 else nx * j)
    flows, ghost = room[: nx + 8], room[nx + 8 :]
    high = place == count
    if not periodic and (place == 0 or high):
        row = base + (count - 1 if high else 0) * stride
        if component == axis:
            for i in range(nx):
                out = area * through[row + i]
                flux[i] = (leaving(out) if high else -leaving(-out)) * u[row + i]
            return
        first = ints[EDGE_FIRST + 6 * component + 2 * axis + high] + nx * (k if axis == 1 else j)
        given = floats[ints[EDGE_VALUES] + first :]
        passing(through, area, component, axis, place, j, k, flows, ints)
        for i in range(nx):
            inward = flows[i] < 0.0 if high else flows[i] > 0.0
            flux[i] = flows[i] * (given[i] if inward else u[row + i])
        return
    if high:
        place = 0
    passing(through, area, component, axis, place, j, k, flows, ints)
    before = place - 1 if place > 0 else count - 1
    c, b = u[base + place * stride :], u[base + before * stride :]
    a, d = b, c
    for way in range(2):
        away = before - 1 if way == 0 else place + 1
        outside = away < 0 or away >= count
        if outside and periodic:
            away = count - 1 if away < 0 else 0
        if not outside or periodic:
            if way == 0:
                a = u[base + away * stride :]
            else:
                d = u[base + away * stride :]
        elif component != axis:
            first = ints[EDGE_FIRST + 6 * component + 2 * axis + way] + nx * (k if axis == 1 else j)
            values, weights = floats[ints[EDGE_VALUES] + first :], floats[ints[EDGE_WEIGHTS] + first :]
            mine = ghost[way * (nx + 8) :]
            own = c if way == 1 else b
            for i in range(nx):
                mine[i] = beyond(values[i], weights[i], own[i])
            if way == 0:
                a = mine
            else:
                d = mine
    carried(ints[SCHEME], flows, a, b, c, d, flux, nx)


@lean_inlined
def add_left(own, inverse, into, out, plain, count):
    """Add what stays of momentum in the own cells of a row; ``plain``: but for the ends they are of one volume."""
    if plain:
        whole = inverse[1]
        for i in range(1, count - 1):
            own[i] += (into[i] - out[i]) * whole
        for i in range(0, count, count - 1):
            own[i] += (into[i] - out[i]) * inverse[i]
    else:
        for i in range(count):
            own[i] += (into[i] - out[i]) * inverse[i]


@lean(TERM, inner=True)
def advect(t, y, rate, floats, ints):
    """V du/dt = momentum in minus momentum out; row by row, each of whose sides is computed once."""
    faces = ints[FACES]
    u, more = y[ints[AT] : ints[AT] + faces], rate[ints[AT] : ints[AT] + faces]
    areas, inverses = floats[ints[AREAS] : ints[AREAS] + faces], floats[ints[INVERSES] : ints[INVERSES] + faces]
    room, plain, wide = floats[ints[WORK] :], ints[PLAIN] == 1, ints[CELLS] + 9
    through, rows, flux = room[:faces], room[faces : faces + 5 * wide], room[faces + 5 * wide : faces + 6 * wide]
    if plain:
        through = u
    else:
        for f in range(faces):
            through[f] = areas[f] * u[f]
    layers = wide + (ints[CELLS] + 1) * (ints[CELLS + 1] + 1)
    for k in range(ints[CELLS + 2] + 1):
        for j in range(ints[CELLS + 1] + 1):
            for component in range(ints[AXES]):  # side by side, since each reads the others' velocities
                nx, ny, nz = sides(component, ints)
                if j >= ny or k >= nz:
                    continue
                kept = room[faces + 6 * wide + component * layers :]
                row = ints[STARTS + component] + nx * (j + ny * k)
                own, inverse = more[row : row + nx], inverses[row : row + nx]
                along_row(u, through, areas[0] if plain else 1.0, component, j, k, rows, floats, ints)
                inner = component == 0 or ints[PERIODIC + component] == 1
                alike = plain and nx > 2 and (inner or 0 < (j if component == 1 else k) < ints[CELLS + component])
                add_left(own, inverse, rows, rows[1:], alike, nx)
                for axis in range(1, ints[AXES]):
                    area = areas[ints[STARTS + axis]] if plain else 1.0
                    place, slot = (j, 0) if axis == 1 else (k, wide + nx * j)
                    low = kept[slot : slot + nx]
                    if place == 0:
                        across_row(u, through, area, component, axis, 0, j, k, low, rows, floats, ints)
                    across_row(u, through, area, component, axis, place + 1, j, k, flux, rows, floats, ints)
                    add_left(own, inverse, low, flux, alike, nx)
                    for i in range(nx):
                        low[i] = flux[i]


@lean(types.void(A, A, A, I))
def advected(y, rate, floats, ints):
    """`advect`, for readings."""
    advect(0.0, y, rate, floats, ints)


@lean_inlined
def viscous(component, y, rate, floats, ints):
    """Add the sum over faces of g (neighbor - u), less friction at solids, to the rates of a component."""
    start = ints[STARTS + component]
    nx, ny, nz = sides(component, ints)
    n = nx * ny * nz
    x, own = y[ints[AT] + start : ints[AT] + start + n], rate[ints[AT] + start : ints[AT] + start + n]
    gx = floats[ints[VISCOUS] + start : ints[VISCOUS] + start + n]
    gy = floats[ints[VISCOUS + 1] + start : ints[VISCOUS + 1] + start + n]
    gz = floats[ints[VISCOUS + 2] + start : ints[VISCOUS + 2] + start + (n if nz > 1 else 0)]
    friction = floats[ints[FRICTION] + start : ints[FRICTION] + start + n]
    inverse = floats[ints[INVERSES] + start : ints[INVERSES] + start + n]
    lost = floats[ints[WORK] : ints[WORK] + n]
    multiply(nx, ny, nz, 0.0, friction, friction, gx, gy, gz, x, lost)
    for c in range(n):
        own[c] -= lost[c] * inverse[c]


@lean(TERM, inner=True)
def rub(t, y, rate, floats, ints):
    """V du/dt = sum of g (neighbor - u), and of the edges' beside it: viscosity; at solids; and what pushes.

    Solvers that take viscosity implicitly ask for what the velocities on the boundary give alone.
    """
    at, faces = ints[AT], ints[FACES]
    whole = floats[ints[SKIP]] == 0.0
    inverses, pushes = floats[ints[INVERSES] : ints[INVERSES] + faces], floats[ints[PUSHES] : ints[PUSHES] + faces]
    own = rate[at : at + faces]
    if whole:
        for component in range(ints[AXES]):
            viscous(component, y, rate, floats, ints)
    if ints[PUSHED] == 1:
        for k in range(faces):
            own[k] += pushes[k] if inverses[k] != 0.0 else 0.0
    for e in range(ints[EDGES]):
        face = ints[EDGE_FACES + e]
        given = floats[ints[EDGE_VALUES] + e] - (y[at + face] if whole else 0.0)
        own[face] += floats[ints[EDGE_WEIGHTS] + e] * given * inverses[face]
