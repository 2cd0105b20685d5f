# mypy: ignore-errors
"""When two moving convex shapes first come near each other, by conservative advancement (Mirtich 1996).

A direction that separates the shapes now keeps on doing so for a time: along it every vertex goes on at its speed, less
what turning can bend its way, which is bounded. So nothing is missed, however fast the bodies are and however thin.
The direction stands still or turns with one of the shapes, whichever lasts longest: what leaves, or slides along, a
face that turns is seen by that face's own normal in one advance, and by one that stands in a thousand.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.distance.convex import CORE
from sceneql.contacts.distance.core_kernels import (
    ADVANCES,
    FLOATS,
    GAP,
    HEAD,
    INTS,
    KIND,
    MOVED,
    NORMAL,
    PLACE,
    RADIUS,
    REACH,
    VERTICES,
    at3,
    cross,
    dot,
    end_of,
    farthest,
    relative,
)
from sceneql.contacts.distance.gap_kernels import nearest
from sceneql.system.signatures_kernels import A, F, I, N

MOTION = 6
"""Numbers of a motion: velocity of the center [m/s], and constant angular velocity in the world's axes [rad/s]."""
MOST_ADVANCES = 1000
"""Most advances; some ten are the rule."""
CHORDS = 60
"""Most chords of the search for how long a direction surely separates the shapes."""
NEARLY = 1.05
"""How near that time is found, as a factor."""


@lean(types.void(A, N, A, N, F, A, N), inner=True)
def move(places, at, motions, of, t, moved, to):
    """Writes the place of a body after a time t [s]."""
    vx, vy, vz = at3(motions, of)
    moved[to], moved[to + 1], moved[to + 2] = places[at] + t * vx, places[at + 1] + t * vy, places[at + 2] + t * vz
    wx, wy, wz = at3(motions, of + 3)
    a, b, c, d = places[at + 3], places[at + 4], places[at + 5], places[at + 6]
    rate = math.sqrt(wx * wx + wy * wy + wz * wz)
    if rate == 0.0:
        moved[to + 3], moved[to + 4], moved[to + 5], moved[to + 6] = a, b, c, d
        return
    cosine, sine = math.cos(0.5 * t * rate), math.sin(0.5 * t * rate) / rate
    x, y, z = sine * wx, sine * wy, sine * wz
    moved[to + 3] = cosine * a - x * b - y * c - z * d
    moved[to + 4] = cosine * b + x * a + y * d - z * c
    moved[to + 5] = cosine * c + y * a + z * b - x * d
    moved[to + 6] = cosine * d + z * a + x * c - y * b


@lean(F(A, N, N, F, F, F, F, F, F, F, F, F, F), inner=True)
def least_along(room, core, count, cx, cy, cz, x, y, z, wx, wy, wz, t):
    """The least product of a vector and a vertex of a core that goes on at its speed now for a time t, turning about a
    center."""
    ux, uy, uz = cross(x, y, z, wx, wy, wz)
    far = farthest(room, core, count, -x - t * ux, -y - t * uy, -z - t * uz)[0]
    return -far - t * dot(ux, uy, uz, cx, cy, cz)


@lean_inlined
def turned_by(motions, of, x, y, z):
    """The spin of a body in axes that turn at (x, y, z) [rad/s], and how fast its turning bends ways there [1/s^2]:
    no vertex at a distance r of its center has a larger acceleration than this times r."""
    px, py, pz = at3(motions, of + 3)
    spin, frame_spin = math.sqrt(dot(px, py, pz, px, py, pz)), math.sqrt(dot(x, y, z, x, y, z))
    px, py, pz = px - x, py - y, pz - z
    return px, py, pz, math.sqrt(dot(px, py, pz, px, py, pz)) * (spin + frame_spin)


@lean(F(A, I, N, N, A, N, A, N, N, N, F, A), inner=True)
def still_apart(floats, ints, a, b, places, at, motions, of_a, of_b, of_frame, t, room):
    """A bound from below of the gap [m] after a time t, along the normal that was found now, in axes that turn as the
    body whose motion begins at ``of_frame`` (-1: that stand, as they must beside a half space).

    Each vertex goes on at its speed, less what turning can bend its way. So it is a concave function of t. The cores
    are in the working memory.
    """
    fa, ia, fb, ib = ints[a + FLOATS], ints[a + INTS], ints[b + FLOATS], ints[b + INTS]
    x, y, z = at3(room, NORMAL)
    ux, uy, uz = at3(motions, of_a)
    vx, vy, vz = at3(motions, of_b)
    ux, uy, uz = ux - vx, uy - vy, uz - vz
    wx = wy = wz = 0.0
    if of_frame >= 0:
        wx, wy, wz = at3(motions, of_frame + 3)
    px, py, pz, bends_a = turned_by(motions, of_a, wx, wy, wz)
    qx, qy, qz, bends_b = turned_by(motions, of_b, wx, wy, wz)
    apart = t * dot(x, y, z, ux, uy, uz)
    if ints[a + KIND] == CORE:
        apart -= 0.5 * t * t * bends_a * floats[fa + REACH]
    if ints[b + KIND] == CORE:
        apart -= 0.5 * t * t * bends_b * floats[fb + REACH]
    if ints[a + KIND] != CORE or ints[b + KIND] != CORE:
        # One core alone, about its own center, that was nearest the plane by the gap.
        if ints[a + KIND] != CORE:
            ia, x, y, z, px, py, pz = ib, -x, -y, -z, qx, qy, qz
        count = ints[ia + VERTICES]
        apart += room[GAP] - least_along(room, HEAD, count, 0.0, 0.0, 0.0, x, y, z, px, py, pz, 0.0)
        return apart + least_along(room, HEAD, count, 0.0, 0.0, 0.0, x, y, z, px, py, pz, t)
    core_b = end_of(ints, ia, HEAD)
    ox, oy, oz = relative(places, at, at + PLACE)
    if of_frame >= 0:
        # The way from center to center turns back, and bends by Coriolis' and the centrifugal acceleration.
        cx, cy, cz = cross(wx, wy, wz, ox, oy, oz)
        apart += t * dot(x, y, z, cx, cy, cz)
        cx, cy, cz = cross(wx, wy, wz, ux, uy, uz)
        far = math.sqrt(dot(ox, oy, oz, ox, oy, oz)) + t * math.sqrt(dot(ux, uy, uz, ux, uy, uz))
        bends = 2.0 * math.sqrt(dot(cx, cy, cz, cx, cy, cz)) + dot(wx, wy, wz, wx, wy, wz) * far
        apart -= 0.5 * t * t * bends
    apart += least_along(room, HEAD, ints[ia + VERTICES], 0.0, 0.0, 0.0, x, y, z, px, py, pz, t)
    apart += least_along(room, core_b, ints[ib + VERTICES], ox, oy, oz, -x, -y, -z, qx, qy, qz, t)
    return apart - floats[fa + RADIUS] - floats[fb + RADIUS]


@lean(F(A, I, N, N, A, N, A, N, N, N, F, F, A), inner=True)
def advance(floats, ints, a, b, places, at, motions, of_a, of_b, of_frame, margin, longest, room):
    """A time for which the gap surely stays above ``margin`` [m]; longer than ``longest`` where it does so for that."""
    low, above = 0.0, still_apart(floats, ints, a, b, places, at, motions, of_a, of_b, of_frame, 0.0, room) - margin
    high = longest
    below = still_apart(floats, ints, a, b, places, at, motions, of_a, of_b, of_frame, high, room) - margin
    if above <= 0.0:
        return 0.0
    if below >= 0.0:
        return math.inf
    for _ in range(CHORDS):
        # The chord of a concave function is below it. Where it is far below, the mean comes nearer.
        low += (high - low) * above / (above - below)
        above = still_apart(floats, ints, a, b, places, at, motions, of_a, of_b, of_frame, low, room) - margin
        if above <= 0.0:
            break
        if high <= NEARLY * low:
            break
        t = math.sqrt(low * high)
        value = still_apart(floats, ints, a, b, places, at, motions, of_a, of_b, of_frame, t, room) - margin
        if value > 0.0:
            low, above = t, value
        else:
            high, below = t, value
    return low


@lean_inlined
def spheres_meet(x, y, z, vx, vy, vz, within, h):
    """When a point at (x, y, z) first is within a distance of the origin; infinity where it is not before h."""
    square, along, speed = (
        dot(x, y, z, x, y, z) - within * within,
        dot(x, y, z, vx, vy, vz),
        dot(vx, vy, vz, vx, vy, vz),
    )
    if square <= 0.0:
        return 0.0
    root = along * along - speed * square
    if along >= 0.0 or root < 0.0:
        return math.inf
    t = square / (math.sqrt(root) - along)
    return t if t <= h else math.inf


@lean(F(A, I, N, N, A, N, N, A, N, N, F, F, F, A))
def first_touch(floats, ints, a, b, places, at_a, at_b, motions, of_a, of_b, h, margin, tolerance, room):
    """The first time [s] in 0..h at which the gap of two moving shapes is at most ``margin`` [m]; infinity if never.

    The time is never late: the gap is then at most ``margin + tolerance``, or after MOST_ADVANCES still more. The
    centers move on straight lines from ``places`` (gap_kernels.gap) at the velocities of ``motions[of_a:]``,
    ``motions[of_b:]`` (MOTION), and the bodies turn at constant angular velocities. A half space must not turn.
    """
    fa, fb = ints[a + FLOATS], ints[b + FLOATS]
    ra, rb = floats[fa + REACH], floats[fb + REACH]
    vx, vy, vz = at3(motions, of_a)
    ux, uy, uz = at3(motions, of_b)
    vx, vy, vz = ux - vx, uy - vy, uz - vz
    t, solid = 0.0, ints[a + KIND] == CORE and ints[b + KIND] == CORE
    if solid:
        x, y, z = relative(places, at_a, at_b)
        # The spheres around them; a little larger, for rounding.
        t = spheres_meet(x, y, z, vx, vy, vz, (ra + rb + max(margin, 0.0) + tolerance) * (1.0 + 1e-12), h)
    moved = room.size - MOVED
    for number in range(MOST_ADVANCES):
        room[ADVANCES] = number
        if not t <= h:
            return math.inf
        move(places, at_a, motions, of_a, t, room, moved)
        move(places, at_b, motions, of_b, t, room, moved + PLACE)
        nearest(floats, ints, a, b, room, moved, moved + PLACE, math.inf, room)
        gap = room[GAP]
        if gap <= margin + tolerance:
            return t
        if gap == math.inf:
            return math.inf
        longest = h - t
        step = advance(floats, ints, a, b, room, moved, motions, of_a, of_b, -1, margin, longest, room)
        if solid and step <= longest:
            step = max(step, advance(floats, ints, a, b, room, moved, motions, of_a, of_b, of_a, margin, longest, room))
        if solid and step <= longest:
            step = max(step, advance(floats, ints, a, b, room, moved, motions, of_a, of_b, of_b, margin, longest, room))
        if step > longest:
            return math.inf
        if step == 0.0:
            return t
        t += step
    return t
