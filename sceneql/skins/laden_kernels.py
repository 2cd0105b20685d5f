# mypy: ignore-errors
"""What masses that a flow carries add to its inertia: to the own cells of the faces around, by the same splines.

So light and heavy faces beside them are moved alike by their forces (Zhu & Peskin 2002, J. Comput. Phys. 179, 452-468).
A spline's slope is a difference of two of an order less: so what a mass that moves takes from a face it brings to the
next one, with the momentum that goes along, and the sums stay.
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows import layout as flow
from sceneql.flows.varying import fluid_layout as fluid
from sceneql.flows.varying.coefficients_kernels import pressure
from sceneql.skins.immersed_kernels import place, take
from sceneql.skins.immersed_layout import BOX_AT, COUNT, EXCESS_AT, FLOW_AT, HEAD, INVERSE_AT, POSITION_AT, VELOCITY_AT
from sceneql.skins.spline_kernels import even, odd, stencil, through, wrapped
from sceneql.system.signatures_kernels import TERM


@lean_inlined
def past_along(place, count, periodic):
    """What the weights of `along` hand on, for each cell that a point moves: beyond the first face, the second, the
    third."""
    first = math.floor(place) if periodic else min(max(math.floor(place), 0), count - 1)
    f = place - first
    g = 1.0 - f
    a, b, _, d = odd(
        first, count, periodic,
        -0.5 * g * g, 0.5 * (3.0 * f - 4.0) * f, -0.5 * (3.0 * g - 4.0) * g, 0.5 * f * f,
    )  # fmt: skip
    return -a, -a - b, d


@lean_inlined
def past_across(place, count, periodic):
    """The same of those of `across`."""
    first = math.floor(place) if periodic else min(max(math.floor(place), 0), count - 1)
    f = place - first - 0.5
    a, _, c, _ = even(first, count, periodic, f - 0.5, -2.0 * f, 0.5 + f)
    return -a, c, 0.0


@lean(TERM, inner=True)
def add(t, y, rate, floats, ints):
    """Adds to the masses in the own cells of faces, by which the equation of the pressure is made anew."""
    own = ints[HEAD:]
    one = ints[ints[FLOW_AT] :]
    faces = one[flow.FACES]
    more = floats[one[flow.WORK] : one[flow.WORK] + faces]
    for face in range(faces):
        more[face] = 0.0
    for k in range(ints[COUNT]):
        x, y_, z = place(y, ints[POSITION_AT] + 3 * k, ints[BOX_AT], floats)
        if floats[ints[INVERSE_AT] + k] > 0.0 and math.isfinite(x + y_ + z):
            for component in range(one[flow.AXES]):
                some = more[one[flow.STARTS + component] :]
                through(some, component, x, y_, z, floats[ints[EXCESS_AT] + k], True, False, one)
    for face in range(faces):
        left = floats[own[fluid.LEFT] + face] if own[fluid.LEFT] >= 0 else 1.0
        floats[own[fluid.MASSES] + face] += left * more[face]
        floats[own[fluid.MASSES] + faces + face] += more[face]
    pressure(floats, own)


@lean_inlined
def between(far, near, beyond):
    """What goes over a side between two faces, of values upwind of it, at it and downwind: limited, of order 3 where it
    is smooth (Koren 1993)."""
    step, before = beyond - near, near - far
    if step * before <= 0.0:
        return near
    r = before / step
    return near + 0.5 * min(2.0 * r, min((1.0 + 2.0 * r) / 3.0, 2.0)) * step


@lean(TERM, inner=True)
def bring(t, y, rate, floats, ints):
    """Mass and momentum that masses on their way bring to own cells; in the whole rate what follows for velocities."""
    own = ints[HEAD:]
    mode = floats[own[fluid.MODE]]
    if mode == fluid.FORCES:
        return
    one = ints[ints[FLOW_AT] :]
    faces, axes = one[flow.FACES], one[flow.AXES]
    whole = mode == fluid.WHOLE
    momentum = floats[own[fluid.MOMENTUM] : own[fluid.MOMENTUM] + faces]
    mass = floats[own[fluid.MASS] : own[fluid.MASS] + faces]
    if whole:  # what the fluid brings has been used by now
        for face in range(faces):
            momentum[face] = mass[face] = 0.0
    for k in range(ints[COUNT]):
        x, y_, z = place(y, ints[POSITION_AT] + 3 * k, ints[BOX_AT], floats)
        if floats[ints[INVERSE_AT] + k] == 0.0 or not math.isfinite(x + y_ + z):
            continue
        for component in range(axes):
            (i, j, l), (wx, wy, wz), (nx, ny, nz), (px, py, pz), layers = stencil(component, x, y_, z, False, one)
            start = one[flow.STARTS + component]
            u = y[one[flow.AT] + start :]
            for axis in range(axes):
                here = x if axis == 0 else (y_ if axis == 1 else z)
                around = one[flow.PERIODIC + axis] == 1
                cells = one[flow.CELLS + axis]
                past = past_along(here, cells, around) if axis == component else past_across(here, cells, around)
                speed = y[ints[VELOCITY_AT] + 3 * k + axis] / floats[ints[BOX_AT] + 3 + axis]
                speed *= floats[ints[EXCESS_AT] + k]
                for c in range(layers if axis != 2 else 1):
                    for b in range(4 if axis != 1 else 1):
                        for a in range(4 if axis != 0 else 1):
                            part = speed * (wx[a] if axis != 0 else 1.0) * (wy[b] if axis != 1 else 1.0)
                            part *= wz[c] if axis != 2 else 1.0
                            if part == 0.0:
                                continue
                            for side in range(3):
                                flows = part * past[side]
                                if flows == 0.0:
                                    continue
                                low, high = side, side + 1
                                far = low - 1 if flows > 0.0 else high + 1
                                at = wrapped(i, far if axis == 0 else a, nx, px)
                                at += nx * wrapped(j, far if axis == 1 else b, ny, py)
                                at += nx * ny * wrapped(l, far if axis == 2 else c, nz, pz)
                                lower = wrapped(i, low if axis == 0 else a, nx, px)
                                lower += nx * wrapped(j, low if axis == 1 else b, ny, py)
                                lower += nx * ny * wrapped(l, low if axis == 2 else c, nz, pz)
                                upper = wrapped(i, high if axis == 0 else a, nx, px)
                                upper += nx * wrapped(j, high if axis == 1 else b, ny, py)
                                upper += nx * ny * wrapped(l, high if axis == 2 else c, nz, pz)
                                near, beyond = (lower, upper) if flows > 0.0 else (upper, lower)
                                brought = flows * between(u[at], u[near], u[beyond])
                                mass[start + lower] -= flows
                                mass[start + upper] += flows
                                momentum[start + lower] -= brought
                                momentum[start + upper] += brought
    for face in range(faces if whole else 0):
        if floats[one[flow.INVERSES] + face] > 0.0:
            u = y[one[flow.AT] + face]
            own_mass = floats[own[fluid.MASSES] + face]
            rate[one[flow.AT] + face] += (momentum[face] - u * mass[face]) / own_mass


@lean(TERM, inner=True)
def push(t, y, rate, floats, ints):
    """Hands the newtons on all masses to the faces around them, over the mass in each face's own cell.

    The weight that the flow gives all that its cells hold is not theirs: their own is among their newtons.
    """
    own = ints[HEAD:]
    one = ints[ints[FLOW_AT] :]
    faces, axes = one[flow.FACES], one[flow.AXES]
    newtons = floats[one[flow.WORK] : one[flow.WORK] + faces]
    for face in range(faces):
        newtons[face] = 0.0
    for k in range(ints[COUNT]):
        x, y_, z = place(y, ints[POSITION_AT] + 3 * k, ints[BOX_AT], floats)
        for component in range(3):
            got = take(rate, floats, ints, k, component)
            if component < axes and floats[ints[INVERSE_AT] + k] > 0.0 and math.isfinite(x + y_ + z):
                got -= floats[ints[EXCESS_AT] + k] * floats[own[fluid.WEIGHT] + component]
                some = newtons[one[flow.STARTS + component] :]
                through(some, component, x, y_, z, got, True, False, one)
    if floats[own[fluid.MODE]] == fluid.MOTION:
        return
    for face in range(faces):
        if floats[one[flow.INVERSES] + face] > 0.0:
            rate[one[flow.AT] + face] += newtons[face] / floats[own[fluid.MASSES] + faces + face]
