# mypy: ignore-errors
"""The nearest point of the surface of a tape, for bodies that have come near it (contacts/shapes/implicit_kernels)."""

import math

import numpy as np

from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.shape_kernels import FOUR
from sceneql.contacts.shapes.implicit_kernels import tape_of
from sceneql.field.tape.gradient_kernels import gradient
from sceneql.system.signatures_kernels import A, F, I, N

MOST_STEPS = 40
MOST_NEWTON = 12
FOOT = 1e-14
"""Parts of the solid's size within which a point is the foot that is looked for."""
FAR = 1e300


@lean(FOUR(A, I, N, F, F, F), inner=True)
def slope(floats, ints, at, x, y, z):
    """f and its gradient at a point of the solid's own coordinates."""
    code, constants, parts, room = tape_of(floats, ints, at)
    return gradient(code, constants, parts, room, x, y, z)


@lean_inlined
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

    Steps along the gradient onto the surface, then Newton's method for the nearest point p: x - p = m grad f(p),
    f(p) = 0, with second derivatives from differences of gradients.
    """
    size = floats[ints[at + layout.SIZE]]
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
        ux, uy, uz = x - px - m * a, y - py - m * b, z - pz - m * c
        if ux * ux + uy * uy + uz * uz <= (FOOT * size) ** 2 and abs(f) <= FOOT * size * math.sqrt(g2):
            # As at once where the field is a distance.
            g = math.sqrt(g2)
            d = m * g
            if d * first > 0.0 and abs(d) < 10.0 * size:
                return d, a / g, b / g, c / g
            break
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
        g2 = a * a + b * b + c * c
        g = math.sqrt(g2)
        step = math.sqrt(dx * dx + dy * dy + dz * dz)
        if not (step < size and g > 0.0):
            break
        if step < 1e-9 * size and abs(f) < 1e-12 * size * g:
            d = ((x - px) * a + (y - py) * b + (z - pz) * c) / g
            if d * first > 0.0 and abs(d) < 10.0 * size:
                return d, a / g, b / g, c / g
            break
    return first, na, nb, nc
