# mypy: ignore-errors
"""The contact of a skin in a flow with what stands: a barrier of short range, and Coulomb's friction.

Friction is a spring along the surface from the place where a vertex came to touch, which slides along where it would
pull more than Coulomb's law lets it (Cundall & Strack 1979, Geotechnique 29, 47-65): so what sticks does not creep.
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts import layout as surfaces
from sceneql.contacts.barrier import objects_layout as layout
from sceneql.contacts.barrier.objects_kernels import distance, load
from sceneql.contacts.shape_kernels import inward, turn
from sceneql.skins.touch_layout import ANCHORS, FORCE, GRIP
from sceneql.system.signatures_kernels import AFTER_STEP, TERM


@lean_inlined
def pulled(y, floats, ints, p, j, normal):
    """From the place where friction holds a point to that point, along the surface [m]."""
    at, own = ints[layout.POSITION] + 3 * p, layout.HEAD + surfaces.OBJECT * j
    anchor, there = ints[ANCHORS] + 3 * (ints[layout.OBJECTS] * p + j), ints[own + surfaces.PLACE]
    x, y_, z = turn(floats, ints[own + surfaces.ROTATION], floats[anchor], floats[anchor + 1], floats[anchor + 2])
    u, v, w = y[at] - floats[there] - x, y[at + 1] - floats[there + 1] - y_, y[at + 2] - floats[there + 2] - z
    a, b, c = normal
    along = a * u + b * v + c * w
    return u - along * a, v - along * b, w - along * c


@lean(TERM, inner=True)
def force(t, y, rate, floats, ints):
    """Adds to the forces of the vertices what pushes them off, and friction [N]."""
    numbers, friction = ints[layout.NUMBERS], floats[ints[layout.FRICTION]]
    gap = floats[numbers + layout.GAP]
    for p in range(ints[layout.NODES]):
        at, own = ints[layout.POSITION] + 3 * p, ints[FORCE] + 3 * p
        for j in range(ints[layout.OBJECTS]):
            d, a, b, c = distance(floats, ints, p, j, y[at], y[at + 1], y[at + 2], gap)
            if not d < gap:
                continue
            pressed = load(floats, ints, p, d)
            x, y_, z = pressed * a, pressed * b, pressed * c
            anchor = ints[ANCHORS] + 3 * (ints[layout.OBJECTS] * p + j)
            if friction > 0.0 and not math.isnan(floats[anchor]):
                u, v, w = pulled(y, floats, ints, p, j, (a, b, c))
                grip, size = floats[numbers + GRIP] * floats[ints[layout.AREAS] + p], math.sqrt(u * u + v * v + w * w)
                if grip * size > friction * pressed:
                    grip = friction * pressed / size
                x, y_, z = x - grip * u, y_ - grip * v, z - grip * w
            floats[own] += x
            floats[own + 1] += y_
            floats[own + 2] += z


@lean(AFTER_STEP, inner=True)
def hold(t0, t1, y0, rate0, y1, floats, ints):
    """Where friction holds from now on: what has slid keeps the pull that it had, and so the rate stays."""
    numbers, friction, objects = ints[layout.NUMBERS], floats[ints[layout.FRICTION]], ints[layout.OBJECTS]
    gap = floats[numbers + layout.GAP]
    for p in range(ints[layout.NODES]):
        at = ints[layout.POSITION] + 3 * p
        for j in range(objects):
            anchor, own = ints[ANCHORS] + 3 * (objects * p + j), layout.HEAD + surfaces.OBJECT * j
            d, a, b, c = distance(floats, ints, p, j, y1[at], y1[at + 1], y1[at + 2], gap)
            if not 0.0 < d < gap:
                floats[anchor] = math.nan
                continue
            u = v = w = 0.0
            if not math.isnan(floats[anchor]):
                u, v, w = pulled(y1, floats, ints, p, j, (a, b, c))
                grip, size = floats[numbers + GRIP] * floats[ints[layout.AREAS] + p], math.sqrt(u * u + v * v + w * w)
                most = friction * load(floats, ints, p, d)
                if grip * size <= most:
                    continue
                part = most / (grip * size)
                u, v, w = part * u, part * v, part * w
            x, y_, z = inward(floats, ints, own, y1[at] - u, y1[at + 1] - v, y1[at + 2] - w)
            floats[anchor], floats[anchor + 1], floats[anchor + 2] = x, y_, z
    return False
