# mypy: ignore-errors
"""The contacts of a curved body with a half space or a polyhedron: on faces, edges and corners, and along edges.

A column touches an edge that is parallel to its axis along a segment, whose ends stand for it: the column is there a
line with a radius, and an end is that of the line or of the edge.
"""

import math

from sceneql.bodies.rigid.ties.tie_rows_kernels import put
from sceneql.compiled.kernels import lean
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts.distance.convex import CORE
from sceneql.contacts.distance.core_kernels import EDGES, FLOATS, INTS, KIND, POINTS, RADIUS, edges_at
from sceneql.contacts.rigid_exact.contact_kernels import (
    CORNER_EDGE,
    EDGE_CORNER,
    LINE_A,
    LINE_B,
    OF,
    OWN_A,
    OWN_B,
    RADIUS_A,
    RECORD,
    three,
)
from sceneql.contacts.rigid_exact.curved import CENTER, COLUMN, FIELD, FORM, SIZES
from sceneql.contacts.rigid_exact.curved_find_kernels import (
    COLUMN_B,
    CORE_OF_A,
    FIRST,
    FOUND,
    MOVER_A,
    MOVER_B,
    PAIR_NAME,
    SECOND,
    SHAPE_OF_A,
    SHAPE_OF_B,
    WHO,
    along_axis,
    at_corners,
    begin_record,
    goes_away,
    in_axes_of_a,
    on_edges,
    on_faces,
    separation,
)
from sceneql.contacts.rigid_exact.curved_surface_kernels import SIDEWAYS, away, into, out_of
from sceneql.contacts.rigid_exact.features_kernels import line_of
from sceneql.system.signatures_kernels import A, I, N

meet_rims = lazy("sceneql.contacts.rigid_exact.rim_meet_kernels:meet_rims", FOUND)


@lean(FOUND)
def along_edges(floats, ints, who, margin, next, most):
    """As `on_faces`, along the edges of b that are parallel to the axis of a column a: two contacts each."""
    sb, ma, mb = ints[who + SHAPE_OF_B], ints[who + MOVER_A], ints[who + MOVER_B]
    fa, fb, ib = ints[ints[who + SHAPE_OF_A] + FLOATS], ints[sb + FLOATS], ints[sb + INTS]
    wide, half, radius = floats[fa + SIZES], floats[fa + SIZES + 1], floats[fb + RADIUS]
    mx, my, mz = three(floats, fa + CENTER)
    count, least = 0, math.inf
    for e in range(ints[ib + EDGES]):
        edge = edges_at(ints, ib) + 4 * e
        first, last = fb + POINTS + 3 * ints[edge], fb + POINTS + 3 * ints[edge + 1]
        x, y, z = in_axes_of_a(floats, ma, mb, *three(floats, first))
        u, v, w = in_axes_of_a(floats, ma, mb, *three(floats, last))
        if ints[edge] == ints[edge + 1] or not along_axis(floats, fa, u - x, v - y, w - z):
            continue
        x, y, z = into(floats, fa, x - mx, y - my, z - mz)
        u, v, w = into(floats, fa, u - mx, v - my, w - mz)
        low, high = max(min(y, v), -half), min(max(y, v), half)
        x, z = 0.5 * (x + u), 0.5 * (z + w)
        away = math.sqrt(x * x + z * z)
        if low >= high or away == 0.0:
            continue
        gap = away - wide - radius
        if not goes_away(floats, ints, sb, edge, ma, mb, *out_of(floats, fa, x / away, 0.0, z / away)):
            continue
        least = min(least, gap)
        if gap > margin:
            continue
        along, end = line_of(floats, ints, sb, e)
        ax, ay, az = out_of(floats, fa, 0.0, 1.0, 0.0)
        for side in range(2):
            if count == most:
                continue
            here = low if side == 0 else high
            whole = abs(here) == half
            rec = next + RECORD * count
            kind = CORNER_EDGE if whole else EDGE_CORNER
            begin_record(floats, ints, rec, who, kind, radius, fa)
            floats[rec + OF], floats[rec + RADIUS_A] = e, wide
            by = here if whole else 0.0
            put(floats, rec + OWN_A, mx + by * ax, my + by * ay, mz + by * az)
            put(floats, rec + LINE_A, ax, ay, az)
            put(floats, rec + LINE_B, *along)
            put(floats, rec + OWN_B, *end)
            if not whole:
                corner = first if y == here else last
                put(floats, rec + OWN_B, *three(floats, corner))
            count += 1
    return count, least


@lean(N(A, I, N))
def swapped(floats, ints, who):
    """Write the question with a and b in each other's place; where it stands."""
    other = who + WHO
    ints[other + PAIR_NAME], ints[other + FIRST], ints[other + SECOND] = (
        ints[who + PAIR_NAME],
        ints[who + SECOND],
        ints[who + FIRST],
    )
    ints[other + SHAPE_OF_A], ints[other + SHAPE_OF_B] = ints[who + COLUMN_B], ints[who + CORE_OF_A]
    ints[other + MOVER_A], ints[other + MOVER_B] = ints[who + MOVER_B], ints[who + MOVER_A]
    ints[other + COLUMN_B], ints[other + CORE_OF_A] = ints[who + SHAPE_OF_A], ints[who + SHAPE_OF_B]
    return other


@lean(N(A, I, N, N, N))
def at_rims(floats, ints, who, next, count):
    """Drop the contacts of a with b's axis that are not at a rim of a: these are those of b with a's; how many stay."""
    fa, kept = ints[ints[who + SHAPE_OF_A] + FLOATS], 0
    for k in range(count):
        rec, to = next + RECORD * k, next + RECORD * kept
        s = floats[rec + LINE_A + 1]
        x, y, z = three(floats, rec + OWN_B)
        u, v, w = three(floats, rec + LINE_B)
        ma, mb = ints[who + MOVER_A], ints[who + MOVER_B]
        x, y, z = in_axes_of_a(floats, ma, mb, x + s * u, y + s * v, z + s * w)
        nx, ny, nz = away(floats, ints, fa, x, y, z)[1:]
        if abs(into(floats, fa, nx, ny, nz)[1]) <= SIDEWAYS:
            continue
        for c in range(RECORD if to != rec else 0):
            floats[to + c] = floats[rec + c]
        kept += 1
    return kept


@lean(FOUND)
def meet_column(floats, ints, who, margin, next, most):
    """As `meet`, with a column b: along its round side, along that of a column a at a rim of b, and of the rims of each
    with the rims and flat ends of the other."""
    count, least = on_edges(floats, ints, who, margin, next, most)
    if floats[ints[ints[who + SHAPE_OF_A] + FLOATS] + FORM] == COLUMN:
        more, gap = along_edges(floats, ints, who, margin, next + RECORD * count, most - count)
        count, least = count + more, min(least, gap)
        other = swapped(floats, ints, who)
        more, gap = on_edges(floats, ints, other, margin, next + RECORD * count, most - count)
        count, least = count + at_rims(floats, ints, other, next + RECORD * count, more), min(least, gap)
        more, gap = meet_rims(floats, ints, other, margin, next + RECORD * count, most - count)
        count, least = count + more, min(least, gap)
    more, gap = meet_rims(floats, ints, who, margin, next + RECORD * count, most - count)
    return count + more, min(least, gap)


@lean(FOUND)
def meet(floats, ints, who, margin, next, most):
    """The contacts of a curved body a with b within a margin, written to floats[next:], up to ``most`` of them.

    How many they are, and the gap. Where they overlap so deeply that no place of b's surface is the nearest, how far
    the one is behind the faces of the other.
    """
    if floats[ints[ints[who + SHAPE_OF_A] + FLOATS] + FORM] == FIELD:  # which balls alone meet
        return at_corners(floats, ints, who, margin, next, most)
    if ints[who + COLUMN_B] >= 0:
        return meet_column(floats, ints, who, margin, next, most)
    count, least = on_faces(floats, ints, who, margin, next, most)
    if ints[ints[who + SHAPE_OF_B] + KIND] != CORE:
        return count, least
    more, gap = on_edges(floats, ints, who, margin, next + RECORD * count, most - count)
    count, least = count + more, min(least, gap)
    if floats[ints[ints[who + SHAPE_OF_A] + FLOATS] + FORM] == COLUMN:
        more, gap = along_edges(floats, ints, who, margin, next + RECORD * count, most - count)
        count, least = count + more, min(least, gap)
    more, gap = at_corners(floats, ints, who, margin, next + RECORD * count, most - count)
    count, least = count + more, min(least, gap)
    return count, least if least < math.inf else separation(floats, ints, who)
