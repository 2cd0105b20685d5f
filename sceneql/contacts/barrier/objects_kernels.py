# mypy: ignore-errors
"""The force of a barrier between the points of a skin and objects, with friction."""

import math

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts import layout as surfaces
from sceneql.contacts.barrier import objects_layout as layout
from sceneql.contacts.barrier.barrier_kernels import mobilized, push
from sceneql.contacts.barrier.friction_slopes_kernels import foreseen
from sceneql.contacts.barrier.on_bodies_kernels import on_body, push_body, speed_on_body
from sceneql.contacts.shape_kernels import facing, surface, velocity
from sceneql.system.signatures_kernels import TERM

SURELY = 0.5
"""Part of the distance from a surface that is no plane which counts as known: in front of the sharp edges of combined
solids the distance is estimated."""


@lean_inlined
def ends(ints, p):
    """The two nodes of a point, by their places in the list: twice the same for a node."""
    nodes = ints[layout.NODES]
    if p < nodes:
        return p, p
    at = ints[layout.LIST] + nodes + 2 * (p - nodes)
    return ints[at], ints[at + 1]


@lean_inlined
def place(y, floats, ints, p):
    """The position of a point."""
    if ints[layout.ARMS] >= 0:
        return on_body(y, floats, ints, ints[layout.ARMS] + 8 * p)
    return middle(y, ints, ints[layout.POSITION], p)


@lean_inlined
def speed(y, floats, ints, p):
    """The velocity of a point."""
    if ints[layout.ARMS] >= 0:
        return speed_on_body(y, floats, ints, ints[layout.ARMS] + 8 * p)
    return middle(y, ints, ints[layout.VELOCITY], p)


@lean_inlined
def middle(y, ints, start, p):
    """A component triple of a point of an elastic skin, from ``start`` in y on: its position or its velocity."""
    i, j = ends(ints, p)
    a, b = start + 3 * ints[ints[layout.LIST] + i], start + 3 * ints[ints[layout.LIST] + j]
    return 0.5 * (y[a] + y[b]), 0.5 * (y[a + 1] + y[b + 1]), 0.5 * (y[a + 2] + y[b + 2])


@lean_inlined
def distance(floats, ints, p, j, x, y, z, reach):
    """Distance and normal of object j at the place of point p; beyond ``reach`` as far as known."""
    at = layout.HEAD + surfaces.OBJECT * j
    if ints[at + surfaces.FLAT] != 0:
        return facing(floats, ints, at, x, y, z)
    if ints[at + surfaces.MOVING] != 0:
        return surface(floats, ints, at, x, y, z)
    known = ints[layout.KNOWN] + layout.KNOW * (ints[layout.OBJECTS] * p + j)
    u, v, w = x - floats[known], y - floats[known + 1], z - floats[known + 2]
    least = floats[known + layout.DISTANCE] - math.sqrt(u * u + v * v + w * w)
    if least > reach:
        return least, 0.0, 0.0, 0.0
    found = surface(floats, ints, at, x, y, z)
    floats[known], floats[known + 1], floats[known + 2] = x, y, z
    floats[known + layout.DISTANCE] = SURELY * found[0]
    return found


@lean_inlined
def sliding(y, floats, ints, p, j, a, b, c):
    """The velocity of point p across a normal, relative to object j, at the place that y tells."""
    at = layout.HEAD + surfaces.OBJECT * j
    u, v, w = speed(y, floats, ints, p)
    if ints[at + surfaces.MOVING] != 0:
        x, y_, z = place(y, floats, ints, p)
        d, e, f = velocity(floats, ints, at, x, y_, z)
        u, v, w = u - d, v - e, w - f
    along = a * u + b * v + c * w
    return u - along * a, v - along * b, w - along * c


@lean_inlined
def load(floats, ints, p, d):
    """The normal force [N] on a point at a distance."""
    numbers = ints[layout.NUMBERS]
    area = floats[ints[layout.AREAS] + p]
    return area * floats[numbers + layout.STIFFNESS] * push(d / floats[numbers + layout.GAP])


@lean_inlined
def stale(floats, stage, changed, total):
    """Tell by what part loads have changed, or that a stage has begun: another one than the number at ``stage``."""
    if floats[stage + 1] != floats[channels.STAGES]:
        floats[stage + 1] = floats[channels.STAGES]
        floats[channels.STALE] = 1.0
    elif changed > 0.0:
        floats[channels.STALE] = max(floats[channels.STALE], changed / max(total, changed))


@lean_inlined
def learn(old, new, floats, ints, p, j, at, slip):
    """The direction of friction on a point after an update from one state to another."""
    k = at + layout.HELD
    a, b, c = floats[at + 1], floats[at + 2], floats[at + 3]
    ou, ov, ow = sliding(old, floats, ints, p, j, a, b, c)
    nu, nv, nw = sliding(new, floats, ints, p, j, a, b, c)
    q, r, s = foreseen(floats[k], floats[k + 1], floats[k + 2], ou, ov, ow, nu, nv, nw, slip)
    floats[k], floats[k + 1], floats[k + 2] = q, r, s
    return q, r, s


@lean_inlined
def lag(n, floats, ints):
    """Within implicit stages friction has the loads and normals of the state that newton_kernels.newton left."""
    first, gap = ints[layout.LAGGED], floats[ints[layout.NUMBERS] + layout.GAP]
    slip = floats[ints[layout.NUMBERS] + layout.SLIP]
    if floats[first] == floats[channels.LAGS]:
        return
    floats[first] = floats[channels.LAGS]
    start = floats[floats.size - channels.AFTER * n : floats.size - channels.AFTER * n + n]
    old = floats[floats.size - channels.BEFORE * n : floats.size - channels.BEFORE * n + n]
    total = changed = 0.0
    for p in range(ints[layout.NODES] + ints[layout.EDGES]):
        x, y, z = place(start, floats, ints, p)
        for j in range(ints[layout.OBJECTS]):
            at = first + layout.LOADS + layout.LAG * (ints[layout.OBJECTS] * p + j)
            d, a, b, c = distance(floats, ints, p, j, x, y, z, gap)
            pressed = load(floats, ints, p, d) if 0.0 < d < gap else 0.0
            total, changed = total + pressed, changed + abs(pressed - floats[at])
            if pressed > 0.0:
                learn(old, start, floats, ints, p, j, at, slip)
                part = min(1.0, floats[at] / pressed)
                for k in range(at + layout.HELD, at + layout.HELD + 3):
                    floats[k] *= part
            floats[at] = pressed
            floats[at + 1], floats[at + 2], floats[at + 3] = a, b, c
    stale(floats, first, changed, total)


@lean_inlined
def pinned(floats, ints, node):
    """Whether a node is a pinned mass: what its motion gives the barrier is the pin's work."""
    inverse = floats[ints[layout.INVERSE] + ints[ints[layout.LIST] + node]]
    held = ints[layout.LIST] + ints[layout.NODES] + 2 * ints[layout.EDGES] + 3 * node
    return inverse == 0.0 and ints[held] == 0


@lean_inlined
def add(rate, y, floats, ints, p, x, y_, z):
    """Add a force to the two nodes of a point, or to its body, and take its power from the work."""
    if ints[layout.ARMS] >= 0:
        rate[ints[layout.WORK]] -= push_body(y, rate, floats, ints, ints[layout.ARMS] + 8 * p, x, y_, z)
        return
    i, j = ends(ints, p)
    for node in (i, j):
        at = ints[layout.VELOCITY] + 3 * ints[ints[layout.LIST] + node]
        rate[at] += 0.5 * x
        rate[at + 1] += 0.5 * y_
        rate[at + 2] += 0.5 * z
        if pinned(floats, ints, node):
            continue
        rate[ints[layout.WORK]] -= 0.5 * (x * y[at] + y_ * y[at + 1] + z * y[at + 2])


@lean(TERM, inner=True)
def force(t, y, rate, floats, ints):
    """Adds the push of the barrier along the normal, and friction across it."""
    numbers, objects = ints[layout.NUMBERS], ints[layout.OBJECTS]
    gap, slip = floats[numbers + layout.GAP], floats[numbers + layout.SLIP]
    friction = floats[ints[layout.FRICTION]]
    lagged = friction > 0.0 and floats[channels.STAGE] > 0.0
    if lagged:
        lag(y.size, floats, ints)
    holds = floats[channels.STAGE] == channels.NO_SLOPES
    for p in range(ints[layout.NODES] + ints[layout.EDGES]):
        px, py, pz = place(y, floats, ints, p)
        for j in range(objects):
            d, a, b, c = distance(floats, ints, p, j, px, py, pz, gap)
            pressed = 0.0
            if d < gap:
                pressed = load(floats, ints, p, d)
                add(rate, y, floats, ints, p, pressed * a, pressed * b, pressed * c)
            if friction == 0.0:
                continue
            if holds:
                at = ints[layout.LAGGED] + layout.LOADS + layout.LAG * (objects * p + j) + layout.HELD
                if floats[at] != 0.0 or floats[at + 1] != 0.0 or floats[at + 2] != 0.0:
                    add(rate, y, floats, ints, p, floats[at], floats[at + 1], floats[at + 2])
                continue
            if lagged:
                at = ints[layout.LAGGED] + layout.LOADS + layout.LAG * (objects * p + j)
                pressed, a, b, c = floats[at], floats[at + 1], floats[at + 2], floats[at + 3]
            if pressed > 0.0:
                u, v, w = sliding(y, floats, ints, p, j, a, b, c)
                drag = -friction * pressed * mobilized(math.sqrt(u * u + v * v + w * w), slip)
                add(rate, y, floats, ints, p, drag * u, drag * v, drag * w)
