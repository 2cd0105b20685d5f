# mypy: ignore-errors
"""Pairs of a vertex and a triangle and of two edges of skins: which are near, and what they are like.

All pairs within gap + 2 margin are listed, in the order of their numbers. They hold until a vertex has gone further
than the margin, the mean motion of all vertices aside.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.barrier import pairs_layout as layout
from sceneql.contacts.barrier.distance_kernels import edge_edge, point_triangle
from sceneql.contacts.barrier.on_bodies_kernels import on_body
from sceneql.system.signatures_kernels import A, F, I, N

MARGIN = 0.1
"""The margin in mean sides of triangles, where nothing moves further."""
FREE = 0.9
"""Part of the distance at the start between parts of one solid that counts as a gap where it is less than the gap."""
WIDE = 2.0
"""Margins from which on those beside rigid bodies are looked for anew."""
LEAST = 1e-3
"""Margin in gaps below which no room for the pairs is a failure."""


@lean_inlined
def vertex(ints, k):
    """The place of a vertex's integers."""
    return ints[layout.LIST] + layout.VERTEX * k


@lean_inlined
def corner(ints, f, c):
    """A corner of a triangle, as a vertex."""
    return ints[ints[layout.LIST] + layout.VERTEX * ints[layout.VERTICES] + 3 * f + c]


@lean_inlined
def end(ints, e, c):
    """An end of an edge, as a vertex."""
    first = ints[layout.LIST] + layout.VERTEX * ints[layout.VERTICES] + 3 * ints[layout.TRIANGLES]
    return ints[first + 2 * e + c]


@lean(types.void(A, A, I, N))
def stand(y, floats, ints, first):
    """Write where the vertices are at a state to floats[first:]."""
    for k in range(ints[layout.VERTICES]):
        at, to = vertex(ints, k), first + 3 * k
        if ints[at + layout.ARM] < 0:
            p = ints[at]
            floats[to], floats[to + 1], floats[to + 2] = y[p], y[p + 1], y[p + 2]
        else:
            floats[to], floats[to + 1], floats[to + 2] = on_body(y, floats, ints, at)


@lean_inlined
def mean_motion(floats, ints, first):
    """Of all vertices since pairs were looked for."""
    u = v = w = 0.0
    at, count = ints[layout.MEMORY] + layout.AT, ints[layout.VERTICES]
    for k in range(count):
        p = first + 3 * k
        u += floats[p] - floats[at + 3 * k]
        v += floats[p + 1] - floats[at + 3 * k + 1]
        w += floats[p + 2] - floats[at + 3 * k + 2]
    return u / count, v / count, w / count


@lean(F(A, I, N))
def gone(floats, ints, first):
    """How far a vertex has gone since pairs were looked for, at most [m]; they are where floats[first:] say."""
    u, v, w = mean_motion(floats, ints, first)
    at, most = ints[layout.MEMORY] + layout.AT, 0.0
    for k in range(ints[layout.VERTICES]):
        p = first + 3 * k
        a = floats[p] - floats[at + 3 * k] - u
        b = floats[p + 1] - floats[at + 3 * k + 1] - v
        c = floats[p + 2] - floats[at + 3 * k + 2] - w
        square = a * a + b * b + c * c
        if not square <= most:
            most = square
    return math.sqrt(most)


@lean_inlined
def cell(ints, size, x, y, z):
    """The cell of the hashed grid that a place lies in."""
    i, j, k = math.floor(x / size), math.floor(y / size), math.floor(z / size)
    return (i * 73856093 ^ j * 19349663 ^ k * 83492791) % ints[layout.CELLS]


@lean_inlined
def sort_tail(floats, first, count):
    """Sort the second numbers of pairs [first number, second] by insertion; few pairs share their first."""
    for m in range(1, count):
        value, k = floats[first + 2 * m + 1], m
        while k > 0 and floats[first + 2 * k - 1] > value:
            floats[first + 2 * k + 1] = floats[first + 2 * k - 1]
            k -= 1
        floats[first + 2 * k + 1] = value


@lean_inlined
def fill(floats, ints, size, edges):
    """Sort vertices, or middles of edges, into the cells: starts of the cells, then the sorted numbers."""
    grid, cells, at = ints[layout.GRID_AT], ints[layout.CELLS], ints[layout.MEMORY] + layout.AT
    count = ints[layout.EDGES] if edges else ints[layout.VERTICES]
    for k in range(cells + 1):
        floats[grid + k] = 0.0
    numbers = grid + cells + 1
    for turn in range(2):
        for m in range(count):
            k = count - 1 - m if turn == 1 else m
            a = at + 3 * (end(ints, k, 0) if edges else k)
            b = at + 3 * (end(ints, k, 1) if edges else k)
            x, y, z = (
                0.5 * (floats[a] + floats[b]),
                0.5 * (floats[a + 1] + floats[b + 1]),
                0.5 * (floats[a + 2] + floats[b + 2]),
            )
            c = cell(ints, size, x, y, z)
            if turn == 0:
                floats[grid + c] += 1.0
            else:
                floats[grid + c] -= 1.0
                floats[numbers + int(floats[grid + c])] = k
        if turn == 0:
            total = 0.0
            for k in range(cells + 1):
                total += floats[grid + k]
                floats[grid + k] = total
    return numbers


@lean_inlined
def meets(floats, ints, at, edges, f, m, a, b, c, box, reach):
    """Whether a vertex or edge m is none of triangle or edge f (a, b, c), comes behind it, and meets its box.

    No two places of one rigid body ever meet. Those of a round one are so many beside the skins' triangles that their
    distances are looked at, too.
    """
    d, e = end(ints, m, 0) if edges else m, end(ints, m, 1) if edges else m
    if (edges and m <= f) or d == a or d == b or d == c or e == a or e == b or e == c:
        return False
    own, other = vertex(ints, d), vertex(ints, a)
    if ints[own + layout.BODY] < 0 and ints[own + layout.BODY] == ints[other + layout.BODY]:
        return False
    u, v = at + 3 * d, at + 3 * e
    for k in range(3):
        if max(floats[u + k], floats[v + k]) < box[2 * k] or min(floats[u + k], floats[v + k]) > box[2 * k + 1]:
            return False
    if ints[own + layout.BODY] >= 0 and ints[other + layout.BODY] >= 0:
        return True
    if edges:
        return edge_edge(floats, at + 3 * a, at + 3 * b, u, v)[0] <= reach
    return point_triangle(floats, u, at + 3 * a, at + 3 * b, at + 3 * c)[0] <= reach


@lean(N(A, I, F, types.boolean))
def gather(floats, ints, reach, edges):
    """List pairs whose boxes are within reach, of edges or of vertices and triangles; -1 where there is no room."""
    at, grid = ints[layout.MEMORY] + layout.AT, ints[layout.GRID_AT]
    longest = 0.0
    if edges:
        for e in range(ints[layout.EDGES]):
            a, b = at + 3 * end(ints, e, 0), at + 3 * end(ints, e, 1)
            u, v, w = floats[b] - floats[a], floats[b + 1] - floats[a + 1], floats[b + 2] - floats[a + 2]
            longest = max(longest, 0.5 * math.sqrt(u * u + v * v + w * w))
    size = max(floats[ints[layout.NUMBERS] + layout.SIDE], reach + longest)
    numbers = fill(floats, ints, size, edges)
    first = ints[layout.EDGES_AT] if edges else ints[layout.POINTS_AT]
    most = ints[layout.MOST_EDGES] if edges else ints[layout.MOST_POINTS]
    found, count = 0, ints[layout.EDGES] if edges else ints[layout.VERTICES]
    for f in range(ints[layout.EDGES] if edges else ints[layout.TRIANGLES]):
        a = end(ints, f, 0) if edges else corner(ints, f, 0)
        b = end(ints, f, 1) if edges else corner(ints, f, 1)
        c = b if edges else corner(ints, f, 2)
        i, j, k = at + 3 * a, at + 3 * b, at + 3 * c
        x0, x1 = min(floats[i], min(floats[j], floats[k])) - reach, max(floats[i], max(floats[j], floats[k])) + reach
        i, j, k = i + 1, j + 1, k + 1
        y0, y1 = min(floats[i], min(floats[j], floats[k])) - reach, max(floats[i], max(floats[j], floats[k])) + reach
        i, j, k = i + 1, j + 1, k + 1
        z0, z1 = min(floats[i], min(floats[j], floats[k])) - reach, max(floats[i], max(floats[j], floats[k])) + reach
        mine = found
        box = (x0, x1, y0, y1, z0, z1)
        wide = (1.0 + (x1 - x0 + 2.0 * longest) / size) * (1.0 + (y1 - y0 + 2.0 * longest) / size)
        if not wide * (1.0 + (z1 - z0 + 2.0 * longest) / size) < count:
            # A triangle that a stage's state has torn wide open spans more cells than there are vertices.
            for m in range(count):
                if meets(floats, ints, at, edges, f, m, a, b, c, box, reach):
                    if found == most:
                        return -1
                    floats[first + 2 * found] = f
                    floats[first + 2 * found + 1] = m
                    found += 1
            continue
        p0, p1 = math.floor((x0 - longest) / size), math.floor((x1 + longest) / size)
        q0, q1 = math.floor((y0 - longest) / size), math.floor((y1 + longest) / size)
        r0, r1 = math.floor((z0 - longest) / size), math.floor((z1 + longest) / size)
        for p in range(p0, p1 + 1):
            for q in range(q0, q1 + 1):
                for r in range(r0, r1 + 1):
                    h = (p * 73856093 ^ q * 19349663 ^ r * 83492791) % ints[layout.CELLS]
                    for n in range(int(floats[grid + h]), int(floats[grid + h + 1])):
                        m = int(floats[numbers + n])
                        u, v = at + 3 * (end(ints, m, 0) if edges else m), at + 3 * (end(ints, m, 1) if edges else m)
                        mx, my, mz = (
                            0.5 * (floats[u] + floats[v]),
                            0.5 * (floats[u + 1] + floats[v + 1]),
                            0.5 * (floats[u + 2] + floats[v + 2]),
                        )
                        # A place in another cell of the same hash is found there.
                        if math.floor(mx / size) != p or math.floor(my / size) != q or math.floor(mz / size) != r:
                            continue
                        if not meets(floats, ints, at, edges, f, m, a, b, c, box, reach):
                            continue
                        if found == most:
                            return -1
                        floats[first + 2 * found] = f
                        floats[first + 2 * found + 1] = m
                        found += 1
        sort_tail(floats, first + 2 * mine, found - mine)
    return found


@lean(F(A, I, F))
def look(floats, ints, margin):
    """List the pairs that are near where vertices are NOW; the margin that there was room for."""
    memory, now = ints[layout.MEMORY], ints[layout.NOW]
    for k in range(3 * ints[layout.VERTICES]):
        floats[memory + layout.AT + k] = floats[now + k]
        if not abs(floats[now + k]) < 1e30:
            floats[memory + layout.BUILT] = 0.0
            return 0.0
    gap = floats[ints[layout.NUMBERS] + layout.GAP]
    while margin > LEAST * gap:
        points = gather(floats, ints, gap + 2.0 * margin, False)
        edges = gather(floats, ints, gap + 2.0 * margin, True) if points >= 0 else -1
        if edges >= 0:
            floats[memory + layout.POINT_PAIRS] = points
            floats[memory + layout.EDGE_PAIRS] = edges
            floats[memory + layout.MARGIN] = margin
            floats[memory + layout.BUILT] = 1.0
            return margin
        margin *= 0.5
    floats[memory + layout.BUILT] = 0.0
    floats[memory + layout.CROWDED] += 1.0
    return 0.0


@lean(types.boolean(A, A, I))
def known(y, floats, ints):
    """See to it that vertices are NOW where they are at a state, and that the list of pairs holds there; False where
    there is no room, or the state is not finite."""
    memory, now = ints[layout.MEMORY], ints[layout.NOW]
    margin = MARGIN * floats[ints[layout.NUMBERS] + layout.SIDE]
    stand(y, floats, ints, now)
    if floats[memory + layout.BUILT] == 1.0 and gone(floats, ints, now) <= floats[memory + layout.MARGIN]:
        # The list of a long way would stay for many steps: of round bodies, whose triangles are many, it is a long one.
        if ints[layout.RIGID] == 0 or floats[memory + layout.MARGIN] <= WIDE * margin:
            return True
    return look(floats, ints, margin) > 0.0
