# mypy: ignore-errors
"""How far skins may go before they meet, by additive continuous detection.

Source: Li, Kaufman & Jiang (2021), Codimensional incremental potential contact, ACM Trans. Graph. 40, 170.
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.barrier import pairs_layout as layout
from sceneql.contacts.barrier.distance_kernels import edge_edge, point_triangle
from sceneql.contacts.barrier.pair_weights_kernels import listed, node
from sceneql.contacts.barrier.pairs_kernels import MARGIN, gone, look, vertex
from sceneql.system.signatures_kernels import LIMIT

LEFT = 0.01
"""Part of the distance at the start that is left where a way ends."""
MOST = 200
"""Advances on a way."""
SLACK = 1.05
"""Margin over the largest way of a vertex."""


@lean_inlined
def advance(y, changed, floats, ints, m, edges, part):
    """The part of the way, up to ``part``, that a pair stays apart.

    A distance changes by no more than the largest ways on both sides together, the mean motion of the four aside.
    """
    at = ints[layout.MEMORY] + layout.SCRATCH
    u = v = w = 0.0
    for k in range(4):
        p = ints[vertex(ints, node(floats, ints, m, edges, k))]
        for c in range(3):
            floats[at + 3 * k + c] = y[p + c]
        u, v, w = (
            u + 0.25 * (changed[p] - y[p]),
            v + 0.25 * (changed[p + 1] - y[p + 1]),
            w + 0.25 * (changed[p + 2] - y[p + 2]),
        )
    first = second = 0.0
    for k in range(4):
        p = ints[vertex(ints, node(floats, ints, m, edges, k))]
        a, b, c = changed[p] - y[p] - u, changed[p + 1] - y[p + 1] - v, changed[p + 2] - y[p + 2] - w
        way = math.sqrt(a * a + b * b + c * c)
        if k == 0 or (edges and k == 1):
            first = max(first, way)
        else:
            second = max(second, way)
    way = first + second
    if way == 0.0:
        return part
    d = (
        edge_edge(floats, at, at + 3, at + 6, at + 9)[0]
        if edges
        else point_triangle(floats, at, at + 3, at + 6, at + 9)[0]
    )
    least, done = LEFT * d, 0.0
    for _ in range(MOST):
        if way * (part - done) <= d - least:
            return part
        done += (d - least) / way
        for k in range(4):
            p = ints[vertex(ints, node(floats, ints, m, edges, k))]
            floats[at + 3 * k] = y[p] + done * (changed[p] - y[p] - u)
            floats[at + 3 * k + 1] = y[p + 1] + done * (changed[p + 1] - y[p + 1] - v)
            floats[at + 3 * k + 2] = y[p + 2] + done * (changed[p + 2] - y[p + 2] - w)
        d = (
            edge_edge(floats, at, at + 3, at + 6, at + 9)[0]
            if edges
            else point_triangle(floats, at, at + 3, at + 6, at + 9)[0]
        )
        if d <= 2.0 * least:
            break
    return done


@lean(LIMIT, inner=True)
def limit(t, y, changed, floats, ints):
    """The largest part of a change; one of which pairs are not known is shortened until they are."""
    memory = ints[layout.MEMORY]
    part = 1.0
    valid = floats[memory + layout.BUILT] == 1.0 and gone(y, floats, ints) <= floats[memory + layout.MARGIN]
    if not valid or not gone(changed, floats, ints) <= floats[memory + layout.MARGIN]:
        for k in range(ints[layout.VERTICES]):
            p = ints[vertex(ints, k)]
            for c in range(3):
                floats[memory + layout.AT + 3 * k + c] = y[p + c]
        way = SLACK * gone(changed, floats, ints)
        if not way < math.inf:
            floats[memory + layout.BUILT] = 0.0
            return 0.0
        margin = look(y, floats, ints, max(way, MARGIN * floats[ints[layout.NUMBERS] + layout.SIDE]))
        if margin < way:
            part = margin / way
    for edges in (False, True):
        for m in range(listed(floats, ints, edges)):
            part = advance(y, changed, floats, ints, m, edges, part)
    return part
