# mypy: ignore-errors
"""Where the vertices of skins in flows are near one another's faces, and their own: by a grid of cells."""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.barrier.distance_kernels import point_triangle
from sceneql.skins.touch import touch_pairs_layout as layout
from sceneql.system.signatures_kernels import A, F, I, N

AHEAD = 1.5
"""How much farther than asked for is looked at where nothing was near, so that it need not be looked at soon again."""
LARGEST = 1e4
"""Of GONE, in gaps."""
TOUCHING = 0.8
"""Part of what is asked for up to which something is so near that it will be for some time."""


@lean_inlined
def vertex(ints, p):
    """Where the integers of a vertex begin."""
    return layout.HEAD + layout.VERTEX * p


@lean_inlined
def corner(ints, f, k):
    """A corner of a face."""
    return ints[layout.HEAD + layout.VERTEX * ints[layout.VERTICES] + ints[layout.CORNERS] * f + k]


@lean_inlined
def cell_of(y, floats, ints, at, axis):
    """The cell along an axis of the place y[at : at + 3], whole and inside the grid."""
    room = ints[layout.ROOM]
    place = (y[at + axis] - floats[room + layout.LOW + axis]) * floats[room + layout.SCALE]
    return min(max(int(place), 0), int(floats[room + layout.ACROSS + axis]) - 1)


@lean(types.void(A, A, I, F), inner=True)
def lay(y, floats, ints, reach):
    """Put all vertices into the cells of a grid, whose sides are at least ``reach`` and the longest side of a face.

    Places that are not finite give no cells: every side is then 0.
    """
    room, count, corners = ints[layout.ROOM], ints[layout.VERTICES], ints[layout.CORNERS]
    longest, finite = 0.0, True
    for f in range(ints[layout.FACES]):
        for k in range(corners):
            a = ints[vertex(ints, corner(ints, f, k)) + layout.POSITION]
            b = ints[vertex(ints, corner(ints, f, (k + 1) % corners)) + layout.POSITION]
            u, v, w = y[b] - y[a], y[b + 1] - y[a + 1], y[b + 2] - y[a + 2]
            longest = max(longest, u * u + v * v + w * w)
            finite &= math.isfinite(u + v + w)
    longest = math.sqrt(longest)
    floats[ints[layout.NUMBERS] + layout.SIDE] = longest
    side, cells = max(reach + longest, 1e-300), 1.0
    for axis in range(3):
        low, high = math.inf, -math.inf
        for p in range(count):
            place = y[ints[vertex(ints, p) + layout.POSITION] + axis]
            low, high = min(low, place), max(high, place)
        floats[room + layout.LOW + axis], floats[room + layout.ACROSS + axis] = low, high - low
        finite &= math.isfinite(high - low)
    for axis in range(3):
        cells *= floats[room + layout.ACROSS + axis] / side + 1.0 if finite else 0.0
    if cells > layout.CELLS * count:
        side *= (cells / (layout.CELLS * count)) ** 0.5 + 1.0
    floats[room + layout.SCALE] = 1.0 / side
    whole = 1
    for axis in range(3):
        across = int(floats[room + layout.ACROSS + axis] / side) + 1 if finite else 0
        floats[room + layout.ACROSS + axis] = across
        whole *= across
    starts = room + layout.STARTS
    listed = starts + layout.CELLS * count + 1
    for cell in range(whole + 1):
        floats[starts + cell] = 0.0
    if whole == 0:
        return
    nx, ny = int(floats[room + layout.ACROSS]), int(floats[room + layout.ACROSS + 1])
    for turn in range(2):
        for p in range(count):
            at = ints[vertex(ints, p) + layout.POSITION]
            i, j, k = (
                cell_of(y, floats, ints, at, 0),
                cell_of(y, floats, ints, at, 1),
                cell_of(y, floats, ints, at, 2),
            )
            cell = i + nx * (j + ny * k)
            if turn == 0:
                floats[starts + cell] += 1.0
            else:
                floats[starts + cell] -= 1.0
                floats[listed + int(floats[starts + cell])] = p
        if turn == 0:
            for cell in range(1, whole + 1):
                floats[starts + cell] += floats[starts + cell - 1]


@lean_inlined
def between(y, ints, p, f):
    """Distance of a vertex from a face, the normal towards the vertex (3), weights of its corners (3)."""
    at = ints[vertex(ints, p) + layout.POSITION]
    a = ints[vertex(ints, corner(ints, f, 0)) + layout.POSITION]
    b = ints[vertex(ints, corner(ints, f, 1)) + layout.POSITION]
    if ints[layout.CORNERS] == 3:
        return point_triangle(y, at, a, b, ints[vertex(ints, corner(ints, f, 2)) + layout.POSITION])
    u, v = y[b] - y[a], y[b + 1] - y[a + 1]
    x, z = y[at] - y[a], y[at + 1] - y[a + 1]
    square = u * u + v * v
    part = min(1.0, max(0.0, (u * x + v * z) / square)) if square > 0.0 else 0.0
    x, z = x - part * u, z - part * v
    d = math.sqrt(x * x + z * z)
    scale = 1.0 / d if d > 0.0 else 0.0
    return d, scale * x, scale * z, 0.0, 1.0 - part, part, 0.0


@lean_inlined
def near_at_start(floats, ints, p, q):
    """Whether two vertices of one skin were near each other."""
    rest, apart = ints[layout.REST], layout.APART * floats[ints[layout.NUMBERS] + layout.GAP]
    square = 0.0
    for k in range(3):
        way = floats[rest + 3 * p + k] - floats[rest + 3 * q + k]
        square += way * way
    return square < apart * apart


@lean_inlined
def parted(y, changed, ints, p, f):
    """How far at most a vertex and a place of a face go relative to each other in a change [m]."""
    at, most = ints[vertex(ints, p) + layout.POSITION], 0.0
    for k in range(ints[layout.CORNERS]):
        to, square = ints[vertex(ints, corner(ints, f, k)) + layout.POSITION], 0.0
        for axis in range(3):
            way = changed[at + axis] - y[at + axis] - changed[to + axis] + y[to + axis]
            square += way * way
        most = max(most, square)
    return math.sqrt(most)


@lean(types.void(A, A, A, I, N, F, types.boolean), inner=True)
def search(y, changed, floats, ints, p, reach, own_place):
    """Write down the BEST that is nearer than so far; ``own_place``: the vertex is where it is, and not periods off."""
    room, best, own = ints[layout.ROOM], ints[layout.BEST], vertex(ints, p)
    count, corners, at = ints[layout.VERTICES], ints[layout.CORNERS], ints[own + layout.POSITION]
    nx, ny, nz = (
        int(floats[room + layout.ACROSS]),
        int(floats[room + layout.ACROSS + 1]),
        int(floats[room + layout.ACROSS + 2]),
    )
    starts = room + layout.STARTS
    listed = starts + layout.CELLS * count + 1
    at_faces = layout.HEAD + layout.VERTEX * count + corners * ints[layout.FACES]
    far = reach + floats[ints[layout.NUMBERS] + layout.SIDE]
    i, j, k = (cell_of(y, floats, ints, at, 0), cell_of(y, floats, ints, at, 1), cell_of(y, floats, ints, at, 2))
    for c in range(max(k - 1, 0), min(k + 2, nz)):
        for b in range(max(j - 1, 0), min(j + 2, ny)):
            row = nx * (b + ny * c)
            first, last = row + max(i - 1, 0), row + min(i + 2, nx)
            for place in range(int(floats[starts + first]), int(floats[starts + last])):
                q = int(floats[listed + place])
                other = vertex(ints, q)
                there, s = ints[other + layout.POSITION], ints[other + layout.SKIN]
                mine = own_place and s == ints[own + layout.SKIN]
                u, v, w = y[there] - y[at], y[there + 1] - y[at + 1], y[there + 2] - y[at + 2]
                if u * u + v * v + w * w > far * far or (mine and near_at_start(floats, ints, p, q)):
                    continue
                found = best + layout.FOUND * s
                for n in range(ints[at_faces + q], ints[at_faces + q + 1]):
                    f = ints[at_faces + count + 1 + n]
                    beside = False
                    for m in range(1, corners if mine else 0):
                        beside |= near_at_start(floats, ints, p, corner(ints, f, m))
                    if beside:
                        continue
                    d, x, y_, z, w0, w1, w2 = between(y, ints, p, f)
                    if not d < reach:
                        continue
                    if changed.size > 0:
                        way = parted(y, changed, ints, p, f)
                        d = d / way if way > 0.0 else math.inf
                    if d < floats[found]:
                        floats[found], floats[found + layout.FACE] = d, f
                        n0, s0 = found + layout.NORMAL, found + layout.SHARES
                        floats[n0], floats[n0 + 1], floats[n0 + 2] = x, y_, z
                        floats[s0], floats[s0 + 1], floats[s0 + 2] = w0, w1, w2


@lean_inlined
def images(y, floats, ints, at, axis, reach):
    """Along an axis the first and the last number of periods by which a place is brought near where vertices are."""
    period = floats[ints[layout.NUMBERS] + layout.PERIODS + axis]
    if period == 0.0:
        return 0, 0
    room = ints[layout.ROOM]
    low = floats[room + layout.LOW + axis] - reach
    high = floats[room + layout.LOW + axis] + floats[room + layout.ACROSS + axis] / floats[room + layout.SCALE] + reach
    return math.ceil((low - y[at + axis]) / period), math.floor((high - y[at + axis]) / period)


@lean(types.void(A, A, A, I, N, F), inner=True)
def look(y, changed, floats, ints, p, reach):
    """Write down the BEST of each skin that is nearer to a vertex than ``reach``; of others its distance is infinite.

    Where ``changed`` is not empty, in place of the least distance the least part of that change in which it is gone.
    Where the flow is periodic the vertex is looked at from all places that it has.
    """
    room, best, at = ints[layout.ROOM], ints[layout.BEST], ints[vertex(ints, p) + layout.POSITION]
    for s in range(ints[layout.SKINS]):
        floats[best + layout.FOUND * s] = math.inf
    if floats[room + layout.ACROSS] == 0.0:
        return
    far = reach + floats[ints[layout.NUMBERS] + layout.SIDE]
    goes = changed.size > 0
    x, y_, z = y[at], y[at + 1], y[at + 2]
    u, v, w = (changed[at], changed[at + 1], changed[at + 2]) if goes else (0.0, 0.0, 0.0)
    periods = ints[layout.NUMBERS] + layout.PERIODS
    first_i, last_i = images(y, floats, ints, at, 0, far)
    first_j, last_j = images(y, floats, ints, at, 1, far)
    first_k, last_k = images(y, floats, ints, at, 2, far)
    for k in range(first_k, last_k + 1):
        for j in range(first_j, last_j + 1):
            for i in range(first_i, last_i + 1):
                a, b, c = i * floats[periods], j * floats[periods + 1], k * floats[periods + 2]
                y[at], y[at + 1], y[at + 2] = x + a, y_ + b, z + c
                if goes:
                    changed[at], changed[at + 1], changed[at + 2] = u + a, v + b, w + c
                search(y, changed, floats, ints, p, reach, i == 0 and j == 0 and k == 0)
    y[at], y[at + 1], y[at + 2] = x, y_, z
    if goes:
        changed[at], changed[at + 1], changed[at + 2] = u, v, w


@lean_inlined
def go(y, floats, ints):
    """Let GONE grow by how far vertices have gone since it grew last; where it gets too large for its digits it begins
    anew, with nothing known."""
    count, clear, numbers = ints[layout.VERTICES], ints[layout.CLEAR], ints[layout.NUMBERS]
    u = v = w = 0.0
    for p in range(count):
        at, there = ints[vertex(ints, p) + layout.POSITION], clear + layout.BOUNDS * p + layout.PLACES
        u, v, w = u + y[at] - floats[there], v + y[at + 1] - floats[there + 1], w + y[at + 2] - floats[there + 2]
    u, v, w = u / count, v / count, w / count
    square = 0.0
    for p in range(count):
        at, there = ints[vertex(ints, p) + layout.POSITION], clear + layout.BOUNDS * p + layout.PLACES
        a, b, c = y[at] - floats[there] - u, y[at + 1] - floats[there + 1] - v, y[at + 2] - floats[there + 2] - w
        way = a * a + b * b + c * c
        square = max(square, way if way < math.inf else math.inf)
        floats[there], floats[there + 1], floats[there + 2] = y[at], y[at + 1], y[at + 2]
    floats[numbers + layout.GONE] += math.sqrt(square)
    if floats[numbers + layout.GONE] > LARGEST * floats[numbers + layout.GAP]:
        floats[numbers + layout.GONE] = 0.0
        for p in range(count):
            floats[clear + layout.BOUNDS * p + layout.BOUND] = math.nan


@lean_inlined
def known(floats, ints, p):
    """Less than how far off a vertex nothing is, as far as known; NaN where nothing is [m]."""
    bound = floats[ints[layout.CLEAR] + layout.BOUNDS * p + layout.BOUND]
    return bound - 2.0 * floats[ints[layout.NUMBERS] + layout.GONE]


@lean_inlined
def lay_where_near(y, floats, ints, reach):
    """`lay` for `is_near`, unless nothing is known to be nearer to any vertex than ``reach``; whether it is laid."""
    go(y, floats, ints)
    for p in range(ints[layout.VERTICES]):
        if not known(floats, ints, p) >= reach:
            lay(y, floats, ints, AHEAD * reach)
            return True
    return False


@lean(types.boolean(A, A, I, N, F), inner=True)
def is_near(y, floats, ints, p, reach):
    """Whether something is nearer to a vertex than ``reach``, and then the BEST of each skin."""
    before = known(floats, ints, p)
    if before >= reach:
        return False
    wide = AHEAD * reach if not before < TOUCHING * reach else reach
    look(y, y[:0], floats, ints, p, wide)
    least = wide
    for s in range(ints[layout.SKINS]):
        least = min(least, floats[ints[layout.BEST] + layout.FOUND * s])
    at = ints[layout.CLEAR] + layout.BOUNDS * p + layout.BOUND
    floats[at] = least + 2.0 * floats[ints[layout.NUMBERS] + layout.GONE]
    return least < reach
