# mypy: ignore-errors
"""The contact of a skin in a flow with masses and rigid bodies: as with what stands, and both feel it."""

import math

from sceneql.bodies.rigid.rigid_kernels import to_world
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts import layout as surfaces
from sceneql.contacts.barrier import objects_layout as layout
from sceneql.contacts.barrier.objects_kernels import distance
from sceneql.contacts.shape_kernels import inward, turn
from sceneql.skins.touch.touch_layout import BODIES, BODY, RELATIVE
from sceneql.skins.touch.touch_objects_kernels import add, hold_one, met
from sceneql.system.signatures_kernels import AFTER_STEP, LIMIT, TERM, A, F, I, N

LEFT = 0.01
"""Part of the distance at the start that is left where a way ends."""
MOST = 200
"""Advances on a way, each by the distance that is left."""

push_place = lazy("sceneql.bodies.rigid.place_kernels:push", F(A, A, A, I, N, F, F, F))


@lean_inlined
def body(ints, j):
    """Where the integers of the body of object j begin: those of system.Place, and RELATIVE."""
    return ints[BODIES] + BODY * j


@lean_inlined
def pose(y, floats, ints):
    """Put all surfaces where their bodies are."""
    for j in range(ints[layout.OBJECTS]):
        own, at = layout.HEAD + surfaces.OBJECT * j, body(ints, j)
        place, rotation, c = ints[own + surfaces.PLACE], ints[own + surfaces.ROTATION], ints[at]
        u = v = w = 0.0
        if ints[at + RELATIVE] >= 0:
            r, q = ints[at + RELATIVE], ints[at + 4]
            u, v, w = to_world(y, q, floats[r], floats[r + 1], floats[r + 2])
            a, b, d, e = y[q], y[q + 1], y[q + 2], y[q + 3]
            f, g, h, k = floats[r + 3], floats[r + 4], floats[r + 5], floats[r + 6]
            scale = 1.0 / math.sqrt(a * a + b * b + d * d + e * e)
            floats[rotation] = scale * (a * f - b * g - d * h - e * k)
            floats[rotation + 1] = scale * (a * g + b * f + d * k - e * h)
            floats[rotation + 2] = scale * (a * h + d * f + e * g - b * k)
            floats[rotation + 3] = scale * (a * k + e * f + b * h - d * g)
        floats[place], floats[place + 1], floats[place + 2] = y[c] + u, y[c + 1] + v, y[c + 2] + w


@lean(TERM, inner=True)
def force(t, y, rate, floats, ints):
    """Adds to the forces of vertices and bodies what keeps them apart, and friction [N]."""
    pose(y, floats, ints)
    gap = floats[ints[layout.NUMBERS] + layout.GAP]
    for p in range(ints[layout.NODES]):
        at = ints[layout.POSITION] + 3 * p
        for j in range(ints[layout.OBJECTS]):
            found = distance(floats, ints, p, j, y[at], y[at + 1], y[at + 2], gap)
            if not found[0] < gap:
                continue
            x, y_, z = met(y, floats, ints, p, j, found)
            add(floats, ints, p, x, y_, z)
            own = body(ints, j)
            power = push_place(y, rate, floats, ints, own, -x, -y_, -z)
            if ints[own + RELATIVE] >= 0:
                c, momentum = ints[own], ints[own + 5]
                u, v, w = y[at] - y[c], y[at + 1] - y[c + 1], y[at + 2] - y[c + 2]
                rate[momentum] -= v * z - w * y_
                rate[momentum + 1] -= w * x - u * z
                rate[momentum + 2] -= u * y_ - v * x
            rate[ints[own + 2]] -= power


@lean(AFTER_STEP, inner=True)
def hold(t0, t1, y0, rate0, y1, floats, ints):
    """Where friction holds from now on, in the axes of the bodies."""
    pose(y1, floats, ints)
    for p in range(ints[layout.NODES]):
        for j in range(ints[layout.OBJECTS]):
            hold_one(y1, floats, ints, p, j)
    return False


@lean(LIMIT, inner=True)
def limit(t, y, changed, floats, ints):
    """The largest part of a change in which no vertex reaches a body, by conservative advancement in its axes."""
    part, objects = 1.0, ints[layout.OBJECTS]
    for j in range(objects):
        own = layout.HEAD + surfaces.OBJECT * j
        place, rotation = ints[own + surfaces.PLACE], ints[own + surfaces.ROTATION]
        for p in range(ints[layout.NODES]):
            at = ints[layout.POSITION] + 3 * p
            if p == 0:
                pose(changed, floats, ints)
                cx, cy, cz = floats[place], floats[place + 1], floats[place + 2]
                qw, qx = floats[rotation], floats[rotation + 1]
                qy, qz = floats[rotation + 2], floats[rotation + 3]
                pose(y, floats, ints)
                bx, by, bz = floats[place], floats[place + 1], floats[place + 2]
                rw, rx = floats[rotation], floats[rotation + 1]
                ry, rz = floats[rotation + 2], floats[rotation + 3]
            # The end of the way in the body's axes then, told in the world by where the body is now.
            floats[place], floats[place + 1], floats[place + 2] = cx, cy, cz
            floats[rotation], floats[rotation + 1], floats[rotation + 2], floats[rotation + 3] = qw, qx, qy, qz
            x, y_, z = inward(floats, ints, own, changed[at], changed[at + 1], changed[at + 2])
            floats[place], floats[place + 1], floats[place + 2] = bx, by, bz
            floats[rotation], floats[rotation + 1], floats[rotation + 2], floats[rotation + 3] = rw, rx, ry, rz
            x, y_, z = turn(floats, rotation, x, y_, z)
            u, v, w = bx + x - y[at], by + y_ - y[at + 1], bz + z - y[at + 2]
            way = math.sqrt(u * u + v * v + w * w)
            if not way < math.inf:
                return 0.0
            if way == 0.0:
                continue
            d = distance(floats, ints, p, j, y[at], y[at + 1], y[at + 2], way)[0]
            if d <= 0.0:
                return 0.0
            least, done = LEFT * d, 0.0
            for _ in range(MOST):
                if way * (part - done) <= d - least:
                    done = part
                    break
                done += (d - least) / way
                d = distance(floats, ints, p, j, y[at] + done * u, y[at + 1] + done * v, y[at + 2] + done * w, way)[0]
                if d <= 2.0 * least:
                    break
            part = min(part, done)
    return part
