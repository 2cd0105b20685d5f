# mypy: ignore-errors
"""The border of fine triangles on the faces of refined groups: its sides, and the curves that they form."""

from sceneql.compiled.kernels import lean
from sceneql.mesh.cubes.grid import BLOCK


@lean("int64(int32[:, ::1], boolean[::1], int32[::1], int32[::1], int64[::1], int64[::1])")
def open_sides(triangles, at, begin, ends, starts, stops):
    """Write the sides with a triangle on one side only, reversed as the missing one has them; returns how many.

    Only sides with both ends in the mask ``at`` (v,) are looked at. ``begin`` (v + 2,), zeros, and ``ends`` (3 t,) are
    working memory: the sides by the vertex at which they begin.
    """
    for t in range(triangles.shape[0]):
        for k in range(3):
            a, b = triangles[t, k], triangles[t, (k + 1) % 3]
            if at[a] and at[b]:
                begin[a + 2] += 1
    for v in range(2, begin.shape[0]):
        begin[v] += begin[v - 1]
    for t in range(triangles.shape[0]):
        for k in range(3):
            a, b = triangles[t, k], triangles[t, (k + 1) % 3]
            if at[a] and at[b]:
                ends[begin[a + 1]] = b
                begin[a + 1] += 1
    count = 0
    for t in range(triangles.shape[0]):
        for k in range(3):
            a, b = triangles[t, k], triangles[t, (k + 1) % 3]
            if not (at[a] and at[b]):
                continue
            single = True
            for n in range(begin[b], begin[b + 1]):
                single = single and ends[n] != a
            if single:
                starts[count] = b
                stops[count] = a
                count += 1
    return count


@lean("UniTuple(int64, 2)(int64[::1], int64[::1], boolean[::1], int32[::1], int64[:, ::1], boolean[::1])")
def follow(starts, stops, on_edge, following, paths, followed):
    """Write the paths from side to side between vertices ``on_edge`` (v,), in the order of the sides that begin there,
    padded with their last vertex; returns (how many, length of the longest).

    Through any other vertex one path passes. ``following`` (v,) is working memory; ``followed`` (v,), False, becomes
    True for vertices of paths. ``paths`` has a row of each path and room for some vertices: if the longest are longer,
    they end early.
    """
    for n in range(starts.shape[0]):
        following[stops[n]] = -1
    for n in range(starts.shape[0]):
        if not on_edge[starts[n]]:
            following[starts[n]] = stops[n]
    count = longest = 0
    room = paths.shape[1]
    for n in range(starts.shape[0]):
        if not on_edge[starts[n]]:
            continue
        v, length = starts[n], 0
        while True:
            followed[v] = True
            if length < room:
                paths[count, length] = v
            length += 1
            after = stops[n] if length == 1 else following[v]
            if (length > 1 and on_edge[v]) or after < 0 or length > starts.shape[0]:
                break
            v = after
        for rest in range(length, room):
            paths[count, rest] = v
        longest = max(longest, length)
        count += 1
    return count, longest


@lean("void(int32[:, ::1], int64[::1], int16[::1], int64[:, ::1])")
def double(blocks, begin, keys, doubled):
    """Midpoints of the grid edges with the vertices of blocks (b, 3) into ``doubled`` (v, 3), in half cells.

    The vertices of block b are begin[b] to begin[b + 1], their edges have the numbers ``keys`` (v,) in it.
    """
    for b in range(blocks.shape[0]):
        for v in range(begin[b], begin[b + 1]):
            axis = keys[v] % 3
            at = keys[v] // 3
            doubled[v, 0] = 2 * (BLOCK * blocks[b, 0] + at % BLOCK) + (1 if axis == 0 else 0)
            doubled[v, 1] = 2 * (BLOCK * blocks[b, 1] + at // BLOCK % BLOCK) + (1 if axis == 1 else 0)
            doubled[v, 2] = 2 * (BLOCK * blocks[b, 2] + at // BLOCK**2) + (1 if axis == 2 else 0)


@lean("void(int64[:, ::1], int64, int64, boolean[::1], boolean[::1])")
def mark_borders(doubled, cell, group, on_edge, on_group):
    """Mark vertices (v,) on edges of cells, and on faces of groups, whose sides are so many half fine cells."""
    for v in range(doubled.shape[0]):
        x, y, z = doubled[v, 0], doubled[v, 1], doubled[v, 2]
        on_edge[v] = (1 if x % cell == 0 else 0) + (1 if y % cell == 0 else 0) + (1 if z % cell == 0 else 0) == 2
        on_group[v] = x % group == 0 or y % group == 0 or z % group == 0
