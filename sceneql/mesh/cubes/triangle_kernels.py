# mypy: ignore-errors
"""Loops over all triangles of a mesh: facing, turn of normals, boxes, ray crossings."""

from sceneql.compiled.kernels import inlined, lean

SUMMED = 256
"""Triangles of a partial sum."""


@inlined
def along(normals, v, x, y, z):
    """Dot product of a vertex's normal with a vector."""
    return normals[v, 0] * x + normals[v, 1] * y + normals[v, 2] * z


@lean("int64(float64[:, ::1], int32[:, ::1], float64[:, ::1], int64[::1])")
def unlike_corners(places, triangles, normals, rows):
    """Write the triangles whose normal disagrees with one of their vertex normals to ``rows``; returns how many."""
    count = 0
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        x, y, z = places[b, 0] - places[a, 0], places[b, 1] - places[a, 1], places[b, 2] - places[a, 2]
        u, v, w = places[c, 0] - places[a, 0], places[c, 1] - places[a, 1], places[c, 2] - places[a, 2]
        x, y, z = y * w - z * v, z * u - x * w, x * v - y * u
        least = min(min(along(normals, a, x, y, z), along(normals, b, x, y, z)), along(normals, c, x, y, z))
        if least <= 0.0:
            rows[count] = t
            count += 1
    return count


@lean("void(float64[:, ::1], int64[:, ::1], float64[:, ::1], float64[::1])")
def least_cosines(places, triangles, normals, out):
    """The least cosine between the normals of each triangle and of its vertices into ``out`` (t,).

    At most 1; 0 for a triangle without area, -1 where a vertex has no normal.
    """
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        x, y, z = places[b, 0] - places[a, 0], places[b, 1] - places[a, 1], places[b, 2] - places[a, 2]
        u, v, w = places[c, 0] - places[a, 0], places[c, 1] - places[a, 1], places[c, 2] - places[a, 2]
        x, y, z = y * w - z * v, z * u - x * w, x * v - y * u
        size = (x * x + y * y + z * z) ** 0.5
        out[t] = 1.0
        for k in range(3):
            n = triangles[t, k]
            cosine = along(normals, n, x, y, z) / size if size > 0.0 else 0.0
            if normals[n, 0] == 0.0 and normals[n, 1] == 0.0 and normals[n, 2] == 0.0:
                cosine = -1.0
            out[t] = min(out[t], cosine)


@lean("void(int32[:, ::1], int64[::1], int32[::1], uint8[::1], int64[::1])")
def count_edges(triangles, begin, ends, met, found):
    """Numbers into ``found`` (4,): edges, edges of only one triangle, of more than two, and vertices of triangles.

    ``begin`` (vertices + 1,) and ``met`` (vertices,), zeros, and ``ends`` (3 t,) are working memory: an edge is kept at
    its lower vertex.
    """
    for t in range(triangles.shape[0]):
        for k in range(3):
            begin[min(triangles[t, k], triangles[t, (k + 1) % 3]) + 1] += 1
            met[triangles[t, k]] = 1
    for v in range(1, begin.shape[0]):
        begin[v] += begin[v - 1]
        found[3] += met[v - 1]
    # Filled from the front, so that each beginning moves on to the next one.
    for t in range(triangles.shape[0]):
        for k in range(3):
            a, b = triangles[t, k], triangles[t, (k + 1) % 3]
            ends[begin[min(a, b)]] = max(a, b)
            begin[min(a, b)] += 1
    first = 0
    for v in range(begin.shape[0] - 1):
        last = begin[v]
        gap = 1  # Shell's sort with Knuth's gaps: by insertion where few meet, not quadratic at the apex of a fan
        while 3 * gap < last - first:
            gap = 3 * gap + 1
        while gap > 0:
            for n in range(first + gap, last):
                end = ends[n]
                m = n
                while m >= first + gap and ends[m - gap] > end:
                    ends[m] = ends[m - gap]
                    m -= gap
                ends[m] = end
            gap //= 3
        while first < last:
            n = first
            while n < last and ends[n] == ends[first]:
                n += 1
            found[0] += 1
            found[1] += 1 if n - first == 1 else 0
            found[2] += 1 if n - first > 2 else 0
            first = n


@lean("void(float64[:, ::1], int32[:, ::1], float64[::1])")
def sum_up(places, triangles, found):
    """Six times the volume inside, and twice the area, into ``found`` (2,).

    About the mean of the vertices; partial sums of SUMMED triangles each keep rounding from adding up.
    """
    mx, my, mz = 0.0, 0.0, 0.0
    for v in range(places.shape[0]):
        mx += places[v, 0]
        my += places[v, 1]
        mz += places[v, 2]
    mx, my, mz = mx / places.shape[0], my / places.shape[0], mz / places.shape[0]
    six_volumes, areas = 0.0, 0.0
    for t in range(triangles.shape[0]):
        if t % SUMMED == 0:
            found[0] += six_volumes
            found[1] += areas
            six_volumes, areas = 0.0, 0.0
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax, ay, az = places[a, 0] - mx, places[a, 1] - my, places[a, 2] - mz
        x, y, z = places[b, 0] - places[a, 0], places[b, 1] - places[a, 1], places[b, 2] - places[a, 2]
        u, v, w = places[c, 0] - places[a, 0], places[c, 1] - places[a, 1], places[c, 2] - places[a, 2]
        x, y, z = y * w - z * v, z * u - x * w, x * v - y * u
        six_volumes += ax * x + ay * y + az * z
        areas += (x * x + y * y + z * z) ** 0.5
    found[0] += six_volumes
    found[1] += areas


@inlined
def turn(places, normals, a, b):
    """Difference of two vertices' normals along the side between them [m]."""
    x, y, z = places[b, 0] - places[a, 0], places[b, 1] - places[a, 1], places[b, 2] - places[a, 2]
    return abs(along(normals, b, x, y, z) - along(normals, a, x, y, z))


@lean("void(float64[:, ::1], int32[:, ::1], float64[:, ::1], float64[::1])")
def most_turn(places, triangles, normals, out):
    """The largest ``turn`` along a side of each triangle into ``out`` (t,)."""
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        out[t] = max(max(turn(places, normals, a, b), turn(places, normals, b, c)), turn(places, normals, c, a))


@inlined
def span(places, triangles, t, axis):
    """Least and largest coordinate of a triangle along an axis."""
    a, b, c = places[triangles[t, 0], axis], places[triangles[t, 1], axis], places[triangles[t, 2], axis]
    return min(min(a, b), c), max(max(a, b), c)


@inlined
def parts(low, high, width, count):
    """(first, last + 1) of ``count`` intervals of a width, from 0 on, that low..high meets."""
    if high < 0.0 or low > count * width:
        return 0, 0
    return int(max(low / width, 0.0)), int(min(high / width, count - 1.0)) + 1


@lean("int64(float64[:, ::1], int32[:, ::1], boolean[:, :, ::1], float64[::1], float64, int64[::1])")
def in_cubes(places, triangles, marked, first, width, rows):
    """Write the triangles whose boxes meet marked cubes, from ``first`` (3,) on, to ``rows``; returns how many."""
    count = 0
    for t in range(triangles.shape[0]):
        low, high = span(places, triangles, t, 0)
        i0, i1 = parts(low - first[0], high - first[0], width, marked.shape[0])
        low, high = span(places, triangles, t, 1)
        j0, j1 = parts(low - first[1], high - first[1], width, marked.shape[1])
        low, high = span(places, triangles, t, 2)
        k0, k1 = parts(low - first[2], high - first[2], width, marked.shape[2])
        some = False
        for i in range(i0, i1):
            for j in range(j0, j1):
                for k in range(k0, k1):
                    some = some or marked[i, j, k]
        if some:
            rows[count] = t
            count += 1
    return count


@lean("void(float64[:, ::1], int32[:, ::1], float64[:, ::1], int64[::1], float64[::1], float64, int64, int64[::1])")
def count_passed(places, triangles, points, begin, first, width, row, around):
    """For a ray along x from each of ``points`` (n, 3), add its exits through triangles, less its entries, to
    ``around``.

    Points are sorted into squares of a width by y and z, ``row`` rows of ``row`` from ``first`` (2,) on: those of
    square s are begin[s] to begin[s + 1].
    """
    for t in range(triangles.shape[0]):
        low_y, high_y = span(places, triangles, t, 1)
        low_z, high_z = span(places, triangles, t, 2)
        i0, i1 = parts(low_y - first[0], high_y - first[0], width, row)
        j0, j1 = parts(low_z - first[1], high_z - first[1], width, row)
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        for j in range(j0, j1):
            for i in range(i0, i1):
                for n in range(begin[j * row + i], begin[j * row + i + 1]):
                    x, y, z = points[n, 0], points[n, 1], points[n, 2]
                    if y < low_y or y > high_y or z < low_z or z > high_z:
                        continue
                    ya, yb, yc = places[a, 1] - y, places[b, 1] - y, places[c, 1] - y
                    za, zb, zc = places[a, 2] - z, places[b, 2] - z, places[c, 2] - z
                    # For each vertex, the area of the triangle between the other two and the ray.
                    sa, sb, sc = yb * zc - yc * zb, yc * za - ya * zc, ya * zb - yb * za
                    ahead = sa * (places[a, 0] - x) + sb * (places[b, 0] - x) + sc * (places[c, 0] - x)
                    if sa > 0.0 and sb > 0.0 and sc > 0.0 and ahead > 0.0:
                        around[n] += 1
                    elif sa < 0.0 and sb < 0.0 and sc < 0.0 and ahead < 0.0:
                        around[n] -= 1
