# mypy: ignore-errors
"""Fans in place of coarse triangles whose sides are followed by fine curves."""

from sceneql.compiled.kernels import lean


@lean(
    "UniTuple(int64, 2)(int64[:, ::1], int64[:, ::1], int64[:, ::1], int64, int64, int64[:, ::1], int64[::1],"
    " int64[::1])"
)
def fan(corners, sides, paths, offset, fresh, fans, rings, begin):
    """Write triangles for coarse ones of ``corners`` (m, 3) to ``fans``; returns (how many, number of inner vertices).

    ``sides`` (m, 3): the row of ``paths`` (s, n) that a side follows, or -1; vertices of paths are counted from
    ``offset`` on, and padded with the last. A triangle with one such side gets a fan from its opposite vertex, any
    other one an inner vertex; these are counted from ``fresh`` on, and the ring around number i is written to
    rings[begin[i]:begin[i + 1]].
    """
    count = inner = 0
    last = paths.shape[1] - 1
    for m in range(corners.shape[0]):
        first = begin[inner]
        n = first
        followed = turned = 0
        for turn in range(3):
            rings[n] = corners[m, turn]
            n += 1
            row = sides[m, turn]
            if row < 0:
                continue
            followed += 1
            turned = turn
            for k in range(1, last):
                if paths[row, k] != paths[row, last]:
                    rings[n] = paths[row, k] + offset
                    n += 1
        size = n - first
        apex, at, some = fresh + inner, 0, size
        if followed == 1:
            apex = corners[m, (turned + 2) % 3]
            while rings[first + at] != apex:
                at += 1
            at, some = at + 1, size - 2
        else:
            inner += 1
            begin[inner] = n
        for k in range(some):
            fans[count, 0] = rings[first + (at + k) % size]
            fans[count, 1] = rings[first + (at + k + 1) % size]
            fans[count, 2] = apex
            count += 1
    return count, inner


@lean("void(float64[:, ::1], float64[:, ::1], int64[::1], int64[::1], float64[:, ::1], float64[:, ::1], float64[::1])")
def center(places, normals, rings, begin, means, ways, reach):
    """Means of the places around inner vertices, sums of the normals there, and the farthest of the places from them.

    ``rings`` and ``begin`` (inner + 1,) are as ``fan`` leaves them.
    """
    for m in range(means.shape[0]):
        for axis in range(3):
            means[m, axis] = places[rings[begin[m]], axis]
            ways[m, axis] = normals[rings[begin[m]], axis]
            for n in range(begin[m] + 1, begin[m + 1]):
                means[m, axis] += places[rings[n], axis]
                ways[m, axis] += normals[rings[n], axis]
            means[m, axis] /= begin[m + 1] - begin[m]
        reach[m] = 0.0
        for n in range(begin[m], begin[m + 1]):
            v = rings[n]
            x, y, z = places[v, 0] - means[m, 0], places[v, 1] - means[m, 1], places[v, 2] - means[m, 2]
            reach[m] = max(reach[m], (x * x + y * y + z * z) ** 0.5)


@lean("int64(int64[:, ::1], int32[::1], int32[:, ::1])")
def renumber(triangles, numbers, out):
    """Write triangles whose vertices are counted without those that no triangle has to ``out``; returns how many.

    ``numbers`` (v,), zeros, becomes the new number of each vertex, and -1 of those left out.
    """
    for t in range(triangles.shape[0]):
        for k in range(3):
            numbers[triangles[t, k]] = 1
    count = 0
    for v in range(numbers.shape[0]):
        if numbers[v] == 0:
            numbers[v] = -1
        else:
            numbers[v] = count
            count += 1
    for t in range(triangles.shape[0]):
        for k in range(3):
            out[t, k] = numbers[triangles[t, k]]
    return count
