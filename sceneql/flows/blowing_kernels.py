# mypy: ignore-errors
"""Drag of a flow that is solved on masses in it, as a term: linear in the velocities between faces."""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows.layout import AT, AXES, CELLS, PERIODIC, STARTS
from sceneql.system.signatures_kernels import TERM

POSITION_AT, VELOCITY_AT, COUNT, WORK_AT, INVERSE_AT, LINEAR_AT, QUADRATIC_AT, BOX_AT, FLOW = range(9)
"""At BOX_AT low corner and sides of a cell (6 floats); from FLOW on the flow's integers."""


@lean_inlined
def between(place, count, periodic):
    """The two of ``count`` numbers at 0, 1, ... that a place lies between, and the part of the second: on a boundary
    the nearest."""
    low = math.floor(place)
    part = place - low
    first, second = int(low), int(low) + 1
    if periodic:
        return first % count, second % count, part
    if first < 0:
        return 0, 0, 0.0
    if second > count - 1:
        return count - 1, count - 1, 0.0
    return first, second, part


@lean_inlined
def component_at(component, place, y, flow):
    """A component of the velocity at a place (3,) in cells from the low corner [m/s]."""
    periodic = flow[PERIODIC + component] == 1
    nx = flow[CELLS] + (1 if component == 0 and not periodic else 0)
    ny = flow[CELLS + 1] + (1 if component == 1 and not periodic else 0)
    nz = flow[CELLS + 2] + (1 if component == 2 and not periodic else 0)
    x, y_, z = place
    i, ii, a = between(x - (0.0 if component == 0 else 0.5), nx, flow[PERIODIC] == 1)
    j, jj, b = between(y_ - (0.0 if component == 1 else 0.5), ny, flow[PERIODIC + 1] == 1)
    k, kk, c = 0, 0, 0.0
    if flow[AXES] == 3:
        k, kk, c = between(z - (0.0 if component == 2 else 0.5), nz, flow[PERIODIC + 2] == 1)
    at = flow[AT] + flow[STARTS + component]
    total = 0.0
    for corner in range(8 if flow[AXES] == 3 else 4):
        column, weight = (ii, a) if corner & 1 else (i, 1.0 - a)
        row, share = (jj, b) if corner & 2 else (j, 1.0 - b)
        layer, part = (kk, c) if corner & 4 else (k, 1.0 - c)
        total += weight * share * part * y[at + column + nx * (row + ny * layer)]
    return total


@lean(TERM, inner=True)
def wind(t, y, rate, floats, ints):
    """Adds -(a + b |w|) w, w = v - u, to every mass in the box, and takes its power from the work."""
    flow, box = ints[FLOW:], ints[BOX_AT]
    linear, quadratic = floats[ints[LINEAR_AT]], floats[ints[QUADRATIC_AT]]
    power = 0.0
    for mass in range(ints[COUNT]):
        if floats[ints[INVERSE_AT] + mass] == 0.0:
            continue
        at, here = ints[VELOCITY_AT] + 3 * mass, ints[POSITION_AT] + 3 * mass
        place = (
            (y[here] - floats[box]) / floats[box + 3],
            (y[here + 1] - floats[box + 1]) / floats[box + 4],
            (y[here + 2] - floats[box + 2]) / floats[box + 5],
        )
        inside = True
        for axis in range(flow[AXES]):
            within = 0.0 <= place[axis] <= flow[CELLS + axis]
            inside = inside and (within or (flow[PERIODIC + axis] == 1 and math.isfinite(place[axis])))
        if not inside:
            continue
        wx = y[at] - component_at(0, place, y, flow)
        wy = y[at + 1] - component_at(1, place, y, flow)
        wz = y[at + 2] - (component_at(2, place, y, flow) if flow[AXES] == 3 else 0.0)
        c = linear + quadratic * math.sqrt(wx * wx + wy * wy + wz * wz)
        rate[at] -= c * wx
        rate[at + 1] -= c * wy
        rate[at + 2] -= c * wz
        power += c * (wx * y[at] + wy * y[at + 1] + wz * y[at + 2])
    rate[ints[WORK_AT]] += power
