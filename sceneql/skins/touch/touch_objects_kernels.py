# mypy: ignore-errors
"""The contact of a skin in a flow with what stands: a barrier of short range, and Coulomb's friction.

Friction is a spring along the surface from the place where a vertex came to touch, which slides along where it would
pull more than Coulomb's law lets it (Cundall & Strack 1979, Geotechnique 29, 47-65): so what sticks does not creep.
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts import layout as surfaces
from sceneql.contacts.barrier import objects_layout as layout
from sceneql.contacts.barrier.objects_kernels import distance
from sceneql.contacts.shape_kernels import inward, turn
from sceneql.skins.touch.touch_layout import ANCHORS, FORCE, STEEP
from sceneql.skins.touch.touch_push_kernels import push
from sceneql.system.signatures_kernels import AFTER_STEP, TERM


@lean_inlined
def load(floats, ints, p, d):
    """The normal force [N] on a point at a distance."""
    numbers = ints[layout.NUMBERS]
    area = floats[ints[layout.AREAS] + p]
    return area * floats[numbers + layout.STIFFNESS] * push(d / floats[numbers + layout.GAP], floats[numbers + STEEP])


@lean_inlined
def pulled(y, floats, ints, p, j, a, b, c):
    """From the place where friction holds a point to that point, across the normal (a, b, c) [m]."""
    at, own = ints[layout.POSITION] + 3 * p, layout.HEAD + surfaces.OBJECT * j
    anchor, there = ints[ANCHORS] + 3 * (ints[layout.OBJECTS] * p + j), ints[own + surfaces.PLACE]
    x, y_, z = turn(floats, ints[own + surfaces.ROTATION], floats[anchor], floats[anchor + 1], floats[anchor + 2])
    u, v, w = y[at] - floats[there] - x, y[at + 1] - floats[there + 1] - y_, y[at + 2] - floats[there + 2] - z
    along = a * u + b * v + c * w
    return u - along * a, v - along * b, w - along * c


@lean_inlined
def slides(floats, ints, p, pressed, u, v, w):
    """The part of a pull that Coulomb's law leaves: 1 where the point sticks; and the pull over its length [N/m].

    It holds the tighter the more is pressed, so that it slides from no more than a gap on.
    """
    numbers = ints[layout.NUMBERS]
    grip = (floats[ints[layout.AREAS] + p] * floats[numbers + layout.STIFFNESS] + pressed) / floats[
        numbers + layout.GAP
    ]
    pull, most = grip * math.sqrt(u * u + v * v + w * w), floats[ints[layout.FRICTION]] * pressed
    return 1.0 if pull <= most else most / pull, grip


@lean_inlined
def met(y, floats, ints, p, j, found):
    """The force [N] on point p of object j, found at a distance with a normal."""
    d, a, b, c = found
    pressed = load(floats, ints, p, d)
    x, y_, z = pressed * a, pressed * b, pressed * c
    if not math.isnan(floats[ints[ANCHORS] + 3 * (ints[layout.OBJECTS] * p + j)]):
        u, v, w = pulled(y, floats, ints, p, j, a, b, c)
        part, grip = slides(floats, ints, p, pressed, u, v, w)
        x, y_, z = x - part * grip * u, y_ - part * grip * v, z - part * grip * w
    return x, y_, z


@lean_inlined
def add(floats, ints, p, x, y_, z):
    """Add to the force of a vertex."""
    own = ints[FORCE] + 3 * p
    floats[own] += x
    floats[own + 1] += y_
    floats[own + 2] += z


@lean(TERM, inner=True)
def force(t, y, rate, floats, ints):
    """Adds to the forces of the vertices what pushes them off, and friction [N]."""
    gap = floats[ints[layout.NUMBERS] + layout.GAP]
    for p in range(ints[layout.NODES]):
        at = ints[layout.POSITION] + 3 * p
        for j in range(ints[layout.OBJECTS]):
            found = distance(floats, ints, p, j, y[at], y[at + 1], y[at + 2], gap)
            if found[0] < gap:
                x, y_, z = met(y, floats, ints, p, j, found)
                add(floats, ints, p, x, y_, z)


@lean_inlined
def hold_one(y, floats, ints, p, j):
    """Where friction holds point p on object j from now on: what has slid keeps the pull that it had."""
    at, anchor = ints[layout.POSITION] + 3 * p, ints[ANCHORS] + 3 * (ints[layout.OBJECTS] * p + j)
    gap = floats[ints[layout.NUMBERS] + layout.GAP]
    d, a, b, c = distance(floats, ints, p, j, y[at], y[at + 1], y[at + 2], gap)
    if not 0.0 < d < gap:
        floats[anchor] = math.nan
        return
    u = v = w = 0.0
    if not math.isnan(floats[anchor]):
        u, v, w = pulled(y, floats, ints, p, j, a, b, c)
        part = slides(floats, ints, p, load(floats, ints, p, d), u, v, w)[0]
        if part == 1.0:
            return
        u, v, w = part * u, part * v, part * w
    own = layout.HEAD + surfaces.OBJECT * j
    x, y_, z = inward(floats, ints, own, y[at] - u, y[at + 1] - v, y[at + 2] - w)
    floats[anchor], floats[anchor + 1], floats[anchor + 2] = x, y_, z


@lean(AFTER_STEP, inner=True)
def hold(t0, t1, y0, rate0, y1, floats, ints):
    """Where friction holds from now on; no pull changes, and so the rate stays."""
    for p in range(ints[layout.NODES]):
        for j in range(ints[layout.OBJECTS]):
            hold_one(y1, floats, ints, p, j)
    return False
