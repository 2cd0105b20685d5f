# mypy: ignore-errors
"""Advection and viscosity of face velocities, as terms: what crosses the faces of each velocity's own cell.

Momentum is conserved; values at faces of these cells are central (energy is conserved too: Harlow & Welch 1965;
Morinishi et al. 1998), upwind, or upwind with half a limited slope (Koren 1993). Where fluid comes in through an open
side, it brings no momentum: so what comes back in there cannot grow (Bruneau & Fabrie 1994).
"""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
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
    PERIODIC,
    PUSHES,
    SCHEME,
    STARTS,
    UPWIND,
    VISCOUS,
)
from sceneql.grids.drift_kernels import KOREN as KOREN_SLOPE
from sceneql.grids.drift_kernels import half_slope
from sceneql.grids.multigrid.stencil_kernels import flow
from sceneql.system.signatures_kernels import TERM, A, I


@lean_inlined
def sides(component, ints):
    """Faces of a component along x, y, z."""
    nx = ints[CELLS] + (1 if component == 0 and ints[PERIODIC] == 0 else 0)
    ny = ints[CELLS + 1] + (1 if component == 1 and ints[PERIODIC + 1] == 0 else 0)
    nz = ints[CELLS + 2] + (1 if component == 2 and ints[PERIODIC + 2] == 0 else 0)
    return nx, ny, nz


@lean_inlined
def number(i, j, k, component, ints):
    """The face (i, j, k) of a component, of all faces."""
    nx, ny, _ = sides(component, ints)
    return ints[STARTS + component] + i + nx * (j + ny * k)


@lean_inlined
def through(i, j, k, component, axis, y, floats, ints):
    """What flows along another axis between face (i, j, k) of a component and the one before it along that axis:
    the mean of the flows through the faces of both cells [m^3/s]; of one, on the boundary."""
    at, areas = ints[AT], ints[AREAS]
    place = i if component == 0 else (j if component == 1 else k)
    count = ints[CELLS + component]
    total = 0.0
    if place < count:
        one = number(i, j, k, axis, ints)
        total += floats[areas + one] * y[at + one]
    before = place - 1
    if before < 0 and ints[PERIODIC + component] == 1:
        before = count - 1
    if before >= 0:
        i, j, k = (
            (before if component == 0 else i),
            (before if component == 1 else j),
            (before if component == 2 else k),
        )
        one = number(i, j, k, axis, ints)
        total += floats[areas + one] * y[at + one]
    return 0.5 * total


@lean_inlined
def carried(scheme, up, down, steps_up):
    """The value that a face carries; ``steps_up``: the upstream value less the one behind it."""
    if scheme == CENTRAL:
        return 0.5 * (up + down)
    if scheme == UPWIND:
        return up
    return up + half_slope(KOREN_SLOPE, steps_up, down - up)


@lean_inlined
def beside(edge, own, floats, ints):
    """The value next to the boundary less the one beyond it; 0 where no velocity is given there."""
    if floats[ints[EDGE_WEIGHTS] + edge] == 0.0:
        return 0.0
    return 2.0 * (own - floats[ints[EDGE_VALUES] + edge])


@lean(TERM, inner=True)
def advect(t, y, rate, floats, ints):
    """V du/dt = momentum in minus momentum out."""
    at, scheme, inverses = ints[AT], ints[SCHEME], ints[INVERSES]
    for component in range(ints[AXES]):
        nx, ny, nz = sides(component, ints)
        for axis in range(ints[AXES]):
            count = nx if axis == 0 else (ny if axis == 1 else nz)
            stride = 1 if axis == 0 else (nx if axis == 1 else nx * ny)
            own, periodic = axis == component, ints[PERIODIC + axis] == 1
            low_edge = ints[EDGE_FIRST + 6 * component + 2 * axis]
            high_edge = ints[EDGE_FIRST + 6 * component + 2 * axis + 1]
            for k in range(nz):
                for j in range(ny):
                    for i in range(nx):
                        face = ints[STARTS + component] + i + nx * (j + ny * k)
                        place = i if axis == 0 else (j if axis == 1 else k)
                        across = (j + ny * k) if axis == 0 else ((i + nx * k) if axis == 1 else (i + nx * j))
                        if place == 0 and not periodic:
                            if own:
                                out = min(floats[ints[AREAS] + face] * y[at + face], 0.0)
                                rate[at + face] += out * y[at + face] * floats[inverses + face]
                            else:
                                passing = through(i, j, k, component, axis, y, floats, ints)
                                if passing != 0.0:
                                    given = passing > 0.0 and low_edge >= 0
                                    value = floats[ints[EDGE_VALUES] + low_edge + across] if given else (
                                        0.0 if passing > 0.0 else y[at + face])  # fmt: skip
                                    rate[at + face] += passing * value * floats[inverses + face]
                        if place == count - 1 and not periodic:
                            if own:
                                out = max(floats[ints[AREAS] + face] * y[at + face], 0.0)
                                rate[at + face] -= out * y[at + face] * floats[inverses + face]
                            else:
                                further = (i + (axis == 0), j + (axis == 1), k + (axis == 2))
                                passing = through(*further, component, axis, y, floats, ints)
                                if passing != 0.0:
                                    given = passing < 0.0 and high_edge >= 0
                                    value = floats[ints[EDGE_VALUES] + high_edge + across] if given else (
                                        0.0 if passing < 0.0 else y[at + face])  # fmt: skip
                                    rate[at + face] -= passing * value * floats[inverses + face]
                        if place == 0 and not periodic:
                            continue
                        before = face - stride if place > 0 else face + (count - 1) * stride
                        if own:
                            areas = ints[AREAS]
                            passing = 0.5 * (
                                floats[areas + before] * y[at + before] + floats[areas + face] * y[at + face]
                            )
                        else:
                            passing = through(i, j, k, component, axis, y, floats, ints)
                        if passing == 0.0:
                            continue
                        up, down = (before, face) if passing > 0.0 else (face, before)
                        step = 0.0
                        if scheme > CENTRAL:
                            if passing > 0.0:
                                ahead = (place if place > 0 else count) - 2
                                if ahead < 0 and periodic:
                                    step = y[at + up] - y[at + up + (count - 1) * stride]
                                elif ahead >= 0:
                                    step = y[at + up] - y[at + up - stride]
                                elif not own and low_edge >= 0:
                                    step = beside(low_edge + across, y[at + up], floats, ints)
                            elif place + 1 < count:
                                step = y[at + up] - y[at + up + stride]
                            elif periodic:
                                step = y[at + up] - y[at + up - (count - 1) * stride]
                            elif not own and high_edge >= 0:
                                step = beside(high_edge + across, y[at + up], floats, ints)
                        moved = passing * carried(scheme, y[at + up], y[at + down], step)
                        rate[at + before] -= moved * floats[inverses + before]
                        rate[at + face] += moved * floats[inverses + face]


@lean(types.void(A, A, A, I))
def advected(y, rate, floats, ints):
    """`advect`, for readings."""
    advect(0.0, y, rate, floats, ints)


@lean(TERM, inner=True)
def rub(t, y, rate, floats, ints):
    """V du/dt = sum of g (neighbor - u), and of the edges' beside it: viscosity; at solids; and what pushes."""
    at = ints[AT]
    for component in range(ints[AXES]):
        nx, ny, nz = sides(component, ints)
        n, start = nx * ny * nz, ints[STARTS + component]
        x = y[at + start : at + start + n]
        gx = floats[ints[VISCOUS] + start : ints[VISCOUS] + start + n]
        gy = floats[ints[VISCOUS + 1] + start : ints[VISCOUS + 1] + start + n]
        gz = floats[ints[VISCOUS + 2] + start : ints[VISCOUS + 2] + start + (n if nz > 1 else 0)]
        inverse = floats[ints[INVERSES] + start : ints[INVERSES] + start + n]
        own, deep, plane = rate[at + start : at + start + n], nz > 1, nx * ny
        for k in range(nz):
            down, up = ((k - 1) % nz - k) * plane, ((k + 1) % nz - k) * plane
            for j in range(ny):
                row = nx * j + plane * k
                last = row + nx - 1
                low, high = ((j - 1) % ny - j) * nx, ((j + 1) % ny - j) * nx
                for c in range(row + 1, last):
                    total = flow(x, gx, gy, gz, c, c - 1, c + 1, c + low, c + high, c + down, c + up, deep)
                    own[c] += total * inverse[c]
                for c in range(row, last + 1, max(1, nx - 1)):
                    left, right = (last if c == row else c - 1), (row if c == last else c + 1)
                    total = flow(x, gx, gy, gz, c, left, right, c + low, c + high, c + down, c + up, deep)
                    own[c] += total * inverse[c]
    for k in range(ints[FACES]):
        if floats[ints[INVERSES] + k] != 0.0:
            rate[at + k] += floats[ints[PUSHES] + k]
            rate[at + k] -= floats[ints[FRICTION] + k] * y[at + k] * floats[ints[INVERSES] + k]
    for e in range(ints[EDGES]):
        face = ints[EDGE_FACES + e]
        given = floats[ints[EDGE_VALUES] + e] - y[at + face]
        rate[at + face] += floats[ints[EDGE_WEIGHTS] + e] * given * floats[ints[INVERSES] + face]
