# mypy: ignore-errors
"""The contact of skins in flows with one another, and of a skin with itself: a barrier of short range, and friction.

Each vertex is pushed off the nearest place of each other skin, and of its own beyond what was near at the start, with
half of its share of area: the other half is that of the vertices there. Friction is a spring from the place of the
other skin at which the vertex came to touch, that slides along where it would pull more than Coulomb's law lets it, as
on objects (touch_objects_kernels.py).
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.skins.touch import touch_pairs_layout as layout
from sceneql.skins.touch.touch_pairs_search_kernels import corner, go, is_near, known, lay, lay_where_near, look, vertex
from sceneql.skins.touch.touch_push_kernels import push
from sceneql.system.signatures_kernels import AFTER_STEP, LIMIT, TERM, A, F, I, N

KEPT = 0.9
"""Part of a distance that a step may go."""


@lean_inlined
def pressed(floats, ints, p, s):
    """The normal force [N] on vertex p of the skin s that was found near it, and the stiffness of friction [N/m]."""
    numbers, weights, found = ints[layout.NUMBERS], ints[layout.WEIGHTS], ints[layout.BEST] + layout.FOUND * s
    gap, area = floats[numbers + layout.GAP], 0.5 * floats[weights + 2 * p]
    f = int(floats[found + layout.FACE])
    stiffness = area * min(floats[weights + 2 * p + 1], floats[weights + 2 * corner(ints, f, 0) + 1])
    load = stiffness * push(floats[found] / gap, floats[numbers + layout.STEEP])
    return load, (stiffness + load) / gap


@lean_inlined
def holds(ints, p, s):
    """Offset of where friction holds vertex p on skin s."""
    return ints[layout.HOLDS] + layout.HOLD * (ints[layout.SKINS] * p + s)


@lean_inlined
def nearest(floats, ints, axis, way):
    """The shortest of ways along an axis that differ by whole periods of the flow [m]."""
    period = floats[ints[layout.NUMBERS] + layout.PERIODS + axis]
    return way - period * math.floor(way / period + 0.5) if period > 0.0 else way


@lean(types.UniTuple(F, 4)(A, A, I, N, N, F, F), inner=True)
def pull(y, floats, ints, p, s, load, grip):
    """From where friction holds a vertex to that vertex, across the normal (3) [m], and the part of the pull that
    Coulomb's law leaves; 0 where nothing holds it."""
    hold, n = holds(ints, p, s), ints[layout.BEST] + layout.FOUND * s + layout.NORMAL
    f = int(floats[hold + layout.ON])
    if f < 0:
        return 0.0, 0.0, 0.0, 1.0
    at = ints[vertex(ints, p) + layout.POSITION]
    x, y_, z = y[at], y[at + 1], y[at + 2]
    for k in range(ints[layout.CORNERS]):
        other, part = ints[vertex(ints, corner(ints, f, k)) + layout.POSITION], floats[hold + layout.PARTS + k]
        x, y_, z = x - part * y[other], y_ - part * y[other + 1], z - part * y[other + 2]
    x, y_, z = nearest(floats, ints, 0, x), nearest(floats, ints, 1, y_), nearest(floats, ints, 2, z)
    along = x * floats[n] + y_ * floats[n + 1] + z * floats[n + 2]
    x, y_, z = x - along * floats[n], y_ - along * floats[n + 1], z - along * floats[n + 2]
    drag, most = grip * math.sqrt(x * x + y_ * y_ + z * z), floats[ints[layout.FRICTION]] * load
    return x, y_, z, (1.0 if drag <= most else most / drag)


@lean(TERM, inner=True)
def force(t, y, rate, floats, ints):
    """Adds to the forces of the vertices what keeps skins apart, and friction [N]; their sum is 0."""
    friction, gap, corners = (
        floats[ints[layout.FRICTION]],
        floats[ints[layout.NUMBERS] + layout.GAP],
        ints[layout.CORNERS],
    )
    if not lay_where_near(y, floats, ints, gap):
        return
    for p in range(ints[layout.VERTICES]):
        if not is_near(y, floats, ints, p, gap):
            continue
        own = vertex(ints, p)
        for s in range(ints[layout.SKINS]):
            found = ints[layout.BEST] + layout.FOUND * s
            if not floats[found] < gap:
                continue
            f, n = int(floats[found + layout.FACE]), found + layout.NORMAL
            load, grip = pressed(floats, ints, p, s)
            x, y_, z = load * floats[n], load * floats[n + 1], load * floats[n + 2]
            if friction > 0.0:
                u, v, w, part = pull(y, floats, ints, p, s, load, grip)
                x, y_, z = x - part * grip * u, y_ - part * grip * v, z - part * grip * w
            at = ints[own + layout.FORCE]
            floats[at] += x
            floats[at + 1] += y_
            floats[at + 2] += z
            for k in range(corners):
                at, share = ints[vertex(ints, corner(ints, f, k)) + layout.FORCE], floats[found + layout.SHARES + k]
                floats[at] -= share * x
                floats[at + 1] -= share * y_
                floats[at + 2] -= share * z


@lean(types.void(A, A, I, N, N, F, F, F), inner=True)
def hold_at(y, floats, ints, p, s, u, v, w):
    """Have friction hold vertex p at the nearest place of skin s less (u, v, w) along its face [m]."""
    found, hold = ints[layout.BEST] + layout.FOUND * s, holds(ints, p, s)
    f = int(floats[found + layout.FACE])
    a = ints[vertex(ints, corner(ints, f, 0)) + layout.POSITION]
    b = ints[vertex(ints, corner(ints, f, 1)) + layout.POSITION]
    c = a if ints[layout.CORNERS] == 2 else ints[vertex(ints, corner(ints, f, 2)) + layout.POSITION]
    ex, ey, ez = y[b] - y[a], y[b + 1] - y[a + 1], y[b + 2] - y[a + 2]
    gx, gy, gz = y[c] - y[a], y[c + 1] - y[a + 1], y[c + 2] - y[a + 2]
    ee, eg, gg = ex * ex + ey * ey + ez * ez, ex * gx + ey * gy + ez * gz, gx * gx + gy * gy + gz * gz
    by_e, by_g = u * ex + v * ey + w * ez, u * gx + v * gy + w * gz
    det = ee * gg - eg * eg if c != a else ee
    first = second = 0.0
    if det > 0.0:
        first = (gg * by_e - eg * by_g) / det if c != a else by_e / det
        second = (ee * by_g - eg * by_e) / det if c != a else 0.0
    shares, parts = found + layout.SHARES, hold + layout.PARTS
    floats[hold + layout.ON] = f
    floats[parts] = floats[shares] + first + second
    floats[parts + 1], floats[parts + 2] = floats[shares + 1] - first, floats[shares + 2] - second


@lean(AFTER_STEP, inner=True)
def hold(t0, t1, y0, rate0, y1, floats, ints):
    """Where friction holds from now on: what has slid keeps the pull that it had, and so the rate stays."""
    gap = floats[ints[layout.NUMBERS] + layout.GAP]
    lay_where_near(y1, floats, ints, gap)
    for p in range(ints[layout.VERTICES]):
        near = is_near(y1, floats, ints, p, gap)
        for s in range(ints[layout.SKINS]):
            at = holds(ints, p, s)
            if not (near and floats[ints[layout.BEST] + layout.FOUND * s] < gap):
                floats[at + layout.ON] = -1.0
                continue
            load, grip = pressed(floats, ints, p, s)
            u, v, w, part = pull(y1, floats, ints, p, s, load, grip)
            if floats[at + layout.ON] < 0.0 or part < 1.0:
                hold_at(y1, floats, ints, p, s, part * u, part * v, part * w)
    return False


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
    go(y, floats, ints)
    lay(y, floats, ints, reach)
    for p in range(ints[layout.VERTICES]):
        if known(floats, ints, p) >= reach:
            continue
        look(y, changed, floats, ints, p, reach)
        for s in range(ints[layout.SKINS]):
            part = min(part, KEPT * floats[ints[layout.BEST] + layout.FOUND * s])
    return part
