# mypy: ignore-errors
"""What a flow does to masses that it carries, and they to it: by the splines of skins (spline_kernels.py).

Their velocities are those of the flow there. Forces add newtons to the rates of these, as to those of any masses; here
the newtons are handed to the faces around, and so move the masses along with the fluid. A mass that is held stays, and
keeps what pulls at it to itself.
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows import layout as flow
from sceneql.skins.immersed_layout import (
    BOX_AT,
    COUNT,
    DENSITY_AT,
    FLOW_AT,
    FORCE_AT,
    INVERSE_AT,
    PESKIN,
    POSITION_AT,
    VELOCITY_AT,
)
from sceneql.skins.spline_kernels import beside, through
from sceneql.system.signatures_kernels import AFTER_STEP, TERM

ASIDE = 1e-4
"""Cells by which the flow is read before and after a mass on its way."""


@lean_inlined
def place(y, at, box, floats):
    """A mass in cells from the low corner."""
    return (
        (y[at] - floats[box]) / floats[box + 3],
        (y[at + 1] - floats[box + 1]) / floats[box + 4],
        (y[at + 2] - floats[box + 2]) / floats[box + 5],
    )


@lean_inlined
def follow(y, floats, ints):
    """Writes the velocities of all masses that are free."""
    one = ints[ints[FLOW_AT] :]
    axes = one[flow.AXES]
    for k in range(ints[COUNT]):
        if floats[ints[INVERSE_AT] + k] == 0.0:
            continue
        x, y_, z = place(y, ints[POSITION_AT] + 3 * k, ints[BOX_AT], floats)
        within = beside(x, one[flow.CELLS], one[flow.PERIODIC] == 1)
        within &= beside(y_, one[flow.CELLS + 1], one[flow.PERIODIC + 1] == 1)
        within &= axes == 2 or beside(z, one[flow.CELLS + 2], one[flow.PERIODIC + 2] == 1)
        for component in range(3):
            found = 0.0
            if component < axes:
                u = y[one[flow.AT] + one[flow.STARTS + component] :]
                found = through(u, component, x, y_, z, 0.0, False, ints[PESKIN] == 1, one) if within else math.nan
            y[ints[VELOCITY_AT] + 3 * k + component] = found


@lean(TERM, inner=True)
def carry(t, y, rate, floats, ints):
    """The velocity of each mass is the flow's there; what contacts push with begins at 0."""
    follow(y, floats, ints)
    for k in range(3 * ints[COUNT]):
        free = floats[ints[INVERSE_AT] + k // 3] > 0.0
        rate[ints[POSITION_AT] + k] = y[ints[VELOCITY_AT] + k] if free else 0.0
        floats[ints[FORCE_AT] + k] = 0.0


@lean(TERM, inner=True)
def accelerate(t, y, rate, floats, ints):
    """The accelerations of free masses, where the rate is the whole one: those of the flow along their ways."""
    one = ints[ints[FLOW_AT] :]
    axes, faces = one[flow.AXES], one[flow.FACES]
    if floats[one[flow.SKIP]] != 0.0:
        return
    u, du = y[one[flow.AT] : one[flow.AT] + faces], rate[one[flow.AT] : one[flow.AT] + faces]
    for k in range(ints[COUNT]):
        if floats[ints[INVERSE_AT] + k] == 0.0:
            continue
        v, box = ints[VELOCITY_AT] + 3 * k, ints[BOX_AT]
        x, y_, z = place(y, ints[POSITION_AT] + 3 * k, box, floats)
        p, q, r = y[v] / floats[box + 3], y[v + 1] / floats[box + 4], y[v + 2] / floats[box + 5]
        speed = math.sqrt(p * p + q * q + r * r)
        if not math.isfinite(x + y_ + z + speed):
            continue
        h = ASIDE / speed if speed > 0.0 else 0.0
        for component in range(axes):
            start, four = one[flow.STARTS + component], ints[PESKIN] == 1
            found = through(du[start:], component, x, y_, z, 0.0, False, four, one)
            if speed > 0.0:
                after = through(u[start:], component, x + h * p, y_ + h * q, z + h * r, 0.0, False, four, one)
                before = through(u[start:], component, x - h * p, y_ - h * q, z - h * r, 0.0, False, four, one)
                found += (after - before) / (2.0 * h)
            rate[v + component] = found


@lean(AFTER_STEP, inner=True)
def settle(t0, t1, y0, rate0, y1, floats, ints):
    """Velocities at the end of a step, and in samples."""
    follow(y1, floats, ints)
    return False


@lean_inlined
def take(rate, floats, ints, k, component):
    """The newtons on a mass, which its rate is rid of."""
    own = ints[VELOCITY_AT] + 3 * k + component
    newtons = rate[own] + floats[ints[FORCE_AT] + 3 * k + component]
    rate[own] = 0.0
    return newtons if floats[ints[INVERSE_AT] + k] > 0.0 else 0.0


@lean(TERM, inner=True)
def push(t, y, rate, floats, ints):
    """Hands the newtons on all masses to the faces around them, over the mass of each face's own fluid."""
    one = ints[ints[FLOW_AT] :]
    faces = one[flow.FACES]
    newtons = floats[one[flow.WORK] : one[flow.WORK] + faces]
    for face in range(faces):
        newtons[face] = 0.0
    for k in range(ints[COUNT]):
        x, y_, z = place(y, ints[POSITION_AT] + 3 * k, ints[BOX_AT], floats)
        for component in range(3):
            got = take(rate, floats, ints, k, component)
            if component < one[flow.AXES] and math.isfinite(x + y_ + z):
                some = newtons[one[flow.STARTS + component] :]
                through(some, component, x, y_, z, got, True, ints[PESKIN] == 1, one)
    inverses = floats[one[flow.INVERSES] : one[flow.INVERSES] + faces]
    own_rate = rate[one[flow.AT] : one[flow.AT] + faces]
    for face in range(faces):
        own_rate[face] += newtons[face] * inverses[face] / floats[ints[DENSITY_AT]]
