# mypy: ignore-errors
"""What a flow of several fluids does to the points of a skin, and they to it, by composite B-splines (spline_kernels).

Each face counts in proportion to its spline and to the mass in its own cell. So light and heavy fluid beside a skin are
moved alike by its force (the density-scaled one of Brackbill, Kothe & Zemach 1992, J. Comput. Phys. 100, 335-354), or
the light one would be thrown about; and a skin moves as the heavy one does, and not with the mean of both, in which a
light one that slips past makes waves. A factor linear in the place keeps the mean place of what counts at the point, so
that linear velocities are read as they are, and a force has its torque (moving least squares: Vanella & Balaras 2009,
J. Comput. Phys. 228, 6617-6628). The power of forces is that of the skin. Where densities are equal these are the
splines alone. Solids leave less of cells than their faces count by: what these are pushed by is not less.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows import layout as flow
from sceneql.flows.varying.fluid_layout import MOTION
from sceneql.skins.skin_layout import BOX_AT, COUNT, DENSITY_AT, FLOW, FORCE_AT, MODE_AT, PESKIN, POSITION_AT
from sceneql.skins.spline_kernels import beside, stencil, wrapped
from sceneql.system.signatures_kernels import TERM, A, F, I, N

LARGEST = 1.0
"""Of the distance that the factor makes up for, in standard deviations of what counts."""


@lean(types.UniTuple(F, 4)(A, N, F, F, F, types.boolean, I))
def factor(masses, component, x, y, z, peskin, ints):
    """a, b of the factor (a + b . d) at faces d cells off a point, by which masses times splines have the sum 1 and the
    mean place 0."""
    (i, j, k), (wx, wy, wz), (nx, ny, nz), (px, py, pz), layers = stencil(component, x, y, z, peskin, ints)
    u, v = i + (0.0 if component == 0 else 0.5) - x, j + (0.0 if component == 1 else 0.5) - y
    w = k + (0.0 if component == 2 else 0.5) - z if layers > 1 else 0.0
    whole = sx = sy = sz = xx = xy = xz = yy = yz = zz = 0.0
    for c in range(layers):
        for b in range(4):
            both = wz[c] * wy[b]
            row = nx * (wrapped(j, b, ny, py) + ny * wrapped(k, c, nz, pz))
            m = md = mdd = 0.0
            for a in range(4):
                one, d = both * wx[a] * masses[row + wrapped(i, a, nx, px)], u + a
                m, md, mdd = m + one, md + one * d, mdd + one * d * d
            e, f = v + b, w + c
            whole, sx, sy, sz = whole + m, sx + md, sy + m * e, sz + m * f
            xx, xy, xz = xx + mdd, xy + md * e, xz + md * f
            yy, yz, zz = yy + m * e * e, yz + m * e * f, zz + m * f * f
    if not whole > 0.0:
        return math.nan, 0.0, 0.0, 0.0
    sx, sy, sz = sx / whole, sy / whole, sz / whole
    xx, xy, xz = xx / whole - sx * sx, xy / whole - sx * sy, xz / whole - sx * sz
    yy, yz, zz = yy / whole - sy * sy, yz / whole - sy * sz, zz / whole - sz * sz
    if layers == 1:
        zz = 1.0
    p, q, r = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    det = xx * p + xy * q + xz * r
    if not det > 0.0:
        return 1.0 / whole, 0.0, 0.0, 0.0
    bx = (p * sx + q * sy + r * sz) / det
    by = (q * sx + (xx * zz - xz * xz) * sy + (xy * xz - xx * yz) * sz) / det
    bz = (r * sx + (xy * xz - xx * yz) * sy + (xx * yy - xy * xy) * sz) / det if layers > 1 else 0.0
    off = sx * bx + sy * by + sz * bz
    part = 1.0 if off <= LARGEST * LARGEST else LARGEST / math.sqrt(off)
    return (1.0 + part * off) / whole, -part * bx / whole, -part * by / whole, -part * bz / whole


@lean(types.float64(A, N, F, F, F, types.UniTuple(F, 4), F, types.boolean, types.boolean, I))
def through(u, component, x, y, z, by, amount, spreading, peskin, ints):
    """What the faces ``u`` of a component say at a place in cells from the low corner, each by its spline and the
    factor ``by``; where ``spreading``, they get ``amount`` from there."""
    (i, j, k), (wx, wy, wz), (nx, ny, nz), (px, py, pz), layers = stencil(component, x, y, z, peskin, ints)
    at, bx, by_, bz = by
    at += bx * (i + (0.0 if component == 0 else 0.5) - x) + by_ * (j + (0.0 if component == 1 else 0.5) - y)
    at += bz * (k + (0.0 if component == 2 else 0.5) - z)
    total = 0.0
    for c in range(layers):
        for b in range(4):
            both = wz[c] * wy[b]
            row = nx * (wrapped(j, b, ny, py) + ny * wrapped(k, c, nz, pz))
            for a in range(4):
                face = row + wrapped(i, a, nx, px)
                part = both * wx[a] * (at + a * bx + b * by_ + c * bz)
                if spreading:
                    u[face] += part * amount
                else:
                    total += part * u[face]
    return total


@lean_inlined
def place(y, at, box, floats):
    """A vertex in cells from the low corner."""
    return (
        (y[at] - floats[box]) / floats[box + 3],
        (y[at + 1] - floats[box + 1]) / floats[box + 4],
        (y[at + 2] - floats[box + 2]) / floats[box + 5],
    )


@lean(TERM, inner=True)
def carry(t, y, rate, floats, ints):
    """The velocity of each vertex is the mean of the flow's there; its force begins at 0."""
    one, box = ints[FLOW:], ints[BOX_AT]
    axes, faces = one[flow.AXES], one[flow.FACES]
    masses = ints[DENSITY_AT] + faces
    momenta = floats[one[flow.WORK] : one[flow.WORK] + faces]
    for face in range(faces):
        momenta[face] = floats[masses + face] * y[one[flow.AT] + face]
    for v in range(ints[COUNT]):
        at, own = ints[POSITION_AT] + 3 * v, ints[FORCE_AT] + 3 * v
        x, y_, z = place(y, at, box, floats)
        within = beside(x, one[flow.CELLS], one[flow.PERIODIC] == 1)
        within &= beside(y_, one[flow.CELLS + 1], one[flow.PERIODIC + 1] == 1)
        within &= axes == 2 or beside(z, one[flow.CELLS + 2], one[flow.PERIODIC + 2] == 1)
        for component in range(3):
            floats[own + component] = 0.0
            if component < axes:
                start = one[flow.STARTS + component]
                rate[at + component] = math.nan
                if within:
                    by = factor(floats[masses + start :], component, x, y_, z, ints[PESKIN] == 1, one)
                    rate[at + component] = through(
                        momenta[start:], component, x, y_, z, by, 0.0, False, ints[PESKIN] == 1, one
                    )


@lean(TERM, inner=True)
def push(t, y, rate, floats, ints):
    """The acceleration of the faces around each vertex by its force."""
    if floats[ints[MODE_AT]] == MOTION:
        return
    one, box = ints[FLOW:], ints[BOX_AT]
    faces = one[flow.FACES]
    masses = ints[DENSITY_AT] + faces
    moved = floats[one[flow.WORK] : one[flow.WORK] + faces]
    for face in range(faces):
        moved[face] = 0.0
    for v in range(ints[COUNT]):
        x, y_, z = place(y, ints[POSITION_AT] + 3 * v, box, floats)
        if math.isfinite(x + y_ + z):
            for component in range(one[flow.AXES]):
                start, newtons = one[flow.STARTS + component], floats[ints[FORCE_AT] + 3 * v + component]
                by = factor(floats[masses + start :], component, x, y_, z, ints[PESKIN] == 1, one)
                if math.isfinite(by[0]):
                    through(moved[start:], component, x, y_, z, by, newtons, True, ints[PESKIN] == 1, one)
    own_rate = rate[one[flow.AT] : one[flow.AT] + faces]
    for face in range(faces):
        if floats[one[flow.INVERSES] + face] > 0.0:
            own_rate[face] += moved[face] * (floats[masses + face] / floats[ints[DENSITY_AT] + face])
