# mypy: ignore-errors
"""First-order enclosures of skeletons' densities along a ray segment; see enclosure_kernels for what one claims.

No kernel or shape has a case of its own: enough are bounds of the curvature of s along a line, and that every kernel is
convex in s.
"""

import numpy as np

from sceneql.compiled.kernels import inlined
from sceneql.field.enclose.forms_kernels import PAD, TINY, larger_of
from sceneql.field.skeleton import skeleton_parts_kernels as part
from sceneql.field.skeleton.falloff_kernels import falloff, falloff_slope
from sceneql.field.skeleton.skeleton_kernels import radius_at, to_part

LISTED, LISTED_FROM, LISTED_TO = 4, 5, 6
"""Columns of a skeleton's row: how many rows are listed behind those of the surveyed parts, and for which interval
along the line, from and to."""


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
def rounding(table, i, cx, cy, cz, ux, uy, uz):
    """Bound of the error of the computed vector to the part at row i, for points c + u tau."""
    size = abs(cx) + abs(cy) + abs(cz) + abs(ux) + abs(uy) + abs(uz)
    for k in range(3):
        size += abs(table[i, k]) + abs(table[i, k + 3]) + abs(table[i + 1, k])
    return 8.0 * PAD * size * part.condition(table, i)


@inlined
def span_of(table, i, cx, cy, cz, half, blur):
    """(least, most) r = sqrt(s) of the part at row i within ``half`` of a point: r has the Lipschitz constant 1/R."""
    wx, wy, wz, q = to_part(table, i, cx, cy, cz)
    r = np.sqrt(wx * wx + wy * wy + wz * wz)
    radius = radius_at(table, i, q)
    way = (half + blur) * (1.0 + 8.0 * PAD)
    least = r / radius * (1.0 - 8.0 * PAD) - way / part.least_radius(table, i)
    return least, (r + way) / radius * (1.0 + 8.0 * PAD)


@inlined
def part_segment(table, i, cx, cy, cz, ux, uy, uz, speed2, point_blur):
    """(least s, s0, s1, e): s of the part at row i lies in s0 + s1 tau +- e at the point c + u tau.

    s is the minimum of parabolas, each of second derivative at most k = 2 |u|^2/R^2: it lies above its chord less k/2
    (1 - tau^2), and below its tangent in the middle plus k/2 tau^2. Where it is also convex, it lies below its chord.
    """
    ax, ay, az, first = to_part(table, i, cx - ux, cy - uy, cz - uz)
    bx, by, bz, second = to_part(table, i, cx + ux, cy + uy, cz + uz)
    blur = point_blur + rounding(table, i, cx, cy, cz, ux, uy, uz)
    one = radius_at(table, i, first)
    two = radius_at(table, i, second)
    low = (ax * ax + ay * ay + az * az) / (one * one)
    high = (bx * bx + by * by + bz * bz) / (two * two)
    small = part.least_radius(table, i)
    steep = speed2 / (small * small) * (1.0 + 8.0 * PAD)
    mean = 0.5 * (low + high)
    slope = 0.5 * (high - low)
    least = min(low, high)
    if abs(slope) < 2.0 * steep:
        least = mean - steep - slope * slope / (4.0 * steep)
    bottom = mean - steep
    top = mean
    if not part.convex(table, i):
        wx, wy, wz, q = to_part(table, i, cx, cy, cz)
        radius = radius_at(table, i, q)
        inverse = 1.0 / (radius * radius)
        tangent = 2.0 * inverse * (wx * ux + wy * uy + wz * uz)
        top = inverse * (wx * wx + wy * wy + wz * wz) + abs(tangent - slope) + steep
    reach = np.sqrt(max(max(low, high), top))
    error = blur / small * (4.0 * reach + 4.0 * blur / small) + 16.0 * PAD * (reach * reach + steep)
    return max(least - error, 0.0), 0.5 * (bottom + top), slope, 0.5 * (top - bottom) + error


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
def passes_by(parts, i, cx, cy, cz, ux, uy, uz, speed2, blur):
    """Whether the points c + u tau +- blur, tau in [-1, 1], surely miss a ball around segment or curve i's reach."""
    wx = cx - 0.5 * (parts[i, 0] + parts[i, 3])
    wy = cy - 0.5 * (parts[i, 1] + parts[i, 4])
    wz = cz - 0.5 * (parts[i, 2] + parts[i, 5])
    sx = parts[i, 3] - parts[i, 0]
    sy = parts[i, 4] - parts[i, 1]
    sz = parts[i, 5] - parts[i, 2]
    square = wx * wx + wy * wy + wz * wz
    way = abs(wx * ux + wy * uy + wz * uz)
    half2 = 0.25 * (sx * sx + sy * sy + sz * sz)
    if parts[i + 1, part.SHAPE] == part.CURVE:
        sx = parts[i + 1, 0] - 0.5 * (parts[i, 0] + parts[i, 3])
        sy = parts[i + 1, 1] - 0.5 * (parts[i, 1] + parts[i, 4])
        sz = parts[i + 1, 2] - 0.5 * (parts[i, 2] + parts[i, 5])
        half2 = max(half2, sx * sx + sy * sy + sz * sz)
    reach = np.sqrt(half2) + part.largest_radius(parts, i) + 2.0 * blur
    least = reach * reach * (1.0 + 1.0e-9) + 1.0e-12 * (square + speed2)
    if way < speed2:
        return square * speed2 - way * way > least * speed2
    return square - 2.0 * way + speed2 > least


@inlined
def within_reach(parts, start, stop, scratch, base, cx, cy, cz, ux, uy, uz, speed2, point_blur):
    """Copy the parts within reach of the points c + u tau +- blur to rows base.. of scratch; how many rows."""
    found = 0
    i = start
    while i < stop:
        if parts[i + 1, part.SHAPE] == part.NODE:
            clear = segment_outside(parts, i, cx, cy, cz, ux, uy, uz, point_blur)
            i += part.STRIDE + (int(parts[i, part.RADIUS]) if clear else 0)
            continue
        thin = parts[i + 1, part.SHAPE] == part.SEGMENT or parts[i + 1, part.SHAPE] == part.CURVE
        if thin and passes_by(parts, i, cx, cy, cz, ux, uy, uz, speed2, point_blur):
            i += part.STRIDE
            continue
        least, _, _, _ = part_segment(parts, i, cx, cy, cz, ux, uy, uz, speed2, point_blur)
        if least < 1.0:
            for j in range(8):
                scratch[base + found, j] = parts[i, j]
                scratch[base + found + 1, j] = parts[i + 1, j]
            found += part.STRIDE
        i += part.STRIDE
    return found


@inlined
def skeleton_segment(parts, start, stop, scratch, k, base, p, survey):
    """(c0, c1, e) of the density of the skeleton in rows start..stop-1 at the point enclosed in rows p..p+2 of scratch.

    With ``survey`` the hierarchy is traversed, and the parts that may count are copied to rows base.. of scratch (their
    number to scratch[k, 3]); later calls, for pieces of that segment, read only these. Of these the parts that count in
    the segment of the call are listed behind them, where there is room, for calls on pieces of it.
    """
    cx = scratch[p, 0]
    cy = scratch[p + 1, 0]
    cz = scratch[p + 2, 0]
    ux = scratch[p, 1]
    uy = scratch[p + 1, 1]
    uz = scratch[p + 2, 1]
    point_blur = scratch[p, 2] + scratch[p + 1, 2] + scratch[p + 2, 2]
    speed2 = (ux * ux + uy * uy + uz * uz) * (1.0 + 4.0 * PAD) + TINY
    if survey:
        scratch[k, 3] = within_reach(parts, start, stop, scratch, base, cx, cy, cz, ux, uy, uz, speed2, point_blur)
        scratch[k, LISTED_TO] = -np.inf
    half = np.sqrt(speed2)
    here = (cx * ux + cy * uy + cz * uz) / half
    i = base
    last = base + int(scratch[k, 3])
    place = base if survey else last
    if here - half >= scratch[k, LISTED_FROM] - point_blur and here + half <= scratch[k, LISTED_TO] + point_blur:
        i, last = last, last + int(scratch[k, LISTED])
    listing = survey or 2 * int(scratch[k, 3]) <= stop - start
    found = 0
    c0 = c1 = e = 0.0
    while i < last:
        group = scratch[i + 1, part.GROUP]
        weight = scratch[i, part.WEIGHT]
        end = i
        rival = np.inf  # least upper bound of r in the group: parts that stay farther never have the largest density
        while end < last and scratch[end + 1, part.GROUP] == group:
            if end > i or (end + part.STRIDE < last and scratch[end + part.STRIDE + 1, part.GROUP] == group):
                blur = point_blur + rounding(scratch, end, cx, cy, cz, ux, uy, uz)
                _, most = span_of(scratch, end, cx, cy, cz, half, blur)
                rival = min(rival, most)
            end += part.STRIDE
        m0 = m1 = em = 0.0
        alone = True
        while i < end:
            near = True
            if rival < np.inf:
                blur = point_blur + rounding(scratch, i, cx, cy, cz, ux, uy, uz)
                nearest, _ = span_of(scratch, i, cx, cy, cz, half, blur)
                near = nearest <= rival
            if near:
                least, s0, s1, es = part_segment(scratch, i, cx, cy, cz, ux, uy, uz, speed2, point_blur)
                if listing:
                    for j in range(8):
                        scratch[place + found, j] = scratch[i, j]
                        scratch[place + found + 1, j] = scratch[i + 1, j]
                    found += part.STRIDE
                if least < 1.0:
                    f0, f1, ef = fallen(scratch[i + 1, part.KERNEL], least, s0, s1, es)
                    if alone:
                        m0, m1, em = f0, f1, ef
                    else:
                        m0, m1, em = larger_of(m0, m1, em, f0, f1, ef)
                    alone = False
            i += part.STRIDE
        c0 += weight * m0
        c1 += weight * m1
        e += abs(weight) * em + PAD * (abs(c0) + abs(c1))
    if survey:
        scratch[k, 3] = found
    elif listing:
        scratch[k, LISTED], scratch[k, LISTED_FROM], scratch[k, LISTED_TO] = found, here - half, here + half
    return c0, c1, e + 4.0 * PAD * (abs(c0) + abs(c1))
