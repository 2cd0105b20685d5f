# mypy: ignore-errors
"""A ray's crossing with one item: the first behind `near`, whether it enters or leaves."""

import numpy as np

from renderers.tracing.scene_kernels import part

NONE = np.inf
EDGE = 1e-9
"""Part of a triangle by which a ray may pass beside it: rounding of rays from a million of its sizes away."""


@part
def box_span(low, high, origin, inverse):
    """(enter, leave) of a slab along one axis."""
    a = (low - origin) * inverse
    b = (high - origin) * inverse
    return min(a, b), max(a, b)


@part
def inverse(d):
    """1/d, finite for d = 0, so that no 0 * inf arises."""
    return 1.0 / d if abs(d) > 1e-300 else 1e300


@part
def roots(a, b, c):
    """The interval where a t^2 + b t + c <= 0 for a >= 0, empty as (1, 0); by the stable formula."""
    if a > 1e-14 * abs(b):
        rest = b * b - 4.0 * a * c
        if rest <= 0.0:
            return 1.0, 0.0
        q = -0.5 * (b + np.copysign(np.sqrt(rest), b))
        if q == 0.0:
            return 1.0, 0.0
        return min(q / a, c / q), max(q / a, c / q)
    if b > 0.0:
        return -np.inf, -c / b
    if b < 0.0:
        return -c / b, np.inf
    return (-np.inf, np.inf) if c <= 0.0 else (1.0, 0.0)


@part
def crossing(enter, leave, near, far):
    """First end of an interval inside (near, far), or infinity."""
    if enter >= leave:
        return NONE
    if near < enter < far:
        return enter
    if enter <= near < leave < far:
        return leave
    return NONE


@part
def local_point(map, k, x, y, z, w):
    """A point (w = 1) or direction (w = 0) in the local coordinates of quadric k."""
    return (
        map[k] * x + map[k + 1] * y + map[k + 2] * z + map[k + 3] * w,
        map[k + 4] * x + map[k + 5] * y + map[k + 6] * z + map[k + 7] * w,
        map[k + 8] * x + map[k + 9] * y + map[k + 10] * z + map[k + 11] * w,
    )


@part
def along_ray(q, k, o, d):
    """(a, b, c) of the quadratic a t^2 + b t + c that quadric k is along a ray in its local coordinates."""
    a = 0.0
    b = 0.0
    c = q[k + 18]
    for axis in range(3):
        s = q[k + 12 + axis]
        l = q[k + 15 + axis]
        a += s * d[axis] * d[axis]
        b += (2.0 * s * o[axis] + l) * d[axis]
        c += (s * o[axis] + l) * o[axis]
    return a, b, c


@part
def quadric(q, k, ox, oy, oz, dx, dy, dz, near, far):
    """Crossing of a convex quadric solid clipped by its local box."""
    o = local_point(q, k, ox, oy, oz, 1.0)
    d = local_point(q, k, dx, dy, dz, 0.0)
    a, b, c = along_ray(q, k, o, d)
    begin = 0.0
    if a > 1e-14 * abs(b):  # from the middle between the roots: see round_span
        begin = -0.5 * b / a
        a, b, c = along_ray(q, k, (o[0] + begin * d[0], o[1] + begin * d[1], o[2] + begin * d[2]), d)
    enter, leave = roots(a, b, c)
    enter, leave = begin + enter, begin + leave
    for axis in range(3):
        e, f = box_span(q[k + 19 + axis], q[k + 22 + axis], o[axis], inverse(d[axis]))
        enter = max(enter, e)
        leave = min(leave, f)
    return crossing(enter, leave, near, far)


@part
def half_space(h, k, ox, oy, oz, dx, dy, dz, near, far):
    """Crossing of the face of a half-space."""
    slope = h[k] * dx + h[k + 1] * dy + h[k + 2] * dz
    if slope == 0.0:
        return NONE
    t = (h[k + 3] - h[k] * ox - h[k + 1] * oy - h[k + 2] * oz) / slope
    return t if near < t < far else NONE


@part
def round_solid(r, k, ox, oy, oz, dx, dy, dz, near, far):
    """Crossing of a capsule (or sphere, where its axis is zero)."""
    enter, leave = round_span(r, k, r[k + 6] * r[k + 6], ox, oy, oz, dx, dy, dz)
    return crossing(enter, leave, near, far)


@part
def round_span(r, k, radius2, ox, oy, oz, dx, dy, dz):
    """Interval in a capsule of a squared radius, the hull of two balls and the tube between them; or leave < enter."""
    ux = r[k + 3]
    uy = r[k + 4]
    uz = r[k + 5]
    px = ox - r[k]
    py = oy - r[k + 1]
    pz = oz - r[k + 2]
    over_dd = 1.0 / (dx * dx + dy * dy + dz * dz)
    # From where the ray passes the first end: in squares of the way from a far origin, a small radius' would drown.
    begin = -(px * dx + py * dy + pz * dz) * over_dd
    px, py, pz = px + begin * dx, py + begin * dy, pz + begin * dz
    enter, leave = ball(0.0, radius2 - (px * px + py * py + pz * pz), over_dd)
    uu = ux * ux + uy * uy + uz * uz
    if uu > 0.0:
        ud = ux * dx + uy * dy + uz * dz
        past = ud * over_dd
        qx, qy, qz = px - ux + past * dx, py - uy + past * dy, pz - uz + past * dz
        e, f = ball(past, radius2 - (qx * qx + qy * qy + qz * qz), over_dd)
        if e < f:
            enter = e if e < enter else enter
            leave = f if f > leave else leave
        # Across the axis: in squares of the length of a thin line the radius' would drown as well.
        pu = (px * ux + py * uy + pz * uz) / uu
        du = ud / uu
        wx, wy, wz = px - pu * ux, py - pu * uy, pz - pu * uz
        vx, vy, vz = dx - du * ux, dy - du * uy, dz - du * uz
        a, b = vx * vx + vy * vy + vz * vz, 2.0 * (vx * wx + vy * wy + vz * wz)
        e, f = roots(a, b, wx * wx + wy * wy + wz * wz - radius2)
        if e < f:
            # The ends of the tube lie inside the balls, so only its round side can extend the span.
            if 0.0 <= pu + e * du <= 1.0:
                enter = e if e < enter else enter
                leave = e if e > leave else leave
            if 0.0 <= pu + f * du <= 1.0:
                enter = f if f < enter else enter
                leave = f if f > leave else leave
    return begin + enter, begin + leave


@part
def ball(t, rest, over_dd):
    """Interval inside a ball that the ray is nearest to at t: ``rest`` of its squared radius less that distance's."""
    if rest <= 0.0:
        return np.inf, -np.inf
    half = np.sqrt(rest * over_dd)
    return t - half, t + half


@part
def triangle(m, k, ox, oy, oz, dx, dy, dz, near, far):
    """Crossing of a triangle, either side (Moeller and Trumbore 1997); by EDGE beyond its edges, too.

    Rounding is not the same in two triangles with a common edge: a ray through that edge would miss both.
    """
    ax = m[k + 3]
    ay = m[k + 4]
    az = m[k + 5]
    bx = m[k + 6]
    by = m[k + 7]
    bz = m[k + 8]
    px = dy * bz - dz * by
    py = dz * bx - dx * bz
    pz = dx * by - dy * bx
    volume = ax * px + ay * py + az * pz
    if volume == 0.0:
        return NONE
    sx = ox - m[k]
    sy = oy - m[k + 1]
    sz = oz - m[k + 2]
    u = (sx * px + sy * py + sz * pz) / volume
    if u < -EDGE or u > 1.0 + EDGE:
        return NONE
    qx = sy * az - sz * ay
    qy = sz * ax - sx * az
    qz = sx * ay - sy * ax
    v = (dx * qx + dy * qy + dz * qz) / volume
    if v < -EDGE or u + v > 1.0 + EDGE:
        return NONE
    t = (bx * qx + by * qy + bz * qz) / volume
    return t if near < t < far else NONE
