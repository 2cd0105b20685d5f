# mypy: ignore-errors
"""What a flow of several fluids does to the points of a skin, and they to it, by composite B-splines (spline_kernels).

Each face counts in proportion to its spline and to the mass in its own cell. So light and heavy fluid beside a skin are
moved alike by its force (the density-scaled one of Brackbill, Kothe & Zemach 1992, J. Comput. Phys. 100, 335-354), or
the light one would be thrown about; and a skin moves as the heavy one does, and not with the mean of both, in which a
light one that slips past makes waves. All forces of a point are still the force there, and their power that of the
skin. Where densities are equal these are the splines alone.
"""

import math

from sceneql.compiled.kernels import lean
from sceneql.flows import layout as flow
from sceneql.skins.skin_layout import BOX_AT, COUNT, DENSITY_AT, FLOW, FORCE_AT, POSITION_AT
from sceneql.skins.spline_kernels import beside, through
from sceneql.system.signatures_kernels import TERM


@lean(TERM, inner=True)
def carry(t, y, rate, floats, ints):
    """The velocity of each vertex is the mean of the flow's there; its force begins at 0."""
    one, box, masses = ints[FLOW:], ints[BOX_AT], ints[DENSITY_AT]
    axes, faces = one[flow.AXES], one[flow.FACES]
    momenta = floats[one[flow.WORK] : one[flow.WORK] + faces]
    for face in range(faces):
        momenta[face] = floats[masses + face] * y[one[flow.AT] + face]
    for v in range(ints[COUNT]):
        at, own = ints[POSITION_AT] + 3 * v, ints[FORCE_AT] + 3 * v
        x = (y[at] - floats[box]) / floats[box + 3]
        y_ = (y[at + 1] - floats[box + 1]) / floats[box + 4]
        z = (y[at + 2] - floats[box + 2]) / floats[box + 5]
        within = beside(x, one[flow.CELLS], one[flow.PERIODIC] == 1)
        within &= beside(y_, one[flow.CELLS + 1], one[flow.PERIODIC + 1] == 1)
        within &= axes == 2 or beside(z, one[flow.CELLS + 2], one[flow.PERIODIC + 2] == 1)
        for component in range(3):
            floats[own + component] = 0.0
            if component < axes:
                start = one[flow.STARTS + component]
                mass = through(floats[masses + start :], component, x, y_, z, 0.0, False, one) if within else 0.0
                momentum = through(momenta[start:], component, x, y_, z, 0.0, False, one) if within else 0.0
                rate[at + component] = momentum / mass if mass > 0.0 else math.nan


@lean(TERM, inner=True)
def push(t, y, rate, floats, ints):
    """The acceleration of the faces around each vertex by its force."""
    one, box, masses = ints[FLOW:], ints[BOX_AT], ints[DENSITY_AT]
    faces = one[flow.FACES]
    moved = floats[one[flow.WORK] : one[flow.WORK] + faces]
    for face in range(faces):
        moved[face] = 0.0
    for v in range(ints[COUNT]):
        at, own = ints[POSITION_AT] + 3 * v, ints[FORCE_AT] + 3 * v
        x = (y[at] - floats[box]) / floats[box + 3]
        y_ = (y[at + 1] - floats[box + 1]) / floats[box + 4]
        z = (y[at + 2] - floats[box + 2]) / floats[box + 5]
        if math.isfinite(x + y_ + z):
            for component in range(one[flow.AXES]):
                start = one[flow.STARTS + component]
                mass = through(floats[masses + start :], component, x, y_, z, 0.0, False, one)
                if mass > 0.0:
                    through(moved[start:], component, x, y_, z, floats[own + component] / mass, True, one)
    own_rate = rate[one[flow.AT] : one[flow.AT] + faces]
    for face in range(faces):
        own_rate[face] += moved[face] if floats[one[flow.INVERSES] + face] > 0.0 else 0.0
