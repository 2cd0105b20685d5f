# mypy: ignore-errors
"""Advection of a field by a flow: limited upwind values at faces, so that no new extrema arise (TVD).

A face's flow [m^3/s] is stored with the cell on its high side (system.Grid), positive along the axis. The face value is
the upstream cell's plus half a limited slope (Sweby 1984, SIAM J. Numer. Anal. 21, 995-1011), of order 2 (van Leer
1974, J. Comput. Phys. 14, 361-370) or 3 (Koren 1993, Notes on Numerical Fluid Mechanics 45, 117-138) where the field is
smooth; without a limiter, or where the cell behind the upstream one is missing, the upstream cell's alone.
"""

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.lanes_kernels import below
from sceneql.system.signatures_kernels import TERM

UPWIND, VAN_LEER, KOREN = range(3)
SIXTH = 1.0 / 6.0
AT, NX, NY, NZ, DIVISORS, VOLUMES, FLOWS, PERIODIC, LIMITER = *range(7), 9, 12
STRENGTH, BROUGHT, LEAVING, BROUGHT_BACK, LEAVING_BACK, INFLOW = range(13, 19)
"""Volumes are 0 outside; flows, and 1 where periodic, along x, y, z; BACK: for a strength below 0."""


@lean_inlined
def koren(behind, ahead):
    """Half of Koren's limited slope: selected, not branched to, so that loops over it are vectorized."""
    a, b = abs(behind), abs(ahead)
    third = (2.0 * b + a) * SIXTH
    size = a if a < b else b
    size = third if third < size else size
    size = size if ahead > 0.0 else -size
    return 0.0 if behind * ahead <= 0.0 else size


@lean_inlined
def koren_of_lanes(behind, ahead):
    """`koren` of lanes: the part of the slope above 0, and that below."""
    third = (ahead + ahead + behind) * SIXTH
    low, high = below(behind, ahead, behind, ahead), below(ahead, behind, behind, ahead)
    low, high = below(third, low, third, low), below(high, third, third, high)
    return below(0.0, low, low, 0.0) + below(high, 0.0, high, 0.0)


@lean_inlined
def half_slope(kind, behind, ahead):
    """Half the limited slope at the upstream cell, from the differences behind it and ahead of it."""
    if behind * ahead <= 0.0 or kind == UPWIND:
        return 0.0
    if kind == VAN_LEER:
        return behind * ahead / (behind + ahead)
    return koren(behind, ahead)


@lean_inlined
def beyond(cell, place, count, stride, way, periodic, floats, volumes):
    """The neighbor of a cell, its number along the axis being ``place``, one way (1, -1); -1 where there is none."""
    ahead = place + way
    found = cell + way * stride
    if ahead < 0 or ahead >= count:
        if not periodic:
            return -1
        found = cell - way * (count - 1) * stride
    return found if floats[volumes + found] > 0.0 else -1


@lean(TERM, inner=True)
def carry(t, y, rate, floats, ints):
    """V dc/dt = inflow minus outflow through faces; flow through the boundary is added to the tally of inflow."""
    at, nx, ny, nz = ints[AT], ints[NX], ints[NY], ints[NZ]
    divisors, volumes, kind = ints[DIVISORS], ints[VOLUMES], ints[LIMITER]
    strength = floats[ints[STRENGTH]]
    n = nx * ny * nz
    c = y[at : at + n]
    for axis in range(3 if nz > 1 else 2):
        flows, periodic = ints[FLOWS + axis], ints[PERIODIC + axis] == 1
        count = nx if axis == 0 else (ny if axis == 1 else nz)
        stride = 1 if axis == 0 else (nx if axis == 1 else nx * ny)
        for k in range(nz):
            for j in range(ny):
                for i in range(nx):
                    cell = i + nx * (j + ny * k)
                    flow = strength * floats[flows + cell]
                    if flow == 0.0:
                        continue
                    place = i if axis == 0 else (j if axis == 1 else k)
                    before = cell - stride if place > 0 else cell + (count - 1) * stride
                    if flow > 0.0:
                        up, down = before, cell
                        behind = beyond(before, place - 1 if place > 0 else count - 1, count, stride, -1, periodic,
                                        floats, volumes)  # fmt: skip
                    else:
                        up, down = cell, before
                        behind = beyond(cell, place, count, stride, 1, periodic, floats, volumes)
                    value = c[up]
                    if behind >= 0:
                        value += half_slope(kind, c[up] - c[behind], c[down] - c[up])
                    rate[at + before] -= flow * value / floats[divisors + before]
                    rate[at + cell] += flow * value / floats[divisors + cell]
    inflow = 0.0
    brought = ints[BROUGHT] if strength >= 0.0 else ints[BROUGHT_BACK]
    leaving = ints[LEAVING] if strength >= 0.0 else ints[LEAVING_BACK]
    for cell in range(n):
        through = abs(strength) * (floats[brought + cell] - floats[leaving + cell] * c[cell])
        if through != 0.0:
            rate[at + cell] += through / floats[divisors + cell]
            inflow += through
    rate[ints[INFLOW]] += inflow
