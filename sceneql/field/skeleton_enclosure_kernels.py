# mypy: ignore-errors
"""First-order enclosures of skeletons' densities along a ray segment; see enclosure_kernels for what one claims.

Nothing here knows a kernel or a shape: a squared distance to a convex set is convex along a line, with a second
derivative of at most twice the square of the speed, and every kernel is convex in it.
"""

import numpy as np

from sceneql.field.falloff_kernels import falloff, falloff_slope
from sceneql.field.forms_kernels import PAD, TINY, larger_of, product
from sceneql.field.skeleton_kernels import GROUP, KERNEL, NODE, RADIUS, SHAPE, STRIDE, WEIGHT, radius_at, to_part
from sceneql.kernels import inlined

CONDITION = 7
"""Column of a part's second row: how much more than a segment's a triangle's distance suffers from rounding."""


@inlined
def segment_outside(parts, i, cx, cy, cz, ux, uy, uz, blur):
    """Whether the points c + u tau +- blur, tau in [-1, 1], miss the box of the node at row i (Ericson 2005, 5.3.3)."""
    ex = 0.5 * (parts[i, 3] - parts[i, 0]) + blur
    ey = 0.5 * (parts[i, 4] - parts[i, 1]) + blur
    ez = 0.5 * (parts[i, 5] - parts[i, 2]) + blur
    mx = cx - 0.5 * (parts[i, 3] + parts[i, 0])
    my = cy - 0.5 * (parts[i, 4] + parts[i, 1])
    mz = cz - 0.5 * (parts[i, 5] + parts[i, 2])
    ax = abs(ux)
    ay = abs(uy)
    az = abs(uz)
    if abs(mx) > ex + ax or abs(my) > ey + ay or abs(mz) > ez + az:
        return True
    slack = 1.0e-12 * (abs(mx) + abs(my) + abs(mz) + ex + ey + ez) * (ax + ay + az)
    return (
        abs(my * uz - mz * uy) > ey * az + ez * ay + slack
        or abs(mz * ux - mx * uz) > ex * az + ez * ax + slack
        or abs(mx * uy - my * ux) > ex * ay + ey * ax + slack
    )


@inlined
def inverse_square(low, high, r0, r1, er):
    """Enclosure of 1/R^2 for an R = r0 + r1 tau +- er in low..high, low > 0."""
    middle = 0.5 * (low + high)
    g = 1.0 / (middle * middle)
    slope = -2.0 * g / middle
    half = 0.5 * (high - low)
    gap = max(1.0 / (low * low) - (g - slope * half), 1.0 / (high * high) - (g + slope * half), 0.0)
    e = abs(slope) * er + 0.5 * gap
    return g + slope * (r0 - middle) + 0.5 * gap, slope * r1, e + 4.0 * PAD * (abs(slope) * (middle + abs(r0)) + g)


@inlined
def part_segment(table, i, cx, cy, cz, ux, uy, uz, speed2, point_blur):
    """(least s, s0, s1, e): s = d^2/R^2 of the part at row i lies in s0 + s1 tau +- e at the point c + u tau."""
    ax, ay, az, first = to_part(table, i, cx - ux, cy - uy, cz - uz)
    bx, by, bz, second = to_part(table, i, cx + ux, cy + uy, cz + uz)
    size = abs(cx) + abs(cy) + abs(cz) + abs(ux) + abs(uy) + abs(uz)
    length = 0.0
    for k in range(3):
        size += abs(table[i, k]) + abs(table[i, k + 3]) + abs(table[i + 1, k])
        length += abs(table[i, k + 3] - table[i, k])
    blur = point_blur + 8.0 * PAD * size * table[i + 1, CONDITION]
    low = ax * ax + ay * ay + az * az
    high = bx * bx + by * by + bz * bz
    top = max(low, high)
    error = blur * (2.0 * np.sqrt(top) + 3.0 * blur) + 4.0 * PAD * top
    mean = 0.5 * (low + high)
    slope = 0.5 * (high - low)
    least = min(low, high)
    if abs(slope) < 2.0 * speed2:
        least = mean - speed2 - slope * slope / (4.0 * speed2)
    least = max(least - error - 8.0 * PAD * (mean + speed2), 0.0)
    d0 = mean - 0.5 * speed2
    ed = 0.5 * speed2 + error + 4.0 * PAD * (mean + speed2)
    one = table[i, RADIUS]
    two = radius_at(table, i, 1.0)
    if one == two:
        inverse = 1.0 / (one * one)
        return least * inverse * (1.0 - 4.0 * PAD), d0 * inverse, slope * inverse, ed * inverse * (1.0 + 4.0 * PAD)
    start = radius_at(table, i, first)
    end = radius_at(table, i, second)
    most = max(one, two)
    er = 8.0 * PAD * most
    if length > 0.0:
        er += min(2.0 * blur / length, 1.0) * abs(two - one)
    if not (first > 0.0 and first < 1.0 and second > 0.0 and second < 1.0):
        er += abs(end - start)  # a monotone R stays between its ends, however it gets from one to the other
    near = max(min(start, end) - er, min(one, two) * (1.0 - 4.0 * PAD))
    far = min(max(start, end) + er, most * (1.0 + 4.0 * PAD))
    g0, g1, eg = inverse_square(near, far, 0.5 * (start + end), 0.5 * (end - start), er)
    s0, s1, e = product(d0, slope, ed, g0, g1, eg)
    return least / (far * far) * (1.0 - 8.0 * PAD), s0, s1, e


@inlined
def fallen(kind, least, s0, s1, es):
    """Enclosure of K(s) for s = s0 + s1 tau +- es, s >= least: the tangent in the middle of the range, or the hull."""
    low = max(s0 - abs(s1) - es, least)
    high = max(s0 + abs(s1) + es, low)
    at_low = falloff(kind, low)
    at_high = falloff(kind, high)
    middle = 0.5 * (low + high)
    value = falloff(kind, middle)
    slope = falloff_slope(kind, middle)
    half = 0.5 * (high - low)
    gap = max(at_low - (value - slope * half), at_high - (value + slope * half), 0.0)
    e = 0.5 * gap - slope * es
    if e >= 0.5 * (at_low - at_high):
        return 0.5 * (at_low + at_high), 0.0, 0.5 * (at_low - at_high) + 16.0 * PAD
    c1 = slope * s1
    return value + slope * (s0 - middle) + 0.5 * gap, c1, e + PAD * (16.0 - 8.0 * slope * (abs(s0) + middle + half))


@inlined
def skeleton_segment(parts, start, stop, scratch, k, base, p, survey):
    """(c0, c1, e) of the density of the skeleton in rows start..stop-1 at the point enclosed in rows p..p+2 of scratch.

    A survey goes down the hierarchy and copies the parts within reach to rows base.. of scratch (the number of rows to
    scratch[k, 3]); later calls, on pieces of the surveyed segment, look only at those.
    """
    cx = scratch[p, 0]
    cy = scratch[p + 1, 0]
    cz = scratch[p + 2, 0]
    ux = scratch[p, 1]
    uy = scratch[p + 1, 1]
    uz = scratch[p + 2, 1]
    point_blur = scratch[p, 2] + scratch[p + 1, 2] + scratch[p + 2, 2]
    speed2 = (ux * ux + uy * uy + uz * uz) * (1.0 + 4.0 * PAD) + TINY
    table, i, last = parts, start, stop
    if not survey:
        table, i, last = scratch, base, base + int(scratch[k, 3])
    found = 0
    c0 = c1 = e = 0.0
    m0 = m1 = em = weight = 0.0
    group = -1.0
    while i < last:
        if table[i + 1, SHAPE] == NODE:
            i += STRIDE + (
                int(table[i, RADIUS]) if segment_outside(table, i, cx, cy, cz, ux, uy, uz, point_blur) else 0
            )
            continue
        least, s0, s1, es = part_segment(table, i, cx, cy, cz, ux, uy, uz, speed2, point_blur)
        if least < 1.0:
            if survey:
                for j in range(8):
                    scratch[base + found, j] = parts[i, j]
                    scratch[base + found + 1, j] = parts[i + 1, j]
                found += STRIDE
            f0, f1, ef = fallen(table[i + 1, KERNEL], least, s0, s1, es)
            if table[i + 1, GROUP] == group:
                m0, m1, em = larger_of(m0, m1, em, f0, f1, ef)
            else:
                c0 += weight * m0
                c1 += weight * m1
                e += abs(weight) * em + PAD * (abs(c0) + abs(c1))
                group = table[i + 1, GROUP]
                m0, m1, em, weight = f0, f1, ef, table[i, WEIGHT]
        i += STRIDE
    if survey:
        scratch[k, 3] = found
    c0 += weight * m0
    c1 += weight * m1
    return c0, c1, e + abs(weight) * em + 4.0 * PAD * (abs(c0) + abs(c1))
