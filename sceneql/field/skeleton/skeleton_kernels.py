# mypy: ignore-errors
"""Density fields of skeletons: values and gradients of parts of any shape and kernel, in a hierarchy of boxes.

The density of a part (rows as in skeleton_parts_kernels) is K(s), s the least |x - p|^2/R(p)^2 over the points p of the
segment a b, the triangle a b c or the quadratic Bezier curve a c b; R varies linearly along a segment from a's radius
to b's, quadratically along a curve. Of the parts of a group, which stand in consecutive rows, the largest density
counts; the densities of groups are added.
"""

import numpy as np
from numba import types

from sceneql.compiled.kernels import inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.field.skeleton import skeleton_parts_kernels as part
from sceneql.field.skeleton.falloff_kernels import falloff, falloff_slope

F = types.float64
to_curve = lazy("sceneql.field.skeleton.curve_kernels:to_curve", types.UniTuple(F, 4)(F[:, ::1], types.int64, F, F, F))


@inlined
def to_segment(ax, ay, az, bx, by, bz, ra, rb, x, y, z):
    """(vector from the segment's point p with the least |x - p|/R to (x, y, z), p's parameter q from 0 to 1).

    d/dq |w - q s|^2/(ra + q r)^2 has the sign of q den - num.
    """
    wx = x - ax
    wy = y - ay
    wz = z - az
    sx = bx - ax
    sy = by - ay
    sz = bz - az
    length2 = sx * sx + sy * sy + sz * sz
    along = wx * sx + wy * sy + wz * sz
    q = 0.0
    if length2 > 0.0:
        if ra == rb:
            q = min(max(along / length2, 0.0), 1.0)
        else:
            r = rb - ra
            d2 = wx * wx + wy * wy + wz * wz
            den = length2 * ra + along * r
            num = along * ra + r * d2
            if den > 0.0:
                q = min(max(num / den, 0.0), 1.0)
            elif (d2 - 2.0 * along + length2) * ra * ra < d2 * rb * rb:
                q = 1.0
    return wx - q * sx, wy - q * sy, wz - q * sz, q


@inlined
def to_triangle(ax, ay, az, bx, by, bz, cx, cy, cz, x, y, z):
    """Vector from the nearest point of a triangle: on its face for points in the prism over it, else on an edge."""
    ux = bx - ax
    uy = by - ay
    uz = bz - az
    vx = cx - ax
    vy = cy - ay
    vz = cz - az
    wx = x - ax
    wy = y - ay
    wz = z - az
    nx = uy * vz - uz * vy
    ny = uz * vx - ux * vz
    nz = ux * vy - uy * vx
    n2 = nx * nx + ny * ny + nz * nz
    # Barycentric coordinates times n2 (Ericson 2005, 3.4).
    q = nx * (wy * vz - wz * vy) + ny * (wz * vx - wx * vz) + nz * (wx * vy - wy * vx)
    r = nx * (uy * wz - uz * wy) + ny * (uz * wx - ux * wz) + nz * (ux * wy - uy * wx)
    if n2 > 0.0 and q >= 0.0 and r >= 0.0 and q + r <= n2:
        h = (wx * nx + wy * ny + wz * nz) / n2
        return h * nx, h * ny, h * nz
    px, py, pz, _ = to_segment(ax, ay, az, bx, by, bz, 1.0, 1.0, x, y, z)
    best = px * px + py * py + pz * pz
    wx, wy, wz, _ = to_segment(bx, by, bz, cx, cy, cz, 1.0, 1.0, x, y, z)
    d2 = wx * wx + wy * wy + wz * wz
    if d2 < best:
        best, px, py, pz = d2, wx, wy, wz
    wx, wy, wz, _ = to_segment(cx, cy, cz, ax, ay, az, 1.0, 1.0, x, y, z)
    if wx * wx + wy * wy + wz * wz < best:
        px, py, pz = wx, wy, wz
    return px, py, pz


@inlined
def to_part(parts, i, x, y, z):
    """(vector from the point p of the part at row i with the least |x - p|/R to (x, y, z), parameter of p along it)."""
    ax = parts[i, 0]
    ay = parts[i, 1]
    az = parts[i, 2]
    bx = parts[i, 3]
    by = parts[i, 4]
    bz = parts[i, 5]
    if parts[i + 1, part.SHAPE] == part.TRIANGLE:
        wx, wy, wz = to_triangle(
            ax, ay, az, bx, by, bz, parts[i + 1, 0], parts[i + 1, 1], parts[i + 1, 2], x, y, z
        )  # fmt: skip
        return wx, wy, wz, 0.0
    if parts[i + 1, part.SHAPE] == part.CURVE:
        return to_curve(parts, i, x, y, z)
    return to_segment(ax, ay, az, bx, by, bz, parts[i, part.RADIUS], parts[i + 1, part.RADIUS_B], x, y, z)


@inlined
def radius_at(parts, i, q):
    """Radius of the part at row i at a parameter along it."""
    if parts[i + 1, part.SHAPE] == part.CURVE:
        ra = parts[i, part.RADIUS]
        rc = parts[i + 1, part.MIDDLE]
        return ra + q * (2.0 * (rc - ra) + q * (ra - 2.0 * rc + parts[i + 1, part.RADIUS_B]))
    return parts[i, part.RADIUS] + q * (parts[i + 1, part.RADIUS_B] - parts[i, part.RADIUS])


@inlined
def outside_node(parts, i, x0, x1, y0, y1, z0, z1):
    """Whether the box x0..x1, y0..y1, z0..z1 and the node at row i are disjoint."""
    return (
        x0 > parts[i, 3] or x1 < parts[i, 0] or y0 > parts[i, 4] or y1 < parts[i, 1] or z0 > parts[i, 5]
        or z1 < parts[i, 2]
    )  # fmt: skip


@inlined
def passed_by(parts, i, x, y, z):
    """Whether a point is out of reach of the curve at row i, by the bounding box of its control points."""
    if parts[i + 1, part.SHAPE] != part.CURVE:
        return False
    away2 = 0.0
    p = (x, y, z)
    for k in range(3):
        a, b, c = parts[i, k], parts[i, k + 3], parts[i + 1, k]
        off = max(max(min(min(a, b), c) - p[k], p[k] - max(max(a, b), c)), 0.0)
        away2 += off * off
    reach = part.largest_radius(parts, i)
    return away2 > reach * reach * (1.0 + 1.0e-9)


@inlined
def skeleton_value(parts, start, stop, x, y, z):
    """Sum of the densities of the groups in rows start..stop-1 at a point; NaN at a point that is not finite."""
    if not np.isfinite(x + y + z):
        return np.nan
    total = best = 0.0
    group = -1.0
    i = start
    while i < stop:
        if parts[i + 1, part.SHAPE] == part.NODE:
            i += part.STRIDE + (int(parts[i, part.RADIUS]) if outside_node(parts, i, x, x, y, y, z, z) else 0)
            continue
        if passed_by(parts, i, x, y, z):
            i += part.STRIDE
            continue
        wx, wy, wz, q = to_part(parts, i, x, y, z)
        radius = radius_at(parts, i, q)
        density = falloff(parts[i + 1, part.KERNEL], (wx * wx + wy * wy + wz * wz) / (radius * radius))
        if parts[i + 1, part.GROUP] != group:
            group = parts[i + 1, part.GROUP]
            total += best
            best = 0.0
        if density > 0.0 and density * abs(parts[i, part.WEIGHT]) > abs(best):
            best = density * parts[i, part.WEIGHT]
        i += part.STRIDE
    return total + best


@inlined
def part_gradient(parts, i, x, y, z):
    """(weighted density of the part at row i, its three derivatives)."""
    wx, wy, wz, q = to_part(parts, i, x, y, z)
    radius = radius_at(parts, i, q)
    inverse = 1.0 / (radius * radius)
    d2 = wx * wx + wy * wy + wz * wz
    s = d2 / (radius * radius)
    weight = parts[i, part.WEIGHT]
    density = weight * falloff(parts[i + 1, part.KERNEL], s)
    slope = weight * falloff_slope(parts[i + 1, part.KERNEL], s)
    # p minimizes s, so the motion of p itself does not change s to first order.
    return density, 2.0 * slope * inverse * wx, 2.0 * slope * inverse * wy, 2.0 * slope * inverse * wz


@inlined
def skeleton_gradient(parts, start, stop, x, y, z):
    """Gradient of ``skeleton_value`` with respect to the point."""
    gx = gy = gz = 0.0
    best = bx = by = bz = 0.0
    group = -1.0
    i = start
    while i < stop:
        if parts[i + 1, part.SHAPE] == part.NODE:
            i += part.STRIDE + (int(parts[i, part.RADIUS]) if outside_node(parts, i, x, x, y, y, z, z) else 0)
            continue
        if passed_by(parts, i, x, y, z):
            i += part.STRIDE
            continue
        density, ux, uy, uz = part_gradient(parts, i, x, y, z)
        if parts[i + 1, part.GROUP] != group:
            group = parts[i + 1, part.GROUP]
            gx += bx
            gy += by
            gz += bz
            best = bx = by = bz = 0.0
        if abs(density) > abs(best):
            best, bx, by, bz = density, ux, uy, uz
        i += part.STRIDE
    return gx + bx, gy + by, gz + bz
