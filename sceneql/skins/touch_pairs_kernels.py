# mypy: ignore-errors
"""The contact of skins in flows with one another, and of a skin with itself: a barrier of short range, and friction.

Each vertex is pushed off the nearest place of each other skin, and of its own beyond what was near at the start, with
half of its share of area: the other half is that of the vertices there.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.barrier.distance_kernels import point_triangle
from sceneql.skins import touch_pairs_layout as layout
from sceneql.skins.touch_push_kernels import push
from sceneql.system.signatures_kernels import LIMIT, TERM, A, F, I, N

KEPT = 0.9
"""Part of a distance that a step may go."""


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


@lean(types.void(A, A, A, I, N, F), inner=True)
def look(y, changed, floats, ints, p, reach):
    """Write down the BEST of each skin that is nearer to a vertex than ``reach``; of others its distance is infinite.

    Where ``changed`` is not empty, in place of the least distance the least part of that change in which it is gone.
    """
    room, best, own = ints[layout.ROOM], ints[layout.BEST], vertex(ints, p)
    count, corners, at = ints[layout.VERTICES], ints[layout.CORNERS], ints[own + layout.POSITION]
    for s in range(ints[layout.SKINS]):
        floats[best + layout.FOUND * s] = math.inf
    nx, ny, nz = (
        int(floats[room + layout.ACROSS]),
        int(floats[room + layout.ACROSS + 1]),
        int(floats[room + layout.ACROSS + 2]),
    )
    if nx == 0:
        return
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
                mine = s == ints[own + layout.SKIN]
                if mine and near_at_start(floats, ints, p, q):
                    continue
                u, v, w = y[there] - y[at], y[there + 1] - y[at + 1], y[there + 2] - y[at + 2]
                if u * u + v * v + w * w > far * far:
                    continue
                found = best + layout.FOUND * s
                for n in range(ints[at_faces + q], ints[at_faces + q + 1]):
                    f = ints[at_faces + count + 1 + n]
                    beside = False
                    for m in range(corners if mine else 0):
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


@lean(TERM, inner=True)
def force(t, y, rate, floats, ints):
    """Adds to the forces of the vertices what keeps skins apart, and friction [N]; their sum is 0."""
    numbers, weights, friction = ints[layout.NUMBERS], ints[layout.WEIGHTS], floats[ints[layout.FRICTION]]
    gap, corners = floats[numbers + layout.GAP], ints[layout.CORNERS]
    lay(y, floats, ints, gap)
    for p in range(ints[layout.VERTICES]):
        look(y, y[:0], floats, ints, p, gap)
        own = vertex(ints, p)
        for s in range(ints[layout.SKINS]):
            found = ints[layout.BEST] + layout.FOUND * s
            if not floats[found] < gap:
                continue
            f, n = int(floats[found + layout.FACE]), found + layout.NORMAL
            area = 0.5 * floats[weights + 2 * p]
            stiffness = min(floats[weights + 2 * p + 1], floats[weights + 2 * corner(ints, f, 0) + 1])
            pressed = area * stiffness * push(floats[found] / gap, floats[numbers + layout.STEEP])
            x, y_, z = pressed * floats[n], pressed * floats[n + 1], pressed * floats[n + 2]
            if friction > 0.0:
                at = ints[own + layout.POSITION]
                u, v, w = rate[at], rate[at + 1], rate[at + 2]
                for k in range(corners):
                    other = ints[vertex(ints, corner(ints, f, k)) + layout.POSITION]
                    share = floats[found + layout.SHARES + k]
                    u, v, w = u - share * rate[other], v - share * rate[other + 1], w - share * rate[other + 2]
                along = u * floats[n] + v * floats[n + 1] + w * floats[n + 2]
                u, v, w = u - along * floats[n], v - along * floats[n + 1], w - along * floats[n + 2]
                drag, speed = area * floats[numbers + layout.IMPEDANCE], math.sqrt(u * u + v * v + w * w)
                if drag * speed > friction * pressed:
                    drag = friction * pressed / speed
                x, y_, z = x - drag * u, y_ - drag * v, z - drag * w
            at = ints[own + layout.FORCE]
            floats[at] += x
            floats[at + 1] += y_
            floats[at + 2] += z
            for k in range(corners):
                at, share = ints[vertex(ints, corner(ints, f, k)) + layout.FORCE], floats[found + layout.SHARES + k]
                floats[at] -= share * x
                floats[at + 1] -= share * y_
                floats[at + 2] -= share * z


@lean(LIMIT, inner=True)
def limit(t, y, changed, floats, ints):
    """The largest part of a change in which no vertex reaches a face, however both go to their ends."""
    farthest, part = 0.0, 1.0
    for p in range(ints[layout.VERTICES]):
        at = ints[vertex(ints, p) + layout.POSITION]
        u, v, w = changed[at] - y[at], changed[at + 1] - y[at + 1], changed[at + 2] - y[at + 2]
        way = math.sqrt(u * u + v * v + w * w)
        if not way < math.inf:
            return 0.0
        farthest = max(farthest, way)
    reach = 2.0 * farthest / KEPT
    lay(y, floats, ints, reach)
    for p in range(ints[layout.VERTICES]):
        look(y, changed, floats, ints, p, reach)
        for s in range(ints[layout.SKINS]):
            part = min(part, KEPT * floats[ints[layout.BEST] + layout.FOUND * s])
    return part
