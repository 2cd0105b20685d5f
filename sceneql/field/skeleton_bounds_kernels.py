# mypy: ignore-errors
"""Skeletons' densities over a box: bounds of the value and of the gradient, and which parts reach there.

The distance to a part changes no faster than the point moves, nor does the vector from a convex part's nearest point.
"""

import numpy as np

from sceneql.field.falloff_kernels import falloff, falloff_slope
from sceneql.field.skeleton_enclosure_kernels import CONDITION
from sceneql.field.skeleton_kernels import (
    GROUP,
    KERNEL,
    NODE,
    RADIUS,
    SHAPE,
    STRIDE,
    WEIGHT,
    outside_node,
    radius_at,
    to_part,
)
from sceneql.kernels import inlined

ULPS = 1.2e-15


@inlined
def box_of(scratch, p):
    """(center, half sides) of the box whose sides are rows p..p+2 of scratch."""
    hx = 0.5 * (scratch[p, 1] - scratch[p, 0])
    hy = 0.5 * (scratch[p + 1, 1] - scratch[p + 1, 0])
    hz = 0.5 * (scratch[p + 2, 1] - scratch[p + 2, 0])
    return scratch[p, 0] + hx, scratch[p + 1, 0] + hy, scratch[p + 2, 0] + hz, hx, hy, hz


@inlined
def range_of(parts, i, x, y, z, diagonal):
    """(vector from the part at row i, how far it may be off, least and most s = d^2/R^2, least R) in a ball of radius
    ``diagonal`` about a point."""
    wx, wy, wz, q = to_part(parts, i, x, y, z)
    size = abs(x) + abs(y) + abs(z)
    length2 = 0.0
    for k in range(3):
        size += abs(parts[i, k]) + abs(parts[i, k + 3]) + abs(parts[i + 1, k])
        length2 += (parts[i, k + 3] - parts[i, k]) ** 2
    off = diagonal * (1.0 + 1.0e-14) + 8.0 * ULPS * size * parts[i + 1, CONDITION]
    distance = np.sqrt(wx * wx + wy * wy + wz * wz)
    near = max(distance * (1.0 - ULPS) - off, 0.0)
    far = distance * (1.0 + ULPS) + off
    one = parts[i, RADIUS]
    two = radius_at(parts, i, 1.0)
    least = min(one, two)
    most = max(one, two)
    if most > least:
        reach = off / np.sqrt(length2) * (most - least) if length2 > 0.0 else 0.0
        radius = radius_at(parts, i, q)
        least = max(least, radius - reach - ULPS * most)
        most = min(most, radius + reach + ULPS * most)
    return (
        wx, wy, wz, off, near * near / (most * most) * (1.0 - 4.0 * ULPS),
        far * far / (least * least) * (1.0 + 4.0 * ULPS), least,
    )  # fmt: skip


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
        if parts[i + 1, SHAPE] == NODE:
            clear = outside_node(
                parts, i, scratch[p, 0], scratch[p, 1], scratch[p + 1, 0], scratch[p + 1, 1], scratch[p + 2, 0],
                scratch[p + 2, 1],
            )  # fmt: skip
            i += STRIDE + (int(parts[i, RADIUS]) if clear else 0)
            continue
        _, _, _, _, nearest, farthest, _ = range_of(parts, i, x, y, z, diagonal)
        if nearest < 1.0:
            kernel = parts[i + 1, KERNEL]
            if parts[i + 1, GROUP] != group:
                group = parts[i + 1, GROUP]
                low += weight * (least if weight > 0.0 else most)
                high += weight * (most if weight > 0.0 else least)
                bulk += abs(weight) * most
                least = most = 0.0
                weight = parts[i, WEIGHT]
            least = max(least, falloff(kernel, farthest) - 8.0 * ULPS)
            most = max(most, falloff(kernel, nearest) + 8.0 * ULPS)
        i += STRIDE
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
    # Of the group at hand.
    x0 = x1 = y0 = y1 = z0 = z1 = 0.0
    group = -1.0
    fresh = True
    i = start
    while i < stop:
        if parts[i + 1, SHAPE] == NODE:
            clear = outside_node(
                parts, i, scratch[p, 0], scratch[p, 1], scratch[p + 1, 0], scratch[p + 1, 1], scratch[p + 2, 0],
                scratch[p + 2, 1],
            )  # fmt: skip
            i += STRIDE + (int(parts[i, RADIUS]) if clear else 0)
            continue
        wx, wy, wz, off, nearest, farthest, radius = range_of(parts, i, x, y, z, diagonal)
        if nearest < 1.0:
            kernel = parts[i + 1, KERNEL]
            weight = parts[i, WEIGHT]
            steep = falloff_slope(kernel, nearest) * (1.0 + 1.0e-12) - 1.0e-14
            flat = min(falloff_slope(kernel, farthest) * (1.0 - 1.0e-12) + 1.0e-14, 0.0)
            scale = 2.0 * weight
            most = max(parts[i, RADIUS], radius_at(parts, i, 1.0))
            strong = steep / (radius * radius)
            weak = flat / (most * most)
            rest = 0.0
            if most > radius or radius_at(parts, i, 0.0) != radius_at(parts, i, 1.0):
                length2 = 0.0
                for k in range(3):
                    length2 += (parts[i, k + 3] - parts[i, k]) ** 2
                if length2 > 0.0:
                    change = abs(radius_at(parts, i, 1.0) - parts[i, RADIUS]) / np.sqrt(length2)
                    rest = -scale * steep * min(farthest, 1.0) / radius * change
                    rest = abs(rest) * (1.0 + 1.0e-12)
            d0, d1 = scaled(strong, weak, scale, wx - off, wx + off)
            e0, e1 = scaled(strong, weak, scale, wy - off, wy + off)
            f0, f1 = scaled(strong, weak, scale, wz - off, wz + off)
            if parts[i + 1, GROUP] != group:
                group = parts[i + 1, GROUP]
                a0, a1, b0, b1, c0, c1 = a0 + x0, a1 + x1, b0 + y0, b1 + y1, c0 + z0, c1 + z1
                fresh = True
            if fresh:
                x0, x1, y0, y1, z0, z1 = d0 - rest, d1 + rest, e0 - rest, e1 + rest, f0 - rest, f1 + rest
                fresh = False
            else:
                x0, x1 = min(x0, d0 - rest), max(x1, d1 + rest)
                y0, y1 = min(y0, e0 - rest), max(y1, e1 + rest)
                z0, z1 = min(z0, f0 - rest), max(z1, f1 + rest)
        i += STRIDE
    return a0 + x0, a1 + x1, b0 + y0, b1 + y1, c0 + z0, c1 + z1


@inlined
def scaled(strong, weak, scale, low, high):
    """[strong, weak] scale [low, high], strong <= weak <= 0, a little wider."""
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
    """Copy the parts within reach of the box in rows p..p+2 of scratch to rows found.. of near; the row behind them."""
    x, y, z, hx, hy, hz = box_of(scratch, p)
    diagonal = np.sqrt(hx * hx + hy * hy + hz * hz)
    i = start
    while i < stop:
        if parts[i + 1, SHAPE] == NODE:
            clear = outside_node(
                parts, i, scratch[p, 0], scratch[p, 1], scratch[p + 1, 0], scratch[p + 1, 1], scratch[p + 2, 0],
                scratch[p + 2, 1],
            )  # fmt: skip
            i += STRIDE + (int(parts[i, RADIUS]) if clear else 0)
            continue
        _, _, _, _, nearest, _, _ = range_of(parts, i, x, y, z, diagonal)
        if nearest < 1.0:
            for j in range(8):
                near[found, j] = parts[i, j]
                near[found + 1, j] = parts[i + 1, j]
            found += STRIDE
        i += STRIDE
    return found
