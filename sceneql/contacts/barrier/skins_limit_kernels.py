# mypy: ignore-errors
"""How far skins may go before they meet, by additive continuous detection.

A vertex of a rigid body goes with its center in a line, and turns about it.

Source: Li, Kaufman & Jiang (2021), Codimensional incremental potential contact, ACM Trans. Graph. 40, 170.
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.barrier import pairs_layout as layout
from sceneql.contacts.barrier.distance_kernels import edge_edge, point_triangle
from sceneql.contacts.barrier.on_bodies_kernels import swept, turned
from sceneql.contacts.barrier.pair_weights_kernels import listed, node
from sceneql.contacts.barrier.pairs_kernels import MARGIN, gone, look, stand, vertex
from sceneql.system.signatures_kernels import LIMIT

LEFT = 0.01
"""Part of the distance at the start that is left where a way ends."""
MOST = 200
"""Advances on a way."""
SLACK = 1.05
"""Margin over the largest way of a vertex."""


@lean_inlined
def apart(floats, at, edges):
    """The distance of the four places in the scratch at floats[at:]."""
    if edges:
        return edge_edge(floats, at, at + 3, at + 6, at + 9)[0]
    return point_triangle(floats, at, at + 3, at + 6, at + 9)[0]


@lean_inlined
def way_of(y, changed, floats, ints, k):
    """The change of the place of vertex k, and how far turning takes it besides; of a body that of its center."""
    at, count, now = vertex(ints, k), ints[layout.VERTICES], ints[layout.NOW]
    p, q = now + 3 * k, now + 3 * (count + k)
    if ints[at + layout.ARM] < 0:
        return floats[q] - floats[p], floats[q + 1] - floats[p + 1], floats[q + 2] - floats[p + 2], 0.0
    p = ints[at]
    return changed[p] - y[p], changed[p + 1] - y[p + 1], changed[p + 2] - y[p + 2], floats[now + 6 * count + k]


@lean_inlined
def advance(y, changed, floats, ints, m, edges, part):
    """The part of the way, up to ``part``, that a pair stays apart.

    A distance changes by no more than the largest ways on both sides together, the mean motion of the four aside.
    """
    at, now = ints[layout.MEMORY] + layout.SCRATCH, ints[layout.NOW]
    u = v = w = 0.0
    for k in range(4):
        i = node(floats, ints, m, edges, k)
        for c in range(3):
            floats[at + 3 * k + c] = floats[now + 3 * i + c]
        a, b, c, _ = way_of(y, changed, floats, ints, i)
        u, v, w = u + 0.25 * a, v + 0.25 * b, w + 0.25 * c
    first = second = 0.0
    for k in range(4):
        a, b, c, more = way_of(y, changed, floats, ints, node(floats, ints, m, edges, k))
        a, b, c = a - u, b - v, c - w
        way = math.sqrt(a * a + b * b + c * c) + more
        if k == 0 or (edges and k == 1):
            first = max(first, way)
        else:
            second = max(second, way)
    way = first + second
    if way == 0.0:
        return part
    d = apart(floats, at, edges)
    least, done = LEFT * d, 0.0
    for _ in range(MOST):
        if way * (part - done) <= d - least:
            return part
        done += (d - least) / way
        for k in range(4):
            i = node(floats, ints, m, edges, k)
            own, to = vertex(ints, i), at + 3 * k
            if ints[own + layout.ARM] >= 0:
                a, b, c = swept(y, changed, floats, ints, own, done)
                floats[to], floats[to + 1], floats[to + 2] = a - done * u, b - done * v, c - done * w
                continue
            a, b, c, _ = way_of(y, changed, floats, ints, i)
            p = now + 3 * i
            floats[to] = floats[p] + done * (a - u)
            floats[to + 1] = floats[p + 1] + done * (b - v)
            floats[to + 2] = floats[p + 2] + done * (c - w)
        d = apart(floats, at, edges)
        if d <= 2.0 * least:
            break
    return done


@lean_inlined
def most_turned(y, changed, floats, ints):
    """Write how far turning takes each vertex; at most."""
    count, most = ints[layout.VERTICES], 0.0
    for k in range(count):
        at, to = vertex(ints, k), ints[layout.NOW] + 6 * count + k
        floats[to] = 0.0
        if ints[at + layout.ARM] >= 0:
            floats[to] = turned(y, changed, floats, ints, at)
            most = max(most, floats[to])
    return most


@lean(LIMIT, inner=True)
def limit(t, y, changed, floats, ints):
    """The largest part of a change; one of which pairs are not known is shortened until they are."""
    memory, now, then = ints[layout.MEMORY], ints[layout.NOW], ints[layout.NOW] + 3 * ints[layout.VERTICES]
    part = 1.0
    stand(y, floats, ints, now)
    stand(changed, floats, ints, then)
    # On its way a place that turns leaves the line between its ends by no more than half of that.
    aside = 0.5 * most_turned(y, changed, floats, ints)
    valid = floats[memory + layout.BUILT] == 1.0 and gone(floats, ints, now) <= floats[memory + layout.MARGIN]
    if not valid or not gone(floats, ints, then) + aside <= floats[memory + layout.MARGIN]:
        for k in range(3 * ints[layout.VERTICES]):
            floats[memory + layout.AT + k] = floats[now + k]
        way = SLACK * (gone(floats, ints, then) + aside)
        if not way < math.inf:
            floats[memory + layout.BUILT] = 0.0
            return 0.0
        margin = look(floats, ints, max(way, MARGIN * floats[ints[layout.NUMBERS] + layout.SIDE]))
        if margin < way:
            part = margin / way
    for edges in (False, True):
        for m in range(listed(floats, ints, edges)):
            part = advance(y, changed, floats, ints, m, edges, part)
    return part
