# mypy: ignore-errors
"""The contact points of two convex shapes near each other, all along the normal of their gap.

What faces each other along it is projected and intersected (overlay_kernels): up to eight corners for two faces, two
points for an edge over a face or along an edge, else one. A point is known from step to step by two integers: which
feature of a and of b, and which two lines cross there.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts.distance.convex import CORE, HALF_SPACE
from sceneql.contacts.distance.core_kernels import (
    CORNER,
    FAR,
    FLOATS,
    GAP,
    HEAD,
    INTS,
    KIND,
    NORMAL,
    ON_A,
    ON_B,
    RADIUS,
    REACH,
    ROUNDING,
    VERTICES,
    at3,
    dot,
    end_of,
    put3,
)
from sceneql.contacts.distance.gap_kernels import nearest
from sceneql.system.signatures_kernels import A, F, I, N

overlay = lazy(
    "sceneql.contacts.distance.overlay_kernels:overlay",
    types.Tuple((N, N, N, N, N))(I, N, N, N, N, A, N, F, F, F, F),
)
two_lines = lazy(
    "sceneql.contacts.distance.overlay_kernels:two_lines", types.Tuple((N, N, N))(I, N, N, N, N, A, N, F, F, F)
)
thin_out = lazy("sceneql.contacts.distance.thin_out_kernels:thin_out", types.void(A, N, N, N, F, F, F))

MOST = 8
"""Most points of a pair."""
POINT = 7
"""Numbers of a point: on the surface of a (3), on that of b (3), the gap [m] along the normal from b to a."""
NAME = 2
"""Integers of the name of a point."""
SAME = 1e-9
"""Distance of two corners of one polygon, in parts of the size of the pair, up to which they are one point."""
POSITION = 4
"""Numbers of a corner that say where it is and how high."""
OF_A, OF_B, ON_PLANE, TWO_LINES = range(4)
"""How points were found: corners of a over a face of b, of b over one of a, vertices over a plane, ends of edges."""
LONE = -7.0
"""In place of the lines that cross at a corner: the nearest points, where no corner is."""


@lean(types.void(A, N, F, F, F, F, F, F), inner=True)
def put_corner(room, at, x, y, z, height, before, after):
    """Writes a corner of an overlay."""
    put3(room, at, x, y, z)
    room[at + 3], room[at + 4], room[at + 5] = height, before, after


@lean(N(A, N, N, F, F), inner=True)
def sift(room, at, count, most, same):
    """Keeps, in order, the corners no higher than ``most``; of neighbors at one place the lower one. Their number."""
    kept = 0
    for k in range(count):
        p, twin = at + CORNER * k, -1
        for q in (at, at + CORNER * max(0, kept - 1)):
            away = abs(room[p] - room[q]) + abs(room[p + 1] - room[q + 1]) + abs(room[p + 2] - room[q + 2])
            if kept > 0 and away <= same:
                twin = q
        if twin >= 0:
            for c in range(POSITION if room[p + 3] < room[twin + 3] else 0):
                room[twin + c] = room[p + c]
        elif room[p + 3] <= most:
            for c in range(CORNER):
                room[at + CORNER * kept + c] = room[p + c]
            kept += 1
    return kept


@lean(types.Tuple((N, F, F, F, F))(A, I, N, N, A, N, N, F, A, I, A))
def manifold(floats, ints, a, b, places, at_a, at_b, margin, points, names, room):
    """The points of two shapes whose gap is at most ``margin`` [m]: their number, the least gap, the normal (b to a).

    As gap_kernels.gap, with ``points`` (MOST POINT,) and ``names`` (MOST NAME,) to be written. No points where the
    shapes are farther apart: the gap is then a bound from below.
    """
    kind, i, j = nearest(floats, ints, a, b, places, at_a, at_b, margin, room)
    gap = room[GAP]
    nx, ny, nz = at3(room, NORMAL)
    if kind == FAR or gap > margin:
        return 0, gap, nx, ny, nz
    fa, ia, fb, ib = ints[a + FLOATS], ints[a + INTS], ints[b + FLOATS], ints[b + INTS]
    ra, rb = floats[fa + RADIUS], floats[fb + RADIUS]
    ax, ay, az = at3(places, at_a)
    both_cores = ints[a + KIND] == CORE and ints[b + KIND] == CORE
    of_b, face, feature, found, count = 1, i, j, TWO_LINES, 0
    if both_cores:
        core_a = HEAD
        core_b = end_of(ints, ia, core_a)
        work = end_of(ints, ib, core_b)
        size = floats[fa + REACH] + floats[fb + REACH]
        tiny = ROUNDING * 2.0 * size
        count, work, of_b, face, feature = overlay(ints, ia, core_a, ib, core_b, room, work, -nx, -ny, -nz, tiny)
        found = OF_B if of_b == 1 else OF_A
        if count == 0:
            count, face, feature = two_lines(ints, ia, core_a, ib, core_b, room, work, -nx, -ny, -nz)
            of_b, found = 1, TWO_LINES
    else:
        # The half space is b, or a; the core stands at HEAD, and relative to its own body's center.
        flat_b = ints[b + KIND] == HALF_SPACE
        core, radius = (ia, ra) if flat_b else (ib, rb)
        work = end_of(ints, core, HEAD)
        of_b, found, face, feature = (0 if flat_b else 1), ON_PLANE, 0, 0
        kx, ky, kz = (nx, ny, nz) if flat_b else (-nx, -ny, -nz)
        lx, ly, lz = at3(room, HEAD + 3 * (i if flat_b else j))
        for k in range(ints[core + VERTICES]):
            p = HEAD + 3 * k
            rise = dot(kx, ky, kz, room[p] - lx, room[p + 1] - ly, room[p + 2] - lz)
            put_corner(room, work + CORNER * count, *at3(room, p), gap + radius + rise, 1.0 * k, 0.0)
            count += 1
        if not flat_b:
            for k in range(count):
                for c in range(3):
                    room[work + CORNER * k + c] += places[at_b + c] - places[at_a + c]
        size = floats[(fa if flat_b else fb) + REACH]
    least = math.inf
    for k in range(count):
        least = min(least, room[work + CORNER * k + 3] - ra - rb)
    if least > gap + 4.0 * ROUNDING * size:
        # The nearest points are on features that do not face each other.
        at = ON_B if of_b == 1 else ON_A
        put_corner(room, work + CORNER * count, *at3(room, at), gap + ra + rb, LONE, LONE)
        count += 1
    count = sift(room, work, count, margin + ra + rb, SAME * size)
    if count > MOST:
        thin_out(room, work, count, MOST, nx, ny, nz)
        count = MOST
    for k in range(count):
        p, to = work + CORNER * k, POINT * k
        x, y, z = at3(room, p)
        height = room[p + 3]
        # The corner is a point of the core of a, or of b.
        da, db = (height - ra, rb) if of_b == 1 else (-ra, rb - height)
        put3(points, to, ax + (x + da * nx), ay + (y + da * ny), az + (z + da * nz))
        put3(points, to + 3, ax + (x + db * nx), ay + (y + db * ny), az + (z + db * nz))
        points[to + 6] = height - ra - rb
        names[NAME * k] = (found << 60) + ((face + 1) << 30) + (feature % (1 << 30))
        before, after = int(room[p + 4]), int(room[p + 5])
        names[NAME * k + 1] = ((before + 8) << 30) + (after + 8)
    return count, gap, nx, ny, nz
