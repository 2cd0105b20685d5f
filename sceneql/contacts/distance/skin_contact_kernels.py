# mypy: ignore-errors
"""The contact points of two skins (contact_skin_kernels), their distance, and how far they may go in a step."""

import math

import numpy as np
from numba import types

from sceneql.bodies.rigid.rigid_kernels import to_world
from sceneql.compiled.kernels import kernel, lean
from sceneql.contacts.distance.contact_skin_kernels import (
    AT_ALONG,
    AT_BEND,
    BOXES,
    EDGES_AT,
    FOUND,
    HERE,
    LINKS,
    LOST,
    MOST_FOUND,
    NODES,
    POINTS,
    RECORD,
    SIZES_AT,
    SMOOTH_AT,
    SPACING,
    THICKNESS,
    bent,
    beyond,
    field,
    least_along,
    set_pose,
    slid,
)
from sceneql.contacts.distance.core_kernels import at3, cross, dot, put3
from sceneql.contacts.distance.first_touch_kernels import move
from sceneql.system.signatures_kernels import A, F, I, N

MOST = 12
"""Most points of a pair."""
POINT = 10
"""Numbers of a point: on the surface of a (3), on that of b (3), the gap [m], the normal from b to a (3)."""
SAME = 1e-5
"""Distance of two points, in parts of the smaller body, up to which they are one."""
LOW = 0.01
"""Height over the lowest point, in parts of the margin, at which a point is taken for half as far away."""
SHARE = 0.5
"""Part of the thickness of the thinner body that two may move against each other by their contacts at the start."""
MOST_ADVANCES = 200
ALIKE = 2.5
"""Factor between the distances of two skins' points up to which either will do."""
NEAR = 1e-3
"""Gap, in parts of the smaller body, from which on it is asked whether two bodies meet in the step at all."""
MOST_LOOKS = 30
"""Most looks along the paths of two bodies."""
SKINS_TYPE = types.Tuple((N, F))(A, I, N, N, A, N, N, A, N, N, F, F, F, F, A)
SAFE_TYPE = F(A, I, N, N, A, N, N, A, N, N, F, F)


@lean(N(N, F, F, F, F, F, F, F, A, N), inner=True)
def put_found(flip, x, y, z, d, nx, ny, nz, found, count):
    """Add a point of one skin in the field of the other; ``flip``: whether the one is b. The number that there are."""
    if count >= MOST_FOUND:
        return count
    at, sign = FOUND * count, 1.0 - 2.0 * flip
    put3(found, at + 3 * flip, x, y, z)
    put3(found, at + 3 - 3 * flip, x - d * nx, y - d * ny, z - d * nz)
    put3(found, at + 7, sign * nx, sign * ny, sign * nz)
    found[at + 6] = d
    return count + 1


@lean(types.UniTuple(F, 3)(A, N, F, F, F), inner=True)
def placed(places, at, x, y, z):
    """A point of a body's axes in the world."""
    a, b, c = to_world(places, at + 3, x, y, z)
    return a + places[at], b + places[at + 1], c + places[at + 2]


@lean(N(A, I, N, N, A, N, N, F, N, A, N), inner=True)
def edges_in(floats, ints, one, other, places, at, at_other, margin, flip, found, count):
    """Add the points of the edges and corners of ``one`` that are no farther than a margin from ``other``."""
    tree = one + EDGES_AT
    boxes, links, points = ints[tree + BOXES], ints[tree + LINKS], ints[tree + POINTS]
    node = 0
    while node < ints[tree + NODES]:
        b = boxes + 6 * node
        ex, ey, ez = floats[b + 3] - floats[b], floats[b + 4] - floats[b + 1], floats[b + 5] - floats[b + 2]
        r = 0.5 * math.sqrt(ex * ex + ey * ey + ez * ez)
        x, y, z = floats[b] + 0.5 * ex, floats[b + 1] + 0.5 * ey, floats[b + 2] + 0.5 * ez
        link = links + 3 * node
        if beyond(floats, ints, one, other, places, at, at_other, x, y, z, r, margin)[0] > margin:
            node = ints[link]
            continue
        for k in range(ints[link + 1], ints[link + 1] + ints[link + 2]):
            p = points + RECORD * k
            x, y, z = placed(places, at, *at3(floats, p))
            d, nx, ny, nz = field(floats, ints, other, x, y, z)
            tx, ty, tz = to_world(places, at + 3, *at3(floats, p + AT_ALONG))
            length = math.sqrt(dot(tx, ty, tz, tx, ty, tz))
            if d <= margin:
                count = put_found(flip, x, y, z, d, nx, ny, nz, found, count)
            if length == 0.0 or d - 1.1 * length > margin:
                continue
            rx, ry, rz = to_world(places, at + 3, *at3(floats, p + AT_BEND))
            there, s = least_along(floats, ints, other, x, y, z, tx, ty, tz, rx, ry, rz)
            if there:
                x, y, z = bent(x, y, z, tx, ty, tz, rx, ry, rz, s)[:3]
                d, nx, ny, nz = field(floats, ints, other, x, y, z)
                if d <= margin:
                    count = put_found(flip, x, y, z, d, nx, ny, nz, found, count)
        node += 1
    return count


@lean(N(A, I, N, N, A, N, N, F, N, A, N), inner=True)
def smooth_in(floats, ints, one, other, places, at, at_other, margin, flip, found, count):
    """Add points of the smooth surface of ``one`` that are no farther than a margin from ``other``, one a leaf."""
    tree, spacing = one + SMOOTH_AT, floats[ints[one + SIZES_AT] + SPACING]
    boxes, links, points = ints[tree + BOXES], ints[tree + LINKS], ints[tree + POINTS]
    node = 0
    while node < ints[tree + NODES]:
        b = boxes + 6 * node
        ex, ey, ez = floats[b + 3] - floats[b], floats[b + 4] - floats[b + 1], floats[b + 5] - floats[b + 2]
        r = 0.5 * math.sqrt(ex * ex + ey * ey + ez * ez) + 0.5 * spacing
        x, y, z = floats[b] + 0.5 * ex, floats[b + 1] + 0.5 * ey, floats[b + 2] + 0.5 * ez
        link = links + 3 * node
        far, nx, ny, nz, wx, wy, wz = beyond(floats, ints, one, other, places, at, at_other, x, y, z, r, margin)
        if far > margin:
            node = ints[link]
            continue
        # The lowest by the distance and the normal in the middle is where to look from.
        first = ints[link + 1]
        low, lowest = math.inf, first
        for k in range(first, first + ints[link + 2]):
            x, y, z = placed(places, at, *at3(floats, points + RECORD * k))
            d = dot(nx, ny, nz, x - wx, y - wy, z - wz)
            if d < low:
                low, lowest = d, k
        if ints[link + 2] > 0:
            x, y, z = placed(places, at, *at3(floats, points + RECORD * lowest))
            d, nx, ny, nz = field(floats, ints, other, x, y, z)
            if d <= margin + spacing:
                where, px, py, pz = slid(floats, ints, one, other, x, y, z, r + spacing)
                if where == HERE:
                    d, nx, ny, nz = field(floats, ints, other, px, py, pz)
                    if d <= margin:
                        count = put_found(flip, px, py, pz, d, nx, ny, nz, found, count)
                elif d <= margin and (where == LOST or margin <= 0.0):
                    # What lies a way off the least gap is known there: where a body rolls, its own would lift it.
                    count = put_found(flip, x, y, z, d, nx, ny, nz, found, count)
        node += 1
    return count


@lean(N(A, N, F, F, A, A), inner=True)
def spread(found, count, size, margin, points, left):
    """Choose at most MOST points: the lowest, then again and again the one farthest from all that were taken, by place
    and normal, and of those as far rather a low one; their number."""
    best, low = math.inf, -1
    for k in range(count):
        left[k] = math.inf
        if found[FOUND * k + 6] < best:
            best, low = found[FOUND * k + 6], k
    taken = 0
    while low >= 0 and taken < MOST:
        p, to = FOUND * low, POINT * taken
        for c in range(POINT):
            points[to + c] = found[p + c]
        taken += 1
        far, low = 0.0, -1
        for k in range(count):
            q = FOUND * k
            away = (found[p] - found[q]) ** 2 + (found[p + 1] - found[q + 1]) ** 2 + (found[p + 2] - found[q + 2]) ** 2
            turn = 0.0
            for c in range(7, 10):
                turn += (found[p + c] - found[q + c]) ** 2
            left[k] = min(left[k], away + 0.25 * size * size * turn)
            high = 1.0 + (found[q + 6] - best) / (LOW * margin)
            if left[k] > (SAME * size) ** 2 and left[k] > far * high * high:
                far, low = left[k] / (high * high), k
    return taken


@lean(types.UniTuple(F, 3)(A, N, A, N, F, F, F, F), inner=True)
def carried(places, at, motions, of, t, x, y, z):
    """Where a point of a body is after a time t [s]."""
    x, y, z = x - places[at], y - places[at + 1], z - places[at + 2]
    wx, wy, wz = at3(motions, of + 3)
    rate = math.sqrt(dot(wx, wy, wz, wx, wy, wz))
    if rate > 0.0:
        sine, rest = math.sin(rate * t) / rate, 2.0 * (math.sin(0.5 * rate * t) / rate) ** 2
        ux, uy, uz = cross(wx, wy, wz, x, y, z)
        vx, vy, vz = cross(wx, wy, wz, ux, uy, uz)
        x, y, z = x + sine * ux + rest * vx, y + sine * uy + rest * vy, z + sine * uz + rest * vz
    return (
        *(x + places[at] + t * motions[of], y + places[at + 1] + t * motions[of + 1]),
        z + places[at + 2] + t * motions[of + 2],
    )


@lean(types.boolean(A, N, N, A, N, N, F, A, N), inner=True)
def through(places, at_a, at_b, motions, of_a, of_b, h, found, count):
    """Whether a point of those found would go through the plane between it and its foot in a step."""
    for k in range(count):
        p = FOUND * k
        ax, ay, az = carried(places, at_a, motions, of_a, h, *at3(found, p))
        bx, by, bz = carried(places, at_b, motions, of_b, h, *at3(found, p + 3))
        if dot(*at3(found, p + 7), ax - bx, ay - by, az - bz) < 0.0:
            return True
    return False


@lean(types.Tuple((N, F))(A, I, N, N, A, N, N, F, A), inner=True)
def all_points(floats, ints, a, b, places, at_a, at_b, margin, found):
    """Write the points of two skins no farther apart than a margin: their number, and the least distance."""
    set_pose(floats, ints, a, places, at_a)
    set_pose(floats, ints, b, places, at_b)
    count = edges_in(floats, ints, a, b, places, at_a, at_b, margin, 0, found, 0)
    count = edges_in(floats, ints, b, a, places, at_b, at_a, margin, 1, found, count)
    # Of two smooth surfaces that face each other either has the place: the one with closer points is asked, but where
    # they are much alike the one with fewer.
    fine_a, fine_b = floats[ints[a + SIZES_AT] + SPACING], floats[ints[b + SIZES_AT] + SPACING]
    some_a, some_b = ints[a + SMOOTH_AT + NODES], ints[b + SMOOTH_AT + NODES]
    fewer = some_a <= some_b and fine_a <= ALIKE * fine_b
    if some_b == 0 or (some_a > 0 and (fewer or ALIKE * fine_a < fine_b)):
        count = smooth_in(floats, ints, a, b, places, at_a, at_b, margin, 0, found, count)
    else:
        count = smooth_in(floats, ints, b, a, places, at_b, at_a, margin, 1, found, count)
    least = math.inf
    for k in range(count):
        least = min(least, found[FOUND * k + 6])
    return count, least


@kernel(SKINS_TYPE)
def touching(floats, ints, a, b, places, at_a, at_b, motions, of_a, of_b, h, fast, margin, size, points):
    """The contact points of two skins no farther apart than a margin [m]: their number, and the least gap.

    ``ints[a:]``, ``ints[b:]``: the skins; ``places[at_a:]``, ``places[at_b:]``: where their bodies are at the start of
    a step of h [s], in which they go on at ``motions[of_a:]``, ``motions[of_b:]``, their points against each other at
    most at ``fast`` [m/s]; ``size``: the reach of the smaller [m]. Writes to ``points`` (MOST POINT,).
    """
    found = np.empty(FOUND * MOST_FOUND)
    count, least = all_points(floats, ints, a, b, places, at_a, at_b, margin, found)
    near = NEAR * size
    if h > 0.0 and least > near and through(places, at_a, at_b, motions, of_a, of_b, h, found, count):
        # What passes by meets planes that go on beside the other body: by conservative advancement.
        moved, other = np.empty(14), np.empty(FOUND * MOST_FOUND)
        t, gap = 0.0, least
        for _ in range(MOST_LOOKS):
            t += gap / fast
            if t >= h:
                return 0, least
            move(places, at_a, motions, of_a, t, moved, 0)
            move(places, at_b, motions, of_b, t, moved, 7)
            gap = all_points(floats, ints, a, b, moved, 0, 7, min(margin, fast * (h - t)), other)[1]
            if gap <= near:
                break
    return spread(found, count, size, max(margin, SAME * size), points, np.empty(count)), least


@lean(F(A, I, N, N, A, N, N, F, N), inner=True)
def least_of(floats, ints, one, other, places, at, at_other, best, first):
    """The least distance of the points of a tree of ``one`` from ``other``, less the spacing of points; or ``best``."""
    tree, spacing = one + first, floats[ints[one + SIZES_AT] + SPACING]
    boxes, links, points = ints[tree + BOXES], ints[tree + LINKS], ints[tree + POINTS]
    node = 0
    while node < ints[tree + NODES]:
        b = boxes + 6 * node
        ex, ey, ez = floats[b + 3] - floats[b], floats[b + 4] - floats[b + 1], floats[b + 5] - floats[b + 2]
        r = 0.5 * math.sqrt(ex * ex + ey * ey + ez * ez)
        x, y, z = floats[b] + 0.5 * ex, floats[b + 1] + 0.5 * ey, floats[b + 2] + 0.5 * ez
        link = links + 3 * node
        far, _, _, _, wx, wy, wz = beyond(floats, ints, one, other, places, at, at_other, x, y, z, r + spacing, best)
        if far > best:
            node = ints[link]
            continue
        for k in range(ints[link + 1], ints[link + 1] + ints[link + 2]):
            x, y, z = placed(places, at, *at3(floats, points + RECORD * k))
            # No point is nearer than its way to the middle allows.
            if far + r - math.sqrt((x - wx) ** 2 + (y - wy) ** 2 + (z - wz) ** 2) < best:
                best = min(best, field(floats, ints, other, x, y, z)[0] - spacing)
        node += 1
    return best


@lean(F(A, I, N, N, A, N, N, F), inner=True)
def apart(floats, ints, a, b, places, at_a, at_b, most):
    """At least so far are two skins apart [m], or ``most``."""
    set_pose(floats, ints, a, places, at_a)
    set_pose(floats, ints, b, places, at_b)
    for tree in (EDGES_AT, SMOOTH_AT):
        most = least_of(floats, ints, a, b, places, at_a, at_b, most, tree)
        most = least_of(floats, ints, b, a, places, at_b, at_a, most, tree)
    return most


@kernel(SAFE_TYPE)
def safe(floats, ints, a, b, places, at_a, at_b, motions, of_a, of_b, fast, h):
    """How long, up to h [s], two skins may move by their contacts at the start; negative: so long they do not meet.

    ``fast``: the largest speed of their points against each other [m/s]. By conservative advancement.
    """
    thin = SHARE * min(floats[ints[a + SIZES_AT] + THICKNESS], floats[ints[b + SIZES_AT] + THICKNESS])
    if fast * h <= thin:
        return h
    moved = np.empty(14)
    t = 0.0
    for _ in range(MOST_ADVANCES):
        move(places, at_a, motions, of_a, t, moved, 0)
        move(places, at_b, motions, of_b, t, moved, 7)
        gap = apart(floats, ints, a, b, moved, 0, 7, fast * (h - t) + thin)
        if gap >= fast * (h - t):
            return -h
        if gap <= 0.5 * thin:
            break
        t += gap / fast
    return -t if t > 0.0 else min(h, thin / fast)
