# mypy: ignore-errors
"""Skins: shapes as points of their surfaces and as the distance of any point, for those that are curved or not convex.

What touches is a point of one skin in the field of the other. A point of a smooth surface slides on it to where the two
surfaces face each other, a point of an edge along the edge, so that gaps are exact though the points are some way
apart. What is smaller than the points' distance, on both, is not seen.
"""

import math

from numba import types

from sceneql.bodies.rigid.rigid_kernels import to_body, to_world
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.distance.core_kernels import at3, cross, dot, put3
from sceneql.contacts.shape_kernels import FOUR, surface
from sceneql.system.signatures_kernels import A, F, I, N

FIELD_AT, CENTER_AT, POSE_AT, SIZES_AT, EDGES_AT, SMOOTH_AT, SKIN = 0, 1, 2, 3, 4, 8, 12
"""Integers of a skin: where its object's integers stand (contacts/layout.py); offsets of the body's center in the
object's axes, of the object's place, which is written here, and of its sizes; two trees of its points, of those of
edges and corners and of those of its smooth surface."""
BOXES, LINKS, NODES, POINTS = range(4)
"""Integers of a tree: offset of its boxes (nodes, 6), where its links (nodes, 3) stand, number of nodes, offset of its
points."""
LOW, HIGH, SPACING, THICKNESS, SIZES = 0, 3, 6, 7, 8
"""Its sizes: a box around it from the body's center, distance of its points, how thick it is [m]."""
AT_NORMAL, AT_ALONG, AT_BEND, RECORD = 3, 6, 9, 12
"""Numbers of a point, in the body's axes from its center: where it is; the normal outwards; on an edge, a vector along
it up to half way to the next point, and where the edge is bent the vector from its center of curvature (else 0)."""
FOUND = 10
"""Numbers of what is found: a point of a, one of b, the gap, the normal from b to a."""
MOST_FOUND = 600
"""Room for points that are found."""
HERE, AWAY, LOST = range(3)
"""Whether a least gap is found where it is looked for, is out of reach from there, or is not to be found."""
SLIDES = 8
"""Most steps of Newton's method along a surface."""
NEARLY = 1e-13
"""Sine of the angle between two surfaces up to which they face each other."""
FLAT = 1e-6
"""Turn of two surfaces' normals against each other [rad], over the way that a point may slide, that counts as none."""
APART = 1e-3
"""Distance of points for the derivatives of normals, in parts of the skin's spacing."""


@lean(types.void(A, I, N, A, N), inner=True)
def set_pose(floats, ints, skin, places, at):
    """Write where the object of a skin is whose body is at places[at:]."""
    pose, center = ints[skin + POSE_AT], ints[skin + CENTER_AT]
    for c in range(4):
        floats[pose + 3 + c] = places[at + 3 + c]
    x, y, z = to_world(places, at + 3, *at3(floats, center))
    put3(floats, pose, places[at] - x, places[at + 1] - y, places[at + 2] - z)


@lean(FOUR(A, I, N, F, F, F))
def field(floats, ints, skin, x, y, z):
    """Signed distance of a point from the surface of a skin, and the normal there."""
    return surface(floats, ints, ints[skin + FIELD_AT], x, y, z)


@lean_inlined
def across(nx, ny, nz):
    """Two unit vectors across a unit vector."""
    ax, ay, az = abs(nx), abs(ny), abs(nz)
    if ax <= ay and ax <= az:
        ux, uy, uz = cross(nx, ny, nz, 1.0, 0.0, 0.0)
    elif ay <= az:
        ux, uy, uz = cross(nx, ny, nz, 0.0, 1.0, 0.0)
    else:
        ux, uy, uz = cross(nx, ny, nz, 0.0, 0.0, 1.0)
    size = 1.0 / math.sqrt(dot(ux, uy, uz, ux, uy, uz))
    ux, uy, uz = ux * size, uy * size, uz * size
    vx, vy, vz = cross(nx, ny, nz, ux, uy, uz)
    return ux, uy, uz, vx, vy, vz


@lean(types.UniTuple(F, 3)(A, I, N, N, F, F, F), inner=True)
def facing(floats, ints, one, other, x, y, z):
    """The sum of the normals of two surfaces: 0 where they face each other."""
    _, a, b, c = field(floats, ints, one, x, y, z)
    _, p, q, r = field(floats, ints, other, x, y, z)
    return a + p, b + q, c + r


@lean(types.Tuple((N, F, F, F))(A, I, N, N, F, F, F, F), inner=True)
def slid(floats, ints, one, other, x, y, z, most):
    """Where the surface of ``one`` near a point is nearest to ``other``, no farther away than ``most`` [m]; whether
    that is HERE, AWAY from here, or LOST."""
    spacing = floats[ints[one + SIZES_AT] + SPACING]
    apart = APART * spacing
    sx, sy, sz = x, y, z
    for _ in range(SLIDES):
        d, nx, ny, nz = field(floats, ints, one, x, y, z)
        x, y, z = x - d * nx, y - d * ny, z - d * nz
        # The normal of a foot is that of the point.
        a, b, c = nx, ny, nz
        ux, uy, uz, vx, vy, vz = across(a, b, c)
        _, p, q, r = field(floats, ints, other, x, y, z)
        gu, gv = dot(p, q, r, ux, uy, uz), dot(p, q, r, vx, vy, vz)
        opposed = dot(a, b, c, p, q, r) < 0.0
        if abs(gu) + abs(gv) <= NEARLY:
            return HERE if opposed else LOST, x, y, z
        if not opposed:
            break
        a, b, c = a + p, b + q, c + r
        p, q, r = facing(floats, ints, one, other, x + apart * ux, y + apart * uy, z + apart * uz)
        huu, huv = dot(p - a, q - b, r - c, ux, uy, uz) / apart, dot(p - a, q - b, r - c, vx, vy, vz) / apart
        p, q, r = facing(floats, ints, one, other, x + apart * vx, y + apart * vy, z + apart * vz)
        hvu, hvv = dot(p - a, q - b, r - c, ux, uy, uz) / apart, dot(p - a, q - b, r - c, vx, vy, vz) / apart
        huv = 0.5 * (huv + hvu)
        # A least gap has no direction in which the surfaces bend towards each other. Where they do not bend at all, as
        # a cylinder along its axis on a plane, a point is as good as the next, though they are not quite parallel.
        mean, half = 0.5 * (huu + hvv), math.sqrt(0.25 * (huu - hvv) ** 2 + huv * huv)
        least, large = mean - half, mean + half
        if least < -1e-3 * max(large, -least):
            break
        eu, ev = (huv, large - huu) if abs(large - huu) > abs(large - hvv) else (large - hvv, huv)
        size = math.sqrt(eu * eu + ev * ev)
        eu, ev = (eu / size, ev / size) if size > 0.0 else (1.0, 0.0)
        along, other_way = eu * gu + ev * gv, eu * gv - ev * gu
        bends, both = large * most > FLAT, least * most > FLAT
        if (not bends or abs(along) <= NEARLY) and (not both or abs(other_way) <= NEARLY):
            return HERE, x, y, z
        along = -along / large if bends else 0.0
        other_way = -other_way / least if both else 0.0
        du, dv = eu * along - ev * other_way, ev * along + eu * other_way
        step = math.sqrt(du * du + dv * dv)
        if not step < math.inf:
            break
        if step > 2.0 * most:
            return AWAY, sx, sy, sz
        x, y, z = x + du * ux + dv * vx, y + du * uy + dv * vy, z + du * uz + dv * vz
        away = (x - sx) ** 2 + (y - sy) ** 2 + (z - sz) ** 2
        if away > most * most:
            return AWAY, sx, sy, sz
        if step < 1e-9 * spacing:
            d, nx, ny, nz = field(floats, ints, one, x, y, z)
            return HERE, x - d * nx, y - d * ny, z - d * nz
    return LOST, sx, sy, sz


@lean_inlined
def bent(px, py, pz, tx, ty, tz, rx, ry, rz, s):
    """The point of an edge a part s of the way to its end, and the direction of the edge there."""
    square = dot(rx, ry, rz, rx, ry, rz)
    if square == 0.0:
        return px + s * tx, py + s * ty, pz + s * tz, tx, ty, tz
    length, radius = math.sqrt(dot(tx, ty, tz, tx, ty, tz)), math.sqrt(square)
    angle = s * length / radius
    sine, rest = math.sin(angle), -2.0 * math.sin(0.5 * angle) ** 2
    f = sine * radius / length
    g = sine * length / radius
    return (
        *(px + rest * rx + f * tx, py + rest * ry + f * ty, pz + rest * rz + f * tz),
        *(tx + rest * tx - g * rx, ty + rest * ty - g * ry, tz + rest * tz - g * rz),
    )


@lean(types.Tuple((types.boolean, F))(A, I, N, F, F, F, F, F, F, F, F, F), inner=True)
def least_along(floats, ints, other, px, py, pz, tx, ty, tz, rx, ry, rz):
    """Where an edge is nearest to ``other`` within its half lengths to both sides, -1..1; whether it is there."""
    _, a, b, c = field(floats, ints, other, px, py, pz)
    size = math.sqrt(dot(tx, ty, tz, tx, ty, tz))
    slope = dot(a, b, c, tx, ty, tz)
    if abs(slope) <= NEARLY * size:
        return False, 0.0
    low, at_low = 0.0, slope
    high = -1.0 if slope > 0.0 else 1.0
    x, y, z, ux, uy, uz = bent(px, py, pz, tx, ty, tz, rx, ry, rz, high)
    _, a, b, c = field(floats, ints, other, x, y, z)
    at_high = dot(a, b, c, ux, uy, uz)
    if at_high * slope >= 0.0:
        return False, 0.0
    middle, kept = 0.0, -1
    for turn in range(60):
        # The secant, by the Illinois rule, and every third time the mean (a kink has no slope that vanishes).
        part = at_low / (at_low - at_high) if turn % 3 < 2 else 0.5
        middle = low + part * (high - low)
        x, y, z, ux, uy, uz = bent(px, py, pz, tx, ty, tz, rx, ry, rz, middle)
        _, a, b, c = field(floats, ints, other, x, y, z)
        value = dot(a, b, c, ux, uy, uz)
        if abs(value) <= NEARLY * size or abs(high - low) < 1e-12:
            break
        if value * at_low > 0.0:
            low, at_low = middle, value
            if kept == 1:
                at_high *= 0.5
            kept = 1
        else:
            high, at_high = middle, value
            if kept == 0:
                at_low *= 0.5
            kept = 0
    return True, middle


@lean(F(A, I, N, F, F, F), inner=True)
def outside_box(floats, ints, skin, x, y, z):
    """Distance of a point, in the body's axes from its center, from the box around a skin."""
    at = ints[skin + SIZES_AT]
    a = max(0.0, max(floats[at + LOW] - x, x - floats[at + HIGH]))
    b = max(0.0, max(floats[at + LOW + 1] - y, y - floats[at + HIGH + 1]))
    c = max(0.0, max(floats[at + LOW + 2] - z, z - floats[at + HIGH + 2]))
    return math.sqrt(a * a + b * b + c * c)


@lean(types.UniTuple(F, 7)(A, I, N, N, A, N, N, F, F, F, F, F), inner=True)
def beyond(floats, ints, one, other, places, at, at_other, x, y, z, r, margin):
    """How far a ball about a point of one body is at least from another skin, roughly once it is above a margin.

    Below, besides: the normal there and the point, in the world.
    """
    wx, wy, wz = to_world(places, at + 3, x, y, z)
    wx, wy, wz = wx + places[at], wy + places[at + 1], wz + places[at + 2]
    p, q, s = wx - places[at_other], wy - places[at_other + 1], wz - places[at_other + 2]
    p, q, s = to_body(places, at_other + 3, p, q, s)
    far = outside_box(floats, ints, other, p, q, s) - r
    if far > margin:
        return far, 0.0, 0.0, 0.0, wx, wy, wz
    d, nx, ny, nz = field(floats, ints, other, wx, wy, wz)
    return d - r, nx, ny, nz, wx, wy, wz
