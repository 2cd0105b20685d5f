# mypy: ignore-errors
"""Normals of triangles' corners, smooth across edges that turn little: a vertex has one for each of its fans.

Faces about a vertex are of one fan where edges at it join them that turn by less than the crease angle; a fan's normal
is the mean of its faces', weighted by their angles at the vertex (Thuermer & Wuethrich 1998), so that it does not
depend on how flat faces are cut into triangles.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined

INTS = types.int32[::1]
PLACES = types.float64[:, ::1]
NUMBERS = types.float64[::1]


@lean_inlined
def edge(places, a, b, out, row):
    """The way from a vertex to another, divided by the longest of its coordinates; zero for one of no length."""
    longest = 0.0
    for c in range(3):
        out[row, c] = places[b, c] - places[a, c]
        longest = max(longest, abs(out[row, c]))
    if longest > 0.0:
        for c in range(3):
            out[row, c] /= longest


@lean_inlined
def cross(out, row):
    """The product of the two vectors that stand in rows row and row + 1."""
    ux, uy, uz = out[row, 0], out[row, 1], out[row, 2]
    vx, vy, vz = out[row + 1, 0], out[row + 1, 1], out[row + 1, 2]
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


@lean_inlined
def face_normal(places, corners, face, out, row):
    """The unit normal of a triangle into ``out``, with two more rows behind as room; False for one without area."""
    a = corners[3 * face]
    edge(places, a, corners[3 * face + 1], out, row + 1)
    edge(places, a, corners[3 * face + 2], out, row + 2)
    x, y, z = cross(out, row + 1)
    size = math.sqrt(x * x + y * y + z * z)
    if size == 0.0:
        return False
    out[row, 0], out[row, 1], out[row, 2] = x / size, y / size, z / size
    return True


@lean_inlined
def angle(places, a, b, p, out, row):
    """The angle [rad] at a between the ways to b and p; two rows of ``out`` are room."""
    edge(places, a, b, out, row)
    edge(places, a, p, out, row + 1)
    x, y, z = cross(out, row)
    along = out[row, 0] * out[row + 1, 0] + out[row, 1] * out[row + 1, 1] + out[row, 2] * out[row + 1, 2]
    return math.atan2(math.sqrt(x * x + y * y + z * z), along)


@lean(types.int64(PLACES, INTS, PLACES))
def drop_flat(places, corners, room):
    """Move the triangles (3 m) that have an area to the front; returns how many there are. ``room`` is (3, 3)."""
    kept = 0
    for face in range(len(corners) // 3):
        if face_normal(places, corners, face, room, 0):
            for c in range(3):
                corners[3 * kept + c] = corners[3 * face + c]
            kept += 1
    return kept


@lean(types.int64(INTS, INTS, INTS, INTS))
def by_place(corners, place_of, starts, order):
    """The corners (3 m) in the order of their vertices' places; returns the largest number of corners at one.

    ``starts`` (n + 2), zero at first, gets the first of each place's in ``order`` (3 m), in its entries 0 to n.
    """
    for corner in range(len(corners)):
        starts[place_of[corners[corner]] + 2] += 1
    most = 0
    for k in range(2, len(starts)):
        most = max(most, starts[k])
        starts[k] += starts[k - 1]
    for corner in range(len(corners)):
        place = place_of[corners[corner]] + 1
        order[starts[place]] = corner
        starts[place] += 1
    return most


@lean_inlined
def root(parents, k):
    """The one that stands for all that k is joined with."""
    while parents[k] != k:
        parents[k] = parents[parents[k]]
        k = parents[k]
    return k


@lean_inlined
def join(parents, a, b):
    """Make two of one fan; the one of less number stands for it."""
    a, b = root(parents, a), root(parents, b)
    if a < b:
        parents[b] = a
    else:
        parents[a] = b


@lean_inlined
def sort_by(keys, items, count):
    """Sort items by their keys, both in place (Shell 1959, gaps of Ciura 2001 and beyond)."""
    gap = 1
    while gap < count:
        gap = int(2.25 * gap) + 1
    while gap > 0:
        for k in range(gap, count):
            key, item = keys[k], items[k]
            j = k
            while j >= gap and keys[j - gap] > key:
                keys[j], items[j] = keys[j - gap], items[j - gap]
                j -= gap
            keys[j], items[j] = key, item
        gap = int(gap / 2.25)


@lean_inlined
def join_about_edge(parents, units, members, keys, count, axis_x, axis_y, axis_z, crease):
    """Join faces about one edge whose normals follow each other around it within the crease angle.

    All normals are perpendicular to the edge: sorted by their angles about it, whatever is joined by pairs is joined by
    neighbors. ``members`` and ``keys`` have ``count`` entries.
    """
    first = members[0]
    ax, ay, az = units[first, 0], units[first, 1], units[first, 2]
    bx, by, bz = axis_y * az - axis_z * ay, axis_z * ax - axis_x * az, axis_x * ay - axis_y * ax
    for k in range(count):
        x, y, z = units[members[k], 0], units[members[k], 1], units[members[k], 2]
        keys[k] = math.atan2(x * bx + y * by + z * bz, x * ax + y * ay + z * az)
    sort_by(keys, members, count)
    for k in range(1, count):
        if keys[k] - keys[k - 1] <= crease:
            join(parents, members[k - 1], members[k])
    if 2.0 * math.pi - keys[count - 1] + keys[0] <= crease:
        join(parents, members[count - 1], members[0])


@lean(types.int64(
    PLACES, INTS, INTS, INTS, INTS, types.float64, INTS, INTS, PLACES, PLACES, NUMBERS, NUMBERS, INTS, INTS, INTS, INTS,
    INTS, INTS, INTS, PLACES,
))  # fmt: skip
def smooth(
    places, place_of, corners, starts, order, crease, heads, seen, units, sums, weights, keys, parents, follow,
    members, other, triangles, source, fans, normals,
):  # fmt: skip
    """New vertices of triangles (3 m), one a fan and color; returns their number.

    ``places`` (v, 3) of the vertices, of which those at one place have one number in ``place_of``; ``starts`` and
    ``order`` as ``by_place`` makes them; ``crease`` [rad]. ``heads`` (places) and ``seen`` (v) are -1 and stay so.
    Room for the most corners at a vertex, k: ``units`` (k + 2, 3), ``sums`` (k, 3), ``weights``, ``parents``, ``fans``
    (k), ``keys``, ``follow``, ``members``, ``other`` (2 k). Written are ``triangles`` (3 m), ``source`` (3 m) the old
    vertex of each new one, and ``normals`` (3 m, 3), its unit normal.
    """
    made = 0
    least = math.cos(min(crease, math.pi)) - 1e-12
    for place in range(len(starts) - 2):
        begin, count = starts[place], starts[place + 1] - starts[place]
        for k in range(count):
            corner = order[begin + k]
            face, side = corner // 3, corner % 3
            a = corners[corner]
            b, p = corners[3 * face + (side + 1) % 3], corners[3 * face + (side + 2) % 3]
            face_normal(places, corners, face, units, k)
            weights[k] = angle(places, a, b, p, units, k + 1)
            parents[k] = k
            for way in range(2):
                far = place_of[b if way == 0 else p]
                other[2 * k + way] = far
                follow[2 * k + way] = heads[far]
                heads[far] = 2 * k + way
        for k in range(2 * count):
            far = other[k]
            if heads[far] < 0:
                continue  # this edge is done
            here = 0
            at = heads[far]
            while at >= 0:
                members[here] = at // 2
                here += 1
                at = follow[at]
            heads[far] = -1
            if here == 2:
                g, h = members[0], members[1]
                if units[g, 0] * units[h, 0] + units[g, 1] * units[h, 1] + units[g, 2] * units[h, 2] >= least:
                    join(parents, g, h)
            elif here > 2:
                corner = order[begin + k // 2]
                to = corners[3 * (corner // 3) + (corner % 3 + 1 + k % 2) % 3]
                edge(places, corners[corner], to, units, count)
                x, y, z = units[count, 0], units[count, 1], units[count, 2]
                size = math.sqrt(x * x + y * y + z * z)
                join_about_edge(parents, units, members, keys, here, x / size, y / size, z / size, crease)
        for k in range(count):
            fans[k] = -1
            for c in range(3):
                sums[k, c] = 0.0
        for k in range(count):
            for c in range(3):
                sums[root(parents, k), c] += weights[k] * units[k, c]
        for k in range(count - 1, -1, -1):
            fan = root(parents, k)
            follow[k] = fans[fan]
            fans[fan] = k
        for fan in range(count):
            at = fans[fan]
            while at >= 0:
                corner = order[begin + at]
                vertex = corners[corner]
                if seen[vertex] < 0:
                    seen[vertex] = made
                    source[made] = vertex
                    size = math.sqrt(sums[fan, 0] ** 2 + sums[fan, 1] ** 2 + sums[fan, 2] ** 2)
                    for c in range(3):  # of a fan that is folded flat any normal will do
                        normals[made, c] = sums[fan, c] / size if size > 1e-12 else units[fan, c]
                    made += 1
                triangles[corner] = seen[vertex]
                at = follow[at]
            at = fans[fan]
            while at >= 0:
                seen[corners[order[begin + at]]] = -1
                at = follow[at]
    return made
