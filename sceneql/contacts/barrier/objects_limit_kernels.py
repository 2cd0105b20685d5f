# mypy: ignore-errors
"""How far points of a skin or a rigid body may go before they reach objects, by conservative advancement."""

import math

from sceneql.compiled.kernels import lean
from sceneql.contacts import layout as surfaces
from sceneql.contacts.barrier import objects_layout as layout
from sceneql.contacts.barrier.objects_kernels import distance, place
from sceneql.contacts.barrier.on_bodies_kernels import swept, turned
from sceneql.system.signatures_kernels import LIMIT

LEFT = 0.01
"""Part of the distance at the start that is left where a way ends."""
MOST = 200
"""Advances on a way, each by the distance that is left."""


@lean(LIMIT, inner=True)
def limit(t, y, changed, floats, ints):
    """The largest part of a change: a distance changes by no more than a point moves.

    A point that is inside an object, which has moved there, may go wherever it leaves that.
    """
    part = 1.0
    for p in range(ints[layout.NODES] + ints[layout.EDGES]):
        px, py, pz = place(y, floats, ints, p)
        qx, qy, qz = place(changed, floats, ints, p)
        u, v, w = qx - px, qy - py, qz - pz
        arm, turning = ints[layout.ARMS] + 8 * p, 0.0
        if ints[layout.ARMS] >= 0:
            turning = turned(y, changed, floats, ints, arm)
        if turning > 0.0:
            c = ints[layout.POSITION]
            u, v, w = changed[c] - y[c], changed[c + 1] - y[c + 1], changed[c + 2] - y[c + 2]
        way = math.sqrt(u * u + v * v + w * w) + turning
        if not way < math.inf:
            return 0.0
        if way == 0.0:
            continue
        for j in range(ints[layout.OBJECTS]):
            d = distance(floats, ints, p, j, px, py, pz, way)[0]
            if d <= 0.0:
                if distance(floats, ints, p, j, qx, qy, qz, 0.0)[0] <= 0.0:
                    return 0.0
                continue
            least, done = LEFT * d, 0.0
            if ints[layout.HEAD + surfaces.OBJECT * j + surfaces.FLAT] != 0 and turning == 0.0:
                end = distance(floats, ints, p, j, qx, qy, qz, 0.0)[0]
                if end < least:
                    part = min(part, (d - least) / (d - end))
                continue
            for _ in range(MOST):
                if way * (part - done) <= d - least:
                    done = part
                    break
                # A place so near the end of the way that rounding alone is left ends it.
                done += (d - least) / way
                x, y_, z = px + done * u, py + done * v, pz + done * w
                if turning > 0.0:
                    x, y_, z = swept(y, changed, floats, ints, arm, done)
                d = distance(floats, ints, p, j, x, y_, z, way * (part - done))[0]
                if d <= 2.0 * least:
                    break
            part = min(part, done)
    return part
