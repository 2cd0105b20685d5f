# mypy: ignore-errors
"""What solids that move leave of boxes: open parts, their depths and middles, by planes through parts of each box.

The same as obstacles.Solids.cut, from the distances and normals of contacts/shape_kernels.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts import layout as surfaces
from sceneql.contacts.shape_kernels import surface, velocity
from sceneql.flows.obstacles.moving_layout import HEAD, LOW, NUMBERS, SOLIDS, SPACING
from sceneql.system.signatures_kernels import A, F, I, N

FIVE = types.Tuple((F, F, F, F, N))
SEVEN = types.UniTuple(F, 5)
FLAT = 0.05
"""Length of a normal in the plane of a flat flow below which a surface is parallel to it."""
LEAST_SLOPE = 1e-4


@lean(FIVE(A, I, N, F, F, F), inner=True)
def nearest(floats, ints, axes, x, y, z):
    """Distance from the nearest solid, below 0 within, normal away from it, and its number."""
    found, p, q, r, number = math.inf, 0.0, 0.0, 0.0, 0
    for k in range(ints[SOLIDS]):
        d, a, b, c = surface(floats, ints, HEAD + surfaces.OBJECT * k, x, y, z)
        if axes == 2:  # the section of the surface with the plane
            long = math.sqrt(a * a + b * b)
            if long > FLAT:
                d, a, b = d / long, a / long, b / long
            c = 0.0
        if d < found:
            found, p, q, r, number = d, a, b, c, k
    return found, p, q, r, number


@lean_inlined
def wall_velocity(floats, ints, number, x, y, z):
    """Velocity of a solid's point."""
    return velocity(floats, ints, HEAD + surfaces.OBJECT * number, x, y, z)


@lean_inlined
def under(phi, a, b, c, axes, deep):
    """Part of a box where phi + slopes . x < 0, by how much phi rises over its sides a, b, c, of which ``axes`` count;
    ``deep``: instead the mean of -(phi + slopes . x) there, and of 0 elsewhere (grids/domain/cut.below)."""
    a, b, c = abs(a), abs(b) if axes > 1 else 0.0, abs(c) if axes > 2 else 0.0
    total = a + b + c
    if total <= 1e-9 * abs(phi) or total == 0.0:
        return (-phi if deep else 1.0) if phi < 0.0 else 0.0
    a, b, c = max(a / total, LEAST_SLOPE), max(b / total, LEAST_SLOPE), max(c / total, LEAST_SLOPE)
    whole = a + (b if axes > 1 else 0.0) + (c if axes > 2 else 0.0)
    room = 0.5 * whole - phi / total
    if room <= 0.0:
        return 0.0
    if room >= whole:
        return (room - 0.5 * whole) * total if deep else 1.0
    found = 0.0
    power = axes + 1 if deep else axes
    for chosen in range(1 << axes):
        left = room - (a if chosen & 1 else 0.0) - (b if chosen & 2 else 0.0) - (c if chosen & 4 else 0.0)
        if left > 0.0:
            odd = ((chosen & 1) + (chosen >> 1 & 1) + (chosen >> 2 & 1)) & 1
            found += (-1.0 if odd else 1.0) * left**power
    product = a * (b if axes > 1 else 1.0) * (c if axes > 2 else 1.0)
    fraction = found / (product * (1.0 if power == 1 else 2.0 if power == 2 else 6.0 if power == 3 else 24.0))
    return fraction * total if deep else min(fraction, 1.0)


@lean_inlined
def side(a, b, c, axis):
    """One of three numbers."""
    return a if axis == 0 else (b if axis == 1 else c)


@lean(SEVEN(A, I, N, N, F, F, F), inner=True)
def cut(floats, ints, axes, across, x, y, z):
    """The open part of a box, its mean depth and its middle (3), of a cell's sides around a point, but along the axis
    ``across`` (3: along none), and along z in a flat flow, of no extent."""
    at = ints[NUMBERS] + SPACING
    dx, dy, dz = floats[at], floats[at + 1], floats[at + 2]
    first = 1 if across == 0 else 0
    second = first + 1 if across != first + 1 else first + 2
    count = axes if across == 3 else axes - 1
    splits = 4 if count < 3 else 2
    one, two = side(dx, dy, dz, first) / splits, side(dx, dy, dz, second) / splits if count > 1 else 0.0
    three = dz / splits if count > 2 else 0.0
    rows, layers = splits if count > 1 else 1, splits if count > 2 else 1
    open_, depth, ma, mb, mc = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(layers):
        for j in range(rows):
            for i in range(splits):
                a = (i + 0.5 - 0.5 * splits) * one
                b = (j + 0.5 - 0.5 * splits) * two if count > 1 else 0.0
                c = (k + 0.5 - 0.5 * splits) * three if count > 2 else 0.0
                px = x + (a if first == 0 else 0.0)
                py = y + (a if first == 1 else (b if count > 1 and second == 1 else 0.0))
                pz = z + (b if count > 1 and second == 2 else c)
                d, nx, ny, nz, _ = nearest(floats, ints, axes, px, py, pz)
                p, q = side(nx, ny, nz, first), side(nx, ny, nz, second) if count > 1 else 0.0
                r = nz if count > 2 else 0.0
                part = under(-d, p * one, q * two, r * three, count, False)
                deep = under(-d, p * one, q * two, r * three, count, True)
                steep = p * p + q * q + r * r
                off = (deep - part * d) / steep if 0.0 < part < 1.0 and steep > 0.0 else 0.0
                ma, mb, mc = ma + part * a + off * p, mb + part * b + off * q, mc + part * c + off * r
                open_ += part
                depth += deep
    parts = 1.0 / (splits * rows * layers)
    if open_ == 0.0:
        return 0.0, 0.0, x, y, z
    ma, mb, mc = ma / open_, mb / open_, mc / open_
    cx = x + (ma if first == 0 else 0.0)
    cy = y + (ma if first == 1 else (mb if count > 1 and second == 1 else 0.0))
    cz = z + (mb if count > 1 and second == 2 else mc)
    return open_ * parts, depth / open_, cx, cy, cz


@lean_inlined
def reach(floats, ints, axes, across, a, b, c):
    """How far from the middle of a box (as in `cut`) along a normal its corners are, twice."""
    at = ints[NUMBERS] + SPACING
    found = abs(a) * floats[at] if across != 0 else 0.0
    found += abs(b) * floats[at + 1] if across != 1 else 0.0
    return found + (abs(c) * floats[at + 2] if across != 2 and axes == 3 else 0.0)


@lean_inlined
def place(floats, ints, axes, component, i, j, k):
    """The middle of a face of a component, or of a cell (component 3)."""
    at = ints[NUMBERS]
    x = floats[at + LOW] + floats[at + SPACING] * (i + (0.0 if component == 0 else 0.5))
    y = floats[at + LOW + 1] + floats[at + SPACING + 1] * (j + (0.0 if component == 1 else 0.5))
    z = floats[at + LOW + 2] + floats[at + SPACING + 2] * (k + (0.0 if component == 2 else 0.5))
    return x, y, z if axes == 3 else 0.0
