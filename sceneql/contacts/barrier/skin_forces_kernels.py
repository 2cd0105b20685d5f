# mypy: ignore-errors
"""The force of the barrier between skins, with friction."""

import math

from numba import types

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.barrier import pairs_layout as layout
from sceneql.contacts.barrier.barrier_kernels import barrier, mobilized, push
from sceneql.contacts.barrier.friction_slopes_kernels import foreseen
from sceneql.contacts.barrier.objects_kernels import stale
from sceneql.contacts.barrier.on_bodies_kernels import THREE, push_body, speed_on_body
from sceneql.contacts.barrier.pair_weights_kernels import listed, node, product, stencil
from sceneql.contacts.barrier.pairs_kernels import known, vertex
from sceneql.system.signatures_kernels import TERM, A, F, I, N


@lean_inlined
def pinned(floats, ints, at):
    """Whether the vertex of ints[at:] is a pinned mass: what its motion gives the barrier is the pin's work."""
    return floats[ints[at + layout.INVERSE]] == 0.0 and ints[at + layout.HELD] != 1


@lean(types.void(A, A, A, I, N, F, F, F))
def add(rate, y, floats, ints, k, x, y_, z):
    """Add a force to a vertex, and take its power from the work."""
    at = vertex(ints, k)
    if ints[at + layout.ARM] >= 0:
        rate[ints[at + layout.WORK]] -= push_body(y, rate, floats, ints, at, x, y_, z)
        return
    v = ints[at + layout.VELOCITY]
    rate[v] += x
    rate[v + 1] += y_
    rate[v + 2] += z
    if pinned(floats, ints, at):
        return
    rate[ints[at + layout.WORK]] -= x * y[v] + y_ * y[v + 1] + z * y[v + 2]


@lean_inlined
def speed(y, floats, ints, at):
    """The velocity of the vertex of ints[at:]."""
    if ints[at + layout.ARM] >= 0:
        return speed_on_body(y, floats, ints, at)
    p = ints[at + layout.VELOCITY]
    return y[p], y[p + 1], y[p + 2]


@lean(THREE(A, A, I, N))
def sliding(y, floats, ints, at):
    """The velocity of a lagged pair across its normal."""
    u = v = w = 0.0
    for k in range(4):
        own, weight = vertex(ints, int(floats[at + k])), floats[at + layout.WEIGHTS + k]
        x, y_, z = speed(y, floats, ints, own)
        u, v, w = u + weight * x, v + weight * y_, w + weight * z
    a, b, c = floats[at + layout.NORMAL], floats[at + layout.NORMAL + 1], floats[at + layout.NORMAL + 2]
    along = a * u + b * v + c * w
    return u - along * a, v - along * b, w - along * c


@lean_inlined
def learn(old, new, floats, ints, at, slip):
    """The direction of a lagged pair's friction after an update from one state to another."""
    f = at + layout.FRICTION_OF
    ou, ov, ow = sliding(old, floats, ints, at)
    nu, nv, nw = sliding(new, floats, ints, at)
    p, q, r = foreseen(floats[f], floats[f + 1], floats[f + 2], ou, ov, ow, nu, nv, nw, slip)
    floats[f], floats[f + 1], floats[f + 2] = p, q, r
    return p, q, r


@lean_inlined
def keep(y, floats, ints, m, edges, found):
    """Note a pair that presses for friction, where there is room."""
    memory = ints[layout.MEMORY]
    count = int(floats[memory + layout.LAGGED])
    if count == ints[layout.MOST_LAGGED]:
        floats[memory + layout.CROWDED] += 1.0
        return
    at = ints[layout.LAG_AT] + layout.LAG * count
    for k in range(4):
        floats[at + k] = node(floats, ints, m, edges, k)
        floats[at + layout.WEIGHTS + k] = found[4 + k]
    for k in range(3):
        floats[at + layout.NORMAL + k] = found[1 + k]
        floats[at + layout.FRICTION_OF + k] = 0.0
    listed_at = (ints[layout.EDGES_AT] if edges else ints[layout.POINTS_AT]) + 2 * m
    first = (ints[layout.TRIANGLES] if edges else 0) + floats[listed_at]
    floats[at + layout.KEY] = first * (ints[layout.VERTICES] + ints[layout.EDGES]) + floats[listed_at + 1]
    pressed = floats[at + layout.LOAD] = found[9] * found[10] * push(found[0] / found[8])
    for k in range(4):
        floats[ints[layout.LOADS] + int(floats[at + k])] += abs(found[4 + k]) * pressed
    floats[memory + layout.LAGGED] = count + 1.0


@lean_inlined
def keep_directions(n, floats, ints):
    """Put the directions of all lagged pairs aside, as the latest update has changed them; how many they are."""
    before, count = ints[layout.LAGGED_BEFORE], int(floats[ints[layout.MEMORY] + layout.LAGGED])
    slip = floats[ints[layout.NUMBERS] + layout.SLIP]
    start, end = floats.size - channels.BEFORE * n, floats.size - channels.AFTER * n
    old, new = floats[start : start + n], floats[end : end + n]
    for m in range(count):
        at, other = ints[layout.LAG_AT] + layout.LAG * m, before + layout.BEFORE * m
        learn(old, new, floats, ints, at, slip)
        floats[other] = floats[at + layout.KEY]
        for k in range(3):
            floats[other + 1 + k] = floats[at + layout.FRICTION_OF + k]
        floats[other + 4] = floats[at + layout.LOAD]
    return count


@lean_inlined
def find_directions(floats, ints, count):
    """Give the lagged pairs the directions of the same ones of those that were put aside."""
    memory, before = ints[layout.MEMORY], ints[layout.LAGGED_BEFORE]
    other = 0
    for m in range(int(floats[memory + layout.LAGGED])):
        at = ints[layout.LAG_AT] + layout.LAG * m
        while other < count and floats[before + layout.BEFORE * other] < floats[at + layout.KEY]:
            other += 1
        if other < count and floats[before + layout.BEFORE * other] == floats[at + layout.KEY]:
            for k in range(3):
                part = min(1.0, floats[before + layout.BEFORE * other + 4] / floats[at + layout.LOAD])
                floats[at + layout.FRICTION_OF + k] = part * floats[before + layout.BEFORE * other + 1 + k]


@lean_inlined
def keep_all(y, floats, ints):
    """Note all pairs that press at a state, and by how much the loads on vertices have changed."""
    memory, loads, count = ints[layout.MEMORY], ints[layout.LOADS], ints[layout.VERTICES]
    # Within a stage the direction of friction, which updates have learned, outlives the loads that it was learned with.
    within = floats[channels.STAGE] > 0.0
    learned = keep_directions(y.size, floats, ints) if within else 0
    floats[memory + layout.LAGGED] = 0.0
    for k in range(count):
        floats[loads + count + k] = floats[loads + k]
        floats[loads + k] = 0.0
    if not known(y, floats, ints):
        return
    for edges in (False, True):
        for m in range(listed(floats, ints, edges)):
            found = stencil(floats, ints, m, edges)
            if 0.0 < found[0] < math.inf:
                keep(y, floats, ints, m, edges, found)
    find_directions(floats, ints, learned)
    total = changed = 0.0
    for k in range(loads, loads + count):
        total, changed = total + floats[k], changed + abs(floats[k] - floats[count + k])
    stale(floats, memory + layout.LAGS, changed, total)


@lean_inlined
def hold_on(y, rate, floats, ints):
    """Add the friction that is held through a step."""
    for m in range(int(floats[ints[layout.MEMORY] + layout.LAGGED])):
        at = ints[layout.LAG_AT] + layout.LAG * m
        f = at + layout.FRICTION_OF
        for k in range(4):
            weight = floats[at + layout.WEIGHTS + k]
            add(
                rate,
                y,
                floats,
                ints,
                int(floats[at + k]),
                weight * floats[f],
                weight * floats[f + 1],
                weight * floats[f + 2],
            )


@lean(TERM, inner=True)
def force(t, y, rate, floats, ints):
    """Adds the push of the barrier, and friction across it."""
    memory, slip = ints[layout.MEMORY], floats[ints[layout.NUMBERS] + layout.SLIP]
    friction = floats[ints[layout.FRICTION]]
    if friction > 0.0:
        if floats[channels.STAGE] == channels.NO_SLOPES:
            hold_on(y, rate, floats, ints)
        elif floats[channels.STAGE] <= 0.0:
            floats[memory + layout.LAGS] = -1.0
            keep_all(y, floats, ints)
        elif floats[memory + layout.LAGS] != floats[channels.LAGS]:
            floats[memory + layout.LAGS] = floats[channels.LAGS]
            after = floats.size - channels.AFTER * y.size
            keep_all(floats[after : after + y.size], floats, ints)
    if not known(y, floats, ints):
        rate[ints[vertex(ints, 0) + layout.VELOCITY]] = math.nan
        return
    for edges in (False, True):
        for m in range(listed(floats, ints, edges)):
            found = stencil(floats, ints, m, edges)
            d = found[0]
            if d == math.inf:
                continue
            pressed = found[9] * found[10] * push(d / found[8])
            for k in range(4):
                f = pressed * found[4 + k]
                add(rate, y, floats, ints, node(floats, ints, m, edges, k), f * found[1], f * found[2], f * found[3])
            if found[11] > 0.0:
                i, j = node(floats, ints, m, edges, 0), node(floats, ints, m, edges, 1)
                k, n = node(floats, ints, m, edges, 2), node(floats, ints, m, edges, 3)
                now = ints[layout.NOW]
                p, q, r, s = now + 3 * i, now + 3 * j, now + 3 * k, now + 3 * n
                a, b, c = product(floats, p, q, r, s)
                # The slope of |u x v|^2 is 2 v x (u x v) by u, and 2 (u x v) x u by v.
                less = 2.0 * found[9] * found[8] * barrier(d / found[8]) * found[11]
                u, v, w = floats[s] - floats[r], floats[s + 1] - floats[r + 1], floats[s + 2] - floats[r + 2]
                x, y_, z = less * (v * c - w * b), less * (w * a - u * c), less * (u * b - v * a)
                add(rate, y, floats, ints, i, x, y_, z)
                add(rate, y, floats, ints, j, -x, -y_, -z)
                u, v, w = floats[q] - floats[p], floats[q + 1] - floats[p + 1], floats[q + 2] - floats[p + 2]
                x, y_, z = less * (b * w - c * v), less * (c * u - a * w), less * (a * v - b * u)
                add(rate, y, floats, ints, k, x, y_, z)
                add(rate, y, floats, ints, n, -x, -y_, -z)
    if friction == 0.0 or floats[channels.STAGE] == channels.NO_SLOPES:
        return
    for m in range(int(floats[memory + layout.LAGGED])):
        at = ints[layout.LAG_AT] + layout.LAG * m
        u, v, w = sliding(y, floats, ints, at)
        drag = -friction * floats[at + layout.LOAD] * mobilized(math.sqrt(u * u + v * v + w * w), slip)
        for k in range(4):
            f = drag * floats[at + layout.WEIGHTS + k]
            add(rate, y, floats, ints, int(floats[at + k]), f * u, f * v, f * w)
