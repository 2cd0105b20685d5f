# mypy: ignore-errors
"""First-order enclosures of density fields along a ray segment; see enclosure_kernels for what an enclosure claims."""

from sceneql.compiled.kernels import inlined, woven

PAD = 1.0e-15


@woven
def distance_squared(parts, i, p0, p1, scratch):
    """(d0, d1, d2, d3, blur): d^2 to part i lies in d0 + d1 tau + d2 tau^2 +- d3 for tau in [-1, 1].

    The point moves as c0 + c1 tau, rows p0..p0+2 of scratch. d^2 to a convex set is convex along a line with second
    derivative at most 2 |c1|^2 (2 p1), hence where the nearest feature changes it lies at most p1 under its chord.
    ``blur`` bounds the rounding of the distance vector.
    """
    ax = parts[i, 0]
    ay = parts[i, 1]
    az = parts[i, 2]
    wx = scratch[p0, 0] - ax
    wy = scratch[p0 + 1, 0] - ay
    wz = scratch[p0 + 2, 0] - az
    ux = scratch[p0, 1]
    uy = scratch[p0 + 1, 1]
    uz = scratch[p0 + 2, 1]
    sx = parts[i, 3] - ax
    sy = parts[i, 4] - ay
    sz = parts[i, 5] - az
    length2 = sx * sx + sy * sy + sz * sz
    blur = 0.0
    if length2 > 0.0:
        blur = PAD * (abs(wx) + abs(wy) + abs(wz) + abs(ux) + abs(uy) + abs(uz) + abs(sx) + abs(sy) + abs(sz))
        q0 = (wx * sx + wy * sy + wz * sz) / length2
        q1 = (ux * sx + uy * sy + uz * sz) / length2
        reach = abs(q1)
        if q0 - reach >= 1.0:
            wx -= sx
            wy -= sy
            wz -= sz
        elif q0 - reach >= 0.0 and q0 + reach <= 1.0:
            wx -= q0 * sx
            wy -= q0 * sy
            wz -= q0 * sz
            ux -= q1 * sx
            uy -= q1 * sy
            uz -= q1 * sz
        elif q0 + reach > 0.0:
            q = min(max(q0 - q1, 0.0), 1.0)
            vx = wx - ux - q * sx
            vy = wy - uy - q * sy
            vz = wz - uz - q * sz
            first = vx * vx + vy * vy + vz * vz
            q = min(max(q0 + q1, 0.0), 1.0)
            vx = wx + ux - q * sx
            vy = wy + uy - q * sy
            vz = wz + uz - q * sz
            second = vx * vx + vy * vy + vz * vz
            half_gap = 0.5 * p1
            return 0.5 * (first + second) - half_gap, 0.5 * (second - first), 0.0, half_gap, blur
    return wx * wx + wy * wy + wz * wz, 2.0 * (wx * ux + wy * uy + wz * uz), ux * ux + uy * uy + uz * uz, 0.0, blur


@inlined
def passes_by(parts, i, cx, cy, cz, ux, uy, uz, speed2, blur):
    """Whether the points c + u tau +- blur, tau in [-1, 1], are surely farther from point part i than its radius."""
    if parts[i, 0] != parts[i, 3] or parts[i, 1] != parts[i, 4] or parts[i, 2] != parts[i, 5]:
        return False
    wx = cx - parts[i, 0]
    wy = cy - parts[i, 1]
    wz = cz - parts[i, 2]
    square = wx * wx + wy * wy + wz * wz
    way = abs(wx * ux + wy * uy + wz * uz)
    radius = parts[i, 6] + 2.0 * blur
    least = radius * radius * (1.0 + 1.0e-9) + 1.0e-12 * (square + speed2)
    if way < speed2:
        return square * speed2 - way * way > least * speed2
    return square - 2.0 * way + speed2 > least


@inlined
def density_segment(parts, start, stop, scratch, k, base, p, survey):
    """(c0, c1, e) of the density of parts start..stop-1 at the point whose enclosures are rows p..p+2 of scratch.

    With ``survey`` all parts are tested, and those within reach copied to rows base.. of scratch (their number to
    scratch[k, 3]); later calls, for pieces of that segment, read only these.
    """
    point_blur = scratch[p, 2] + scratch[p + 1, 2] + scratch[p + 2, 2]
    ux = scratch[p, 1]
    uy = scratch[p + 1, 1]
    uz = scratch[p + 2, 1]
    speed2 = ux * ux + uy * uy + uz * uz
    b0 = b1 = b2 = b3 = b4 = b5 = b6 = 0.0
    e = 0.0
    found = 0
    table, first, last = parts, start, stop
    if not survey:
        table, first, last = scratch, base, base + int(scratch[k, 3])
    cx = scratch[p, 0]
    cy = scratch[p + 1, 0]
    cz = scratch[p + 2, 0]
    for i in range(first, last):
        if survey and passes_by(table, i, cx, cy, cz, ux, uy, uz, speed2, point_blur):
            continue
        d0, d1, d2, d3, blur = distance_squared(table, i, p, speed2, scratch)
        blur += point_blur
        radius = table[i, 6]
        inverse = 1.0 / (radius * radius)
        # |d - sqrt(D)| <= blur, and both densities vanish where sqrt(D) >= R + blur: hence this bound on |u - U|.
        error = (d3 + blur * (2.0 * radius + 3.0 * blur)) * inverse
        a0 = 1.0 - d0 * inverse
        a1 = -d1 * inverse
        a2 = -d2 * inverse
        bulk = 1.0 + abs(a0) + abs(a1) - a2
        error += PAD * bulk
        # u is concave: its maximum is at the vertex or at an end, its minimum at an end.
        top = a0 + a2 + abs(a1)
        if abs(a1) < -2.0 * a2:
            top = a0 - a1 * a1 / (4.0 * a2)
        top += error
        if not top > 0.0:
            continue
        if survey:
            for j in range(8):
                scratch[base + found, j] = parts[i, j]
            found += 1
        weight = table[i, 7]
        low = a0 + a2 - abs(a1) - error
        full = top * top * top
        # max(u, 0)^3 = u^3 + max(-u, 0)^3, the last in [0, |low|^3].
        under = -low * low * low if low < 0.0 else 0.0
        if under >= full:
            b0 += 0.5 * weight * full
            e += (0.5 + PAD) * abs(weight) * full
            continue
        # |u| <= top here, since -low < top.
        e += abs(weight) * (0.5 * under + 3.0 * top * top * error + PAD * bulk * bulk * bulk)
        square = a1 * a1
        product = a0 * a2
        b0 += weight * (a0 * a0 * a0 + 0.5 * under)
        b1 += weight * 3.0 * a0 * a0 * a1
        b2 += weight * 3.0 * a0 * (product + square)
        b3 += weight * a1 * (6.0 * product + square)
        b4 += weight * 3.0 * a2 * (product + square)
        b5 += weight * 3.0 * a1 * a2 * a2
        b6 += weight * a2 * a2 * a2
    if survey:
        scratch[k, 3] = found
    # With s = tau^2 in [0, 1]: s^2 - s in [-1/4, 0], s^3 - s in [-0.385, 0];
    # |tau^3 - 0.75 tau| <= 0.25 and |tau^5 - 0.675 tau| <= 0.33 on [-1, 1].
    even = b2 + b4 + b6
    c0 = b0 + 0.5 * even - 0.125 * b4 - 0.1925 * b6
    c1 = b1 + 0.75 * b3 + 0.675 * b5
    e += 0.5 * abs(even) + 0.125 * abs(b4) + 0.1925 * abs(b6) + 0.25 * abs(b3) + 0.33 * abs(b5)
    return c0, c1, e + PAD * (abs(b0) + abs(even) + abs(c1))
