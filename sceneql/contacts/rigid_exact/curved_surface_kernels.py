# mypy: ignore-errors
"""Curved surfaces in the axes of their bodies: where a plane touches them, how far a point is, and how they bend.

With the support function h(d) of an ellipsoid of half axes a, |a d| for the unit vector d, the point that is farthest
along d is grad h, and its change as d turns grad grad h (Bonnesen & Fenchel 1934). The nearest point of an ellipsoid is
by the root of a convex function (Eberly, Distance from a point to an ellipse, an ellipsoid, or a hyperellipsoid, 2013).
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.distance.core_kernels import REACH
from sceneql.contacts.rigid_exact.curved import AXES, CENTER, COLUMN, ELLIPSOID, FIELD, FORM, RING, SIZES
from sceneql.contacts.shape_kernels import surface
from sceneql.system.signatures_kernels import A, F, I, N

APART = 1e-5
"""Distance of points for the bend of a field, in parts of its size."""
SIDEWAYS = 1e-9
"""Part of its length up to which the normal of a column has no part along its axis, or across: it is at no rim."""
MOST = 100
"""Steps of Newton's method, of which a few are the rule."""
THREE = types.UniTuple(F, 3)


@lean_inlined
def into(floats, f, x, y, z):
    """A vector of the body's axes in those of the shape."""
    g = f + AXES
    return (
        floats[g] * x + floats[g + 1] * y + floats[g + 2] * z,
        floats[g + 3] * x + floats[g + 4] * y + floats[g + 5] * z,
        floats[g + 6] * x + floats[g + 7] * y + floats[g + 8] * z,
    )


@lean_inlined
def out_of(floats, f, x, y, z):
    """A vector of the shape's axes in those of the body."""
    g = f + AXES
    return (
        floats[g] * x + floats[g + 3] * y + floats[g + 6] * z,
        floats[g + 1] * x + floats[g + 4] * y + floats[g + 7] * z,
        floats[g + 2] * x + floats[g + 5] * y + floats[g + 8] * z,
    )


@lean(THREE(A, N, F, F, F, F, F))
def farthest(floats, f, dx, dy, dz, side, turn):
    """The point that is farthest along a unit vector; of a column that of the rim at one ``side`` (-1, 1).

    With a ``turn`` of -1 that of a circle is the one opposite, which goes on as the farthest where the circle has just
    turned through the plane across the vector.
    """
    x, y, z = into(floats, f, dx, dy, dz)
    a, b, c = floats[f + SIZES], floats[f + SIZES + 1], floats[f + SIZES + 2]
    if floats[f + FORM] == ELLIPSOID:
        s = math.sqrt((a * x) ** 2 + (b * y) ** 2 + (c * z) ** 2)
        x, y, z = a * a * x / s, b * b * y / s, c * c * z / s
    else:
        around = math.sqrt(x * x + z * z)
        part = turn * a / around if around > 0.0 else 0.0
        if floats[f + FORM] == RING:
            x, y, z = (part + b) * x, b * y, (part + b) * z
        else:
            x, y, z = part * x, side * b, part * z
    x, y, z = out_of(floats, f, x, y, z)
    return floats[f + CENTER] + x, floats[f + CENTER + 1] + y, floats[f + CENTER + 2] + z


@lean_inlined
def slant(floats, f, dx, dy, dz):
    """The sine of the angle of a unit vector and the axis of a ring or column; 1 for others."""
    if floats[f + FORM] == ELLIPSOID:
        return 1.0
    x, _, z = into(floats, f, dx, dy, dz)
    return math.sqrt(x * x + z * z)


@lean(THREE(A, N, F, F, F, F, F, F, F))
def wander(floats, f, dx, dy, dz, ex, ey, ez, turn):
    """How fast the point that is farthest along d moves over the surface while d changes at the rate e, across d."""
    x, y, z = into(floats, f, dx, dy, dz)
    u, v, w = into(floats, f, ex, ey, ez)
    a, b, c = floats[f + SIZES], floats[f + SIZES + 1], floats[f + SIZES + 2]
    if floats[f + FORM] == ELLIPSOID:
        s = math.sqrt((a * x) ** 2 + (b * y) ** 2 + (c * z) ** 2)
        p, q, r = a * a * x / s, b * b * y / s, c * c * z / s
        along = p * u + q * v + r * w
        u, v, w = (a * a * u - p * along) / s, (b * b * v - q * along) / s, (c * c * w - r * along) / s
    else:
        square = x * x + z * z
        along = (x * u + z * w) / square if square > 0.0 else 0.0
        part = turn * a / math.sqrt(square) if square > 0.0 else 0.0
        tube = b if floats[f + FORM] == RING else 0.0
        u, v, w = part * (u - along * x) + tube * u, tube * v, part * (w - along * z) + tube * w
    return out_of(floats, f, u, v, w)


@lean(types.UniTuple(F, 4)(A, I, N, F, F, F))
def away(floats, ints, f, px, py, pz):
    """The distance of a point of the body's axes, negative inside, and the outer unit normal at the nearest point."""
    x, y, z = into(floats, f, px - floats[f + CENTER], py - floats[f + CENTER + 1], pz - floats[f + CENTER + 2])
    a, b, c = floats[f + SIZES], floats[f + SIZES + 1], floats[f + SIZES + 2]
    if floats[f + FORM] == FIELD:
        return surface(floats, ints, int(a), x, y, z)
    if floats[f + FORM] == ELLIPSOID:
        t = max(a * abs(x) - a * a, b * abs(y) - b * b, c * abs(z) - c * c, -(1.0 - 1e-9) * min(a, b, c) ** 2)
        for _ in range(MOST):
            p, q, r = a * x / (a * a + t), b * y / (b * b + t), c * z / (c * c + t)
            value = p * p + q * q + r * r - 1.0
            slope = 2.0 * (p * p / (a * a + t) + q * q / (b * b + t) + r * r / (c * c + t))
            step = value / slope if slope > 0.0 else 0.0
            t += step
            if not step > 1e-16 * (abs(t) + a * a):
                break
        x, y, z = x / (a * a + t), y / (b * b + t), z / (c * c + t)
        length = math.sqrt(x * x + y * y + z * z)
        if not length > 0.0:
            return -min(a, b, c), 0.0, 1.0, 0.0
        distance = t * length
        x, y, z = x / length, y / length, z / length
    else:
        around = math.sqrt(x * x + z * z)
        u, w = (x / around, z / around) if around > 0.0 else (1.0, 0.0)
        if floats[f + FORM] == RING:
            p, q, base = around - a, y, b
        else:
            p, q, base = around - a, abs(y) - b, 0.0
        length = math.sqrt(p * p + q * q)
        if floats[f + FORM] == COLUMN and (p <= 0.0 or q <= 0.0):
            p, q, length = (1.0, 0.0, p) if p > q else (0.0, 1.0, q)
        elif length > 0.0:
            p, q = p / length, q / length
        else:
            p, q = 1.0, 0.0
        if floats[f + FORM] == COLUMN:
            q = math.copysign(q, y)
        distance = length - base
        x, y, z = p * u, q, p * w
    return (distance, *out_of(floats, f, x, y, z))


@lean(THREE(A, I, N, F, F, F, F, F, F, F, F, F, F))
def bend(floats, ints, f, px, py, pz, distance, nx, ny, nz, ex, ey, ez):
    """How fast the normal that `away` told turns while the point moves at the rate e."""
    x, y, z = into(floats, f, px - floats[f + CENTER], py - floats[f + CENTER + 1], pz - floats[f + CENTER + 2])
    k, m, n = into(floats, f, nx, ny, nz)
    u, v, w = into(floats, f, ex, ey, ez)
    a, b, c = floats[f + SIZES], floats[f + SIZES + 1], floats[f + SIZES + 2]
    along = k * u + m * v + n * w
    u, v, w = u - along * k, v - along * m, w - along * n
    if floats[f + FORM] == FIELD:
        speed = math.sqrt(u * u + v * v + w * w)
        if speed == 0.0:
            return 0.0, 0.0, 0.0
        h = APART * floats[f + REACH] / speed
        _, p, q, r = surface(floats, ints, int(a), x + h * u, y + h * v, z + h * w)
        _, i, j, o = surface(floats, ints, int(a), x - h * u, y - h * v, z - h * w)
        return 0.5 * (p - i) / h, 0.5 * (q - j) / h, 0.5 * (r - o) / h
    if floats[f + FORM] == ELLIPSOID:
        # With y the nearest point, g = y / a^2 and d the distance: n' = W (x' - d n'), W = P diag(1/a^2) P / |g|.
        p, q, r = x - distance * k, y - distance * m, z - distance * n
        size = math.sqrt((p / (a * a)) ** 2 + (q / (b * b)) ** 2 + (r / (c * c)) ** 2)
        # In two directions across the normal.
        if abs(k) <= min(abs(m), abs(n)):
            ix, iy, iz = 0.0, n, -m
        elif abs(m) <= abs(n):
            ix, iy, iz = -n, 0.0, k
        else:
            ix, iy, iz = m, -k, 0.0
        length = math.sqrt(ix * ix + iy * iy + iz * iz)
        ix, iy, iz = ix / length, iy / length, iz / length
        jx, jy, jz = m * iz - n * iy, n * ix - k * iz, k * iy - m * ix
        da, db, dc = 1.0 / (a * a * size), 1.0 / (b * b * size), 1.0 / (c * c * size)
        ii = da * ix * ix + db * iy * iy + dc * iz * iz
        ij = da * ix * jx + db * iy * jy + dc * iz * jz
        jj = da * jx * jx + db * jy * jy + dc * jz * jz
        s, t = ix * u + iy * v + iz * w, jx * u + jy * v + jz * w
        first, second = ii * s + ij * t, ij * s + jj * t
        g, h, o = 1.0 + distance * ii, distance * ij, 1.0 + distance * jj
        root = g * o - h * h
        s, t = (o * first - h * second) / root, (g * second - h * first) / root
        u, v, w = s * ix + t * jx, s * iy + t * jy, s * iz + t * jz
    else:
        # Around the axis, and in the half plane of the axis.
        around = math.sqrt(x * x + z * z)
        i, j = (x / around, z / around) if around > 0.0 else (1.0, 0.0)
        turning = j * u - i * w
        outward = k * i + n * j
        s = turning * outward / around if around > 0.0 else 0.0
        if floats[f + FORM] == RING:
            t = 1.0 / (b + distance)
        else:
            t = 1.0 / distance if abs(outward) > SIDEWAYS and abs(m) > SIDEWAYS and distance > 0.0 else 0.0
        u, v, w = t * (u - turning * j) + s * j, t * v, t * (w + turning * i) - s * i
    return out_of(floats, f, u, v, w)
