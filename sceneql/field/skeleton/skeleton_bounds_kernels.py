# mypy: ignore-errors
"""Skeletons' densities over a box: bounds of the value and of the gradient, and the parts within reach.

The distance to a part is 1-Lipschitz in the point, and so is the vector from the nearest point of a convex part.
"""

import numpy as np
from numba import types

from sceneql.compiled.kernels import inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.field.skeleton import skeleton_parts_kernels as part
from sceneql.field.skeleton.falloff_kernels import falloff, falloff_slope
from sceneql.field.skeleton.skeleton_kernels import outside_node, radius_at, to_part

ULPS = 1.2e-15
F = types.float64
curve_way = lazy(
    "sceneql.field.skeleton.curve_kernels:curve_way", types.UniTuple(F, 2)(F[:, ::1], types.int64, F, F, F, F)
)


@inlined
def box_of(scratch, p):
    """(center, half sides) of the box whose sides are rows p..p+2 of scratch."""
    hx = 0.5 * (scratch[p, 1] - scratch[p, 0])
    hy = 0.5 * (scratch[p + 1, 1] - scratch[p + 1, 0])
    hz = 0.5 * (scratch[p + 2, 1] - scratch[p + 2, 0])
    return scratch[p, 0] + hx, scratch[p + 1, 0] + hy, scratch[p + 2, 0] + hz, hx, hy, hz


@inlined
def range_of(parts, i, x, y, z, diagonal):
    """Of the part at row i in a ball of radius ``diagonal`` about a point: (vector w from the part's best point, bound
    of the change of w, least and most s, least and most R at the best point)."""
    wx, wy, wz, q = to_part(parts, i, x, y, z)
    size = abs(x) + abs(y) + abs(z)
    length2 = away2 = 0.0
    for k in range(3):
        size += abs(parts[i, k]) + abs(parts[i, k + 3]) + abs(parts[i + 1, k])
        length2 += (parts[i, k + 3] - parts[i, k]) ** 2
    off = diagonal * (1.0 + 1.0e-14) + 8.0 * ULPS * size * part.condition(parts, i)
    one = parts[i, part.RADIUS]
    two = radius_at(parts, i, 1.0)
    radius = radius_at(parts, i, q)
    small = part.least_radius(parts, i)
    large = part.largest_radius(parts, i)
    r = np.sqrt(wx * wx + wy * wy + wz * wz)
    nearest = max(r / radius * (1.0 - 8.0 * ULPS) - off / small, 0.0)
    farthest = (r + off) / radius * (1.0 + 8.0 * ULPS)
    if parts[i + 1, part.SHAPE] == part.CURVE:
        move, change = curve_way(parts, i, x, y, z, off)
        off += move * (1.0 + 1.0e-12)
        small = max(small, radius - change * (1.0 + 1.0e-12))
        large = min(large, radius + change * (1.0 + 1.0e-12))
    elif one != two and length2 > 0.0:
        # Bound of the motion of the best point: dq/dx = (s R(a) + r (2 w - q s))/den.
        along = 0.0
        change = two - one
        p = (x, y, z)
        for k in range(3):
            along += (p[k] - parts[i, k]) * (parts[i, k + 3] - parts[i, k])
            away2 += (p[k] - parts[i, k]) ** 2
        length = np.sqrt(length2)
        den = length2 * one + along * change - abs(change) * length * off
        move = length
        if den > 0.0:
            step = (length * (one + abs(change)) + 2.0 * abs(change) * (np.sqrt(away2) + off)) / den * off
            move = min(length, length * step)
        off += move * (1.0 + 1.0e-12)
        small = max(small, radius - abs(change) * move / length * (1.0 + 1.0e-12))
        large = min(large, radius + abs(change) * move / length * (1.0 + 1.0e-12))
    return wx, wy, wz, off, nearest * nearest, farthest * farthest, small, large


@inlined
def clear_of(parts, i, scratch, p):
    """Whether the box in rows p..p+2 of scratch and the node at row i are disjoint."""
    return outside_node(
        parts, i, scratch[p, 0], scratch[p, 1], scratch[p + 1, 0], scratch[p + 1, 1], scratch[p + 2, 0],
        scratch[p + 2, 1],
    )  # fmt: skip


@inlined
def rival(parts, i, stop, scratch, p, x, y, z, diagonal):
    """The least upper bound of s over the box in row i's group; parts whose s stays above it never count."""
    group = parts[i + 1, part.GROUP]
    least = np.inf
    while i < stop and (parts[i + 1, part.SHAPE] == part.NODE or parts[i + 1, part.GROUP] == group):
        if parts[i + 1, part.SHAPE] == part.NODE:
            i += part.STRIDE + (int(parts[i, part.RADIUS]) if clear_of(parts, i, scratch, p) else 0)
            continue
        _, _, _, _, _, farthest, _, _ = range_of(parts, i, x, y, z, diagonal)
        least = min(least, farthest)
        i += part.STRIDE
    return least * (1.0 + 1.0e-12)


@inlined
def skeleton_box(parts, start, stop, scratch, p):
    """Interval of the density of the skeleton in rows start..stop-1 over the box in rows p..p+2 of scratch."""
    x, y, z, hx, hy, hz = box_of(scratch, p)
    diagonal = np.sqrt(hx * hx + hy * hy + hz * hz)
    low = high = bulk = 0.0
    least = most = weight = 0.0
    group = -1.0
    i = start
    while i < stop:
        if parts[i + 1, part.SHAPE] == part.NODE:
            i += part.STRIDE + (int(parts[i, part.RADIUS]) if clear_of(parts, i, scratch, p) else 0)
            continue
        _, _, _, _, nearest, farthest, _, _ = range_of(parts, i, x, y, z, diagonal)
        if nearest < 1.0:
            kernel = parts[i + 1, part.KERNEL]
            if parts[i + 1, part.GROUP] != group:
                group = parts[i + 1, part.GROUP]
                low += weight * (least if weight > 0.0 else most)
                high += weight * (most if weight > 0.0 else least)
                bulk += abs(weight) * most
                least = most = 0.0
                weight = parts[i, part.WEIGHT]
            least = max(least, falloff(kernel, farthest) - 8.0 * ULPS)
            most = max(most, falloff(kernel, nearest) + 8.0 * ULPS)
        i += part.STRIDE
    low += weight * (least if weight > 0.0 else most)
    high += weight * (most if weight > 0.0 else least)
    bulk += abs(weight) * most
    return low - 8.0 * ULPS * bulk, high + 8.0 * ULPS * bulk


@inlined
def skeleton_steepness(parts, start, stop, scratch, p):
    """Bounds (low, high by axis) of the gradient of ``skeleton_value`` over the box in rows p..p+2 of scratch.

    Within a group they hold the gradients of all parts that may win.
    """
    x, y, z, hx, hy, hz = box_of(scratch, p)
    diagonal = np.sqrt(hx * hx + hy * hy + hz * hz)
    a0 = a1 = b0 = b1 = c0 = c1 = 0.0
    # Bounds within the current group.
    x0 = x1 = y0 = y1 = z0 = z1 = 0.0
    group = limited = -1.0
    limit = np.inf
    fresh = True
    i = start
    while i < stop:
        if parts[i + 1, part.SHAPE] == part.NODE:
            i += part.STRIDE + (int(parts[i, part.RADIUS]) if clear_of(parts, i, scratch, p) else 0)
            continue
        wx, wy, wz, off, nearest, farthest, small, large = range_of(parts, i, x, y, z, diagonal)
        if parts[i + 1, part.GROUP] != limited:
            limited = parts[i + 1, part.GROUP]
            limit = rival(parts, i, stop, scratch, p, x, y, z, diagonal)
        if nearest < 1.0 and nearest <= limit:
            kernel = parts[i + 1, part.KERNEL]
            weight = parts[i, part.WEIGHT]
            steep = falloff_slope(kernel, nearest) * (1.0 + 1.0e-12) - 1.0e-14
            flat = min(falloff_slope(kernel, farthest) * (1.0 - 1.0e-12) + 1.0e-14, 0.0)
            scale = 2.0 * weight
            strong = steep / (small * small)
            weak = flat / (large * large)
            d0, d1 = scaled(strong, weak, scale, wx - off, wx + off)
            e0, e1 = scaled(strong, weak, scale, wy - off, wy + off)
            f0, f1 = scaled(strong, weak, scale, wz - off, wz + off)
            if parts[i + 1, part.GROUP] != group:
                group = parts[i + 1, part.GROUP]
                a0, a1, b0, b1, c0, c1 = a0 + x0, a1 + x1, b0 + y0, b1 + y1, c0 + z0, c1 + z1
                fresh = True
            if fresh:
                x0, x1, y0, y1, z0, z1 = d0, d1, e0, e1, f0, f1
                fresh = False
            else:
                x0, x1 = min(x0, d0), max(x1, d1)
                y0, y1 = min(y0, e0), max(y1, e1)
                z0, z1 = min(z0, f0), max(z1, f1)
        i += part.STRIDE
    return a0 + x0, a1 + x1, b0 + y0, b1 + y1, c0 + z0, c1 + z1


@inlined
def scaled(strong, weak, scale, low, high):
    """The interval [strong, weak] scale [low, high], where strong <= weak <= 0, widened for rounding."""
    p = strong * low
    q = strong * high
    r = weak * low
    s = weak * high
    least = min(min(p, q), min(r, s))
    most = max(max(p, q), max(r, s))
    if scale < 0.0:
        least, most = scale * most, scale * least
    else:
        least, most = scale * least, scale * most
    return least - 1.0e-12 * abs(least), most + 1.0e-12 * abs(most)


@inlined
def skeleton_near(parts, start, stop, scratch, p, near, found):
    """Copy the parts that may count in the box in rows p..p+2 of scratch to rows found.. of near; the next free row."""
    x, y, z, hx, hy, hz = box_of(scratch, p)
    diagonal = np.sqrt(hx * hx + hy * hy + hz * hz)
    group = -1.0
    limit = np.inf
    i = start
    while i < stop:
        if parts[i + 1, part.SHAPE] == part.NODE:
            i += part.STRIDE + (int(parts[i, part.RADIUS]) if clear_of(parts, i, scratch, p) else 0)
            continue
        _, _, _, _, nearest, _, _, _ = range_of(parts, i, x, y, z, diagonal)
        if parts[i + 1, part.GROUP] != group:
            group = parts[i + 1, part.GROUP]
            limit = rival(parts, i, stop, scratch, p, x, y, z, diagonal)
        if nearest < 1.0 and nearest <= limit:
            for j in range(8):
                near[found, j] = parts[i, j]
                near[found + 1, j] = parts[i + 1, j]
            found += part.STRIDE
        i += part.STRIDE
    return found
