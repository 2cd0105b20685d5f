# mypy: ignore-errors
"""The solid {f < 0} of a tape in its own coordinates; size: a length [m] that it is of.

Distances are to the nearest point of the surface, which is found by Newton's method where the field is smooth; where
that fails (in front of the sharp edges of combined solids, far away) they are f / |grad f|. What is clear of the solid
is proved by interval arithmetic, which asks for no bound of a slope.

Further integers: the addresses of gradient and box of the tape, offset and number of its constants, of its parts and of
its rows of scratch in the floats, rows of code, and the code, two integers a row.
"""

import math

import numpy as np
from numba import types

from sceneql.field.tape_ops import NOWHERE, SCRATCH_COLUMNS
from sceneql.kernels import inlined, kernel
from sceneql.simulation.contacts.shape_kernels import (
    BEND_TYPE,
    CLEAR_TYPE,
    DATA,
    FOUR,
    ROTATION,
    SIZE,
    SURFACE_TYPE,
    inward,
    kernel_at,
    turn,
)
from sceneql.system_kernels import A, F, I, N

TAPE = (types.int32[:, ::1], A, types.float64[:, ::1], types.float64[:, ::1])
GRADIENT_TYPE = FOUR(*TAPE, F, F, F)
BOX_TYPE = types.Tuple((F, F, N))(*TAPE, F, F, F, F, F, F)
gradient_at, box_at = kernel_at(GRADIENT_TYPE), kernel_at(BOX_TYPE)

GRADIENT, BOX, CONSTANTS, PARTS, SCRATCH, CODE = 0, 1, 2, 4, 6, 8
HEAD = CODE + 1

MOST_STEPS = 40
MOST_NEWTON = 12
FAR = 1e300


@inlined
def tape_of(floats, ints, at):
    """The four arrays of the tape."""
    d = ints[at + DATA]
    rows, parts, scratch = ints[d + CODE], ints[d + PARTS + 1], ints[d + SCRATCH + 1]
    code = ints[d + HEAD : d + HEAD + 2 * rows].view(np.int32).reshape((rows, 4))
    constants = floats[ints[d + CONSTANTS] : ints[d + CONSTANTS] + ints[d + CONSTANTS + 1]]
    first = ints[d + PARTS]
    skeleton = floats[first : first + 8 * parts].reshape((parts, 8))
    first = ints[d + SCRATCH]
    room = floats[first : first + SCRATCH_COLUMNS * scratch].reshape((scratch, SCRATCH_COLUMNS))
    return code, constants, skeleton, room


@kernel(FOUR(A, I, N, F, F, F), inner=True)
def slope(floats, ints, at, x, y, z):
    """f and its gradient at a point of the solid's own coordinates."""
    code, constants, parts, room = tape_of(floats, ints, at)
    return gradient_at(ints[ints[at + DATA] + GRADIENT])(code, constants, parts, room, x, y, z)


@inlined
def solve(h, a, b, c):
    """The solution of h s = (a, b, c) with h (3, 3), by Cramer's rule."""
    p = h[1, 1] * h[2, 2] - h[1, 2] * h[2, 1]
    q = h[1, 2] * h[2, 0] - h[1, 0] * h[2, 2]
    r = h[1, 0] * h[2, 1] - h[1, 1] * h[2, 0]
    scale = 1.0 / (h[0, 0] * p + h[0, 1] * q + h[0, 2] * r)
    x = a * p + h[0, 1] * (c * h[1, 2] - b * h[2, 2]) + h[0, 2] * (b * h[2, 1] - c * h[1, 1])
    y = h[0, 0] * (b * h[2, 2] - c * h[1, 2]) + a * q + h[0, 2] * (c * h[1, 0] - b * h[2, 0])
    z = h[0, 0] * (c * h[1, 1] - b * h[2, 1]) + h[0, 1] * (b * h[2, 0] - c * h[1, 0]) + a * r
    return x * scale, y * scale, z * scale


@kernel(FOUR(A, I, N, F, F, F), inner=True)
def nearest(floats, ints, at, x, y, z):
    """Signed distance of a point and normal, in the solid's own coordinates.

    Down the gradient onto the surface, then Newton's method for the nearest point p: x - p = m grad f(p), f(p) = 0,
    with second derivatives from differences of gradients.
    """
    size = floats[ints[at + SIZE]]
    f, a, b, c = slope(floats, ints, at, x, y, z)
    g2 = a * a + b * b + c * c
    if not (g2 > 0.0 and abs(f) < FAR and g2 < FAR):
        return (FAR if math.isnan(f) or f > 0.0 else f), 0.0, 1.0, 0.0
    g = math.sqrt(g2)
    first, na, nb, nc = f / g, a / g, b / g, c / g
    if abs(first) < 1e-12 * size:
        return first, na, nb, nc
    px, py, pz = x, y, z
    for _ in range(MOST_STEPS):
        px, py, pz = px - f * a / g2, py - f * b / g2, pz - f * c / g2
        f, a, b, c = slope(floats, ints, at, px, py, pz)
        g2 = a * a + b * b + c * c
        if not (g2 > 0.0 and g2 < FAR) or abs(f) <= 1e-3 * math.sqrt(g2) * abs(first):
            break
    m = ((x - px) * a + (y - py) * b + (z - pz) * c) / g2
    h = np.empty((3, 3))
    apart = 1e-5 * size
    for _ in range(MOST_NEWTON):
        for k in range(3):
            _, u, v, w = slope(floats, ints, at, px + apart * (k == 0), py + apart * (k == 1), pz + apart * (k == 2))
            h[0, k], h[1, k], h[2, k] = m * (u - a) / apart, m * (v - b) / apart, m * (w - c) / apart
            h[k, k] += 1.0
        ux, uy, uz = solve(h, a, b, c)
        wx, wy, wz = solve(h, px - x + m * a, py - y + m * b, pz - z + m * c)
        add = (f - (a * wx + b * wy + c * wz)) / (a * ux + b * uy + c * uz)
        dx, dy, dz = wx + add * ux, wy + add * uy, wz + add * uz
        px, py, pz, m = px - dx, py - dy, pz - dz, m + add
        f, a, b, c = slope(floats, ints, at, px, py, pz)
        g = math.sqrt(a * a + b * b + c * c)
        step = math.sqrt(dx * dx + dy * dy + dz * dz)
        if not (step < size and g > 0.0):
            break
        if step < 1e-9 * size and abs(f) < 1e-12 * size * g:
            d = ((x - px) * a + (y - py) * b + (z - pz) * c) / g
            if d * first > 0.0 and abs(d) < 10.0 * size:
                return d, a / g, b / g, c / g
            break
    return first, na, nb, nc


@kernel(SURFACE_TYPE, inner=True)
def surface(floats, ints, at, x, y, z):
    """Signed distance and normal; where the field is not defined it is far away."""
    x, y, z = inward(floats, ints, at, x, y, z)
    d, x, y, z = nearest(floats, ints, at, x, y, z)
    x, y, z = turn(floats, ints[at + ROTATION], x, y, z)
    return d, x, y, z


@kernel(BEND_TYPE, inner=True)
def bend(floats, ints, at, x, y, z, vx, vy, vz):
    """By a difference of normals along v."""
    speed = math.sqrt(vx * vx + vy * vy + vz * vz)
    if speed == 0.0:
        return 0.0
    apart = 1e-5 * floats[ints[at + SIZE]] / speed
    ex, ey, ez = apart * vx, apart * vy, apart * vz
    _, a, b, c = surface(floats, ints, at, x - ex, y - ey, z - ez)
    _, p, q, r = surface(floats, ints, at, x + ex, y + ey, z + ez)
    return (vx * (p - a) + vy * (q - b) + vz * (r - c)) / (2.0 * apart)


@kernel(CLEAR_TYPE, inner=True)
def clear(floats, ints, at, x, y, z, radius):
    """By the least value of f in the box around the ball."""
    x, y, z = inward(floats, ints, at, x, y, z)
    code, constants, parts, room = tape_of(floats, ints, at)
    least, _, status = box_at(ints[ints[at + DATA] + BOX])(
        code, constants, parts, room, x - radius, x + radius, y - radius, y + radius, z - radius, z + radius
    )
    return status == NOWHERE or least > 0.0
