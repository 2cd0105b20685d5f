# mypy: ignore-errors
"""What a flow on a staggered grid does to the points of a skin, and they to it, by composite B-splines or as Peskin.

A component of the velocity is read, and of the force spread, by the cubic B-spline along its own axis and by quadratic
ones across (Gruninger & Griffith 2025, composite B-spline regularized delta functions), so that the divergence of what
is read is the quadratic spline of the grid's divergence: none. Beside a wall faces are continued by reflection, the
component across the wall odd, u(-k) = 2 u(0) - u(k), those along it even, which keeps that so. Forces are spread by the
transposed weights: their power is that of the forces at the points. The kernel of four points is to compare (Peskin
2002, equation 6.27): the same along and across, and what it reads has a divergence, by which a skin loses its volume.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows import layout as flow
from sceneql.skins.skin_layout import BOX_AT, COUNT, DENSITY_AT, FLOW, FORCE_AT, PESKIN, POSITION_AT
from sceneql.system.signatures_kernels import TERM, A, F, I, N

OUTSIDE = 1.0
"""Cells off the box from which on a point has no velocity."""


@lean_inlined
def four_points(f):
    """Peskin's weights of the places -1, 0, 1, 2 at f from 0 to 1."""
    near, far = math.sqrt(1.0 + 4.0 * f - 4.0 * f * f), 3.0 - 2.0 * f
    return (far - near) / 8.0, (far + near) / 8.0, (4.0 - far + near) / 8.0, (4.0 - far - near) / 8.0


@lean_inlined
def odd(first, count, periodic, a, b, c, d):
    """The weights of four faces where those beyond a wall are continued oddly."""
    if not periodic:
        if first == 0:
            a, b, c = 0.0, b + 2.0 * a, c - a
        if first == count - 1:
            b, c, d = b - d, c + 2.0 * d, 0.0
    return a, b, c, d


@lean_inlined
def even(first, count, periodic, a, b, c):
    """The weights of three faces, and of none, where those beyond a wall are continued evenly."""
    if not periodic:
        if first == 0:
            a, b = 0.0, b + a
        if first == count - 1:
            b, c = b + c, 0.0
    return a, b, c, 0.0


@lean_inlined
def along(place, count, periodic, peskin):
    """The weights of four faces at 0, 1, ... ``count`` and the first one's number."""
    first = min(max(math.floor(place), 0), count - 1)
    if periodic:
        first = math.floor(place)
    f = place - first
    g = 1.0 - f
    a, d = g * g * g / 6.0, f * f * f / 6.0
    b, c = (3.0 * f * f * f - 6.0 * f * f + 4.0) / 6.0, (3.0 * g * g * g - 6.0 * g * g + 4.0) / 6.0
    if peskin:
        a, b, c, d = four_points(min(max(f, 0.0), 1.0))
    return first - 1, odd(first, count, periodic, a, b, c, d)


@lean_inlined
def across(place, count, periodic, peskin):
    """The weights of four faces, of splines three, in the middles of ``count`` cells and the first one's number."""
    if peskin:
        return across_by_four(place, count, periodic)
    first = min(max(math.floor(place), 0), count - 1)
    if periodic:
        first = math.floor(place)
    f = place - first - 0.5
    a, b, c = 0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f)
    return first - 1, even(first, count, periodic, a, b, c)


@lean_inlined
def across_by_four(place, count, periodic):
    """The weights of Peskin's kernel there."""
    first = min(max(math.floor(place - 0.5), -1), count - 1)
    if periodic:
        first = math.floor(place - 0.5)
    a, b, c, d = four_points(min(max(place - 0.5 - first, 0.0), 1.0))
    if not periodic:
        if first == -1:
            a, b, c, d = 0.0, 0.0, b + c, a + d
        if first == 0:
            a, b = 0.0, a + b
        if first == count - 2:
            c, d = c + d, 0.0
        if first == count - 1:
            a, b, c, d = a + d, b + c, 0.0, 0.0
    return first - 1, (a, b, c, d)


@lean_inlined
def stencil(component, x, y, z, peskin, ints):
    """Of the faces of a component around a place in cells from the low corner: by axis the first one's number, four
    weights, how many there are, whether the last one is beside the first; and how many layers along z have any."""
    px, py, pz = ints[flow.PERIODIC] == 1, ints[flow.PERIODIC + 1] == 1, ints[flow.PERIODIC + 2] == 1
    nx, ny, nz = ints[flow.CELLS], ints[flow.CELLS + 1], ints[flow.CELLS + 2]
    i, wx = along(x, nx, px, peskin) if component == 0 else across(x, nx, px, peskin)
    j, wy = along(y, ny, py, peskin) if component == 1 else across(y, ny, py, peskin)
    k, wz, layers = 0, (1.0, 0.0, 0.0, 0.0), 1
    if ints[flow.AXES] == 3:
        k, wz = along(z, nz, pz, peskin) if component == 2 else across(z, nz, pz, peskin)
        layers = 4
    nx += component == 0 and not px
    ny += component == 1 and not py
    nz += component == 2 and not pz
    return (i, j, k), (wx, wy, wz), (nx, ny, nz), (px, py, pz), layers


@lean_inlined
def wrapped(first, k, size, periodic):
    """The number of a face; one that has no weight beyond a wall is any."""
    return (first + k) % size if periodic else min(max(first + k, 0), size - 1)


@lean(types.float64(A, N, F, F, F, F, types.boolean, types.boolean, I))
def through(u, component, x, y, z, amount, spreading, peskin, ints):
    """What the faces ``u`` of a component say at a place in cells from the low corner; where ``spreading``, they get
    ``amount`` from there."""
    (i, j, k), (wx, wy, wz), (nx, ny, nz), (px, py, pz), layers = stencil(component, x, y, z, peskin, ints)
    total = 0.0
    for c in range(layers):
        for b in range(4):
            both = wz[c] * wy[b]
            row = nx * (wrapped(j, b, ny, py) + ny * wrapped(k, c, nz, pz))
            for a in range(4):
                face = row + wrapped(i, a, nx, px)
                if spreading:
                    u[face] += both * wx[a] * amount
                else:
                    total += both * wx[a] * u[face]
    return total


@lean_inlined
def beside(place, count, periodic):
    """Whether a place has a velocity."""
    return math.isfinite(place) and (periodic or -OUTSIDE < place < count + OUTSIDE)


@lean(TERM, inner=True)
def carry(t, y, rate, floats, ints):
    """The velocity of each vertex is the flow's there; its force begins at 0."""
    one, box = ints[FLOW:], ints[BOX_AT]
    axes = one[flow.AXES]
    for v in range(ints[COUNT]):
        at = ints[POSITION_AT] + 3 * v
        x = (y[at] - floats[box]) / floats[box + 3]
        y_ = (y[at + 1] - floats[box + 1]) / floats[box + 4]
        z = (y[at + 2] - floats[box + 2]) / floats[box + 5]
        within = beside(x, one[flow.CELLS], one[flow.PERIODIC] == 1)
        within &= beside(y_, one[flow.CELLS + 1], one[flow.PERIODIC + 1] == 1)
        within &= axes == 2 or beside(z, one[flow.CELLS + 2], one[flow.PERIODIC + 2] == 1)
        for component in range(3):
            floats[ints[FORCE_AT] + 3 * v + component] = 0.0
            if component < axes:
                u = y[one[flow.AT] + one[flow.STARTS + component] :]
                rate[at + component] = (
                    through(u, component, x, y_, z, 0.0, False, ints[PESKIN] == 1, one) if within else math.nan
                )


@lean(TERM, inner=True)
def push(t, y, rate, floats, ints):
    """The forces of all vertices on the faces around them, over the mass of each face's own fluid."""
    one, box = ints[FLOW:], ints[BOX_AT]
    faces, density = one[flow.FACES], floats[ints[DENSITY_AT]]
    newtons = floats[one[flow.WORK] : one[flow.WORK] + faces]
    for face in range(faces):
        newtons[face] = 0.0
    for v in range(ints[COUNT]):
        at, own = ints[POSITION_AT] + 3 * v, ints[FORCE_AT] + 3 * v
        x = (y[at] - floats[box]) / floats[box + 3]
        y_ = (y[at + 1] - floats[box + 1]) / floats[box + 4]
        z = (y[at + 2] - floats[box + 2]) / floats[box + 5]
        if math.isfinite(x + y_ + z):
            for component in range(one[flow.AXES]):
                got = newtons[one[flow.STARTS + component] :]
                through(got, component, x, y_, z, floats[own + component], True, ints[PESKIN] == 1, one)
    inverses = floats[one[flow.INVERSES] : one[flow.INVERSES] + faces]
    own_rate = rate[one[flow.AT] : one[flow.AT] + faces]
    for face in range(faces):
        own_rate[face] += newtons[face] * inverses[face] / density
