# mypy: ignore-errors
"""Friction of a skin on objects in explicit methods: a force held through a step, which its end corrects.

Smooth friction is so stiff near rest that explicit methods would need steps of microseconds. So velocities at the end
of a step obey its law by impulses, with the mean loads of the step, point by point in turns until all fit (Gauss and
Seidel; Moreau 1988). Through the next step acts the force that would have given these impulses: what sticks feels no
change.
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.barrier import objects_layout as layout
from sceneql.contacts.barrier.barrier_kernels import mobilized, slowed
from sceneql.contacts.barrier.objects_kernels import distance, ends, load, place, sliding
from sceneql.contacts.barrier.on_bodies_kernels import lightness_of_body, strike_body
from sceneql.system.signatures_kernels import AFTER_STEP

TURNS = 30
"""Largest number of turns."""
ENOUGH = 1e-4
"""Change of all impulses in a turn, over what friction may give, at which turns end."""


@lean_inlined
def strike(y, floats, ints, p, x, y_, z):
    """Change the velocities of a point's nodes by an impulse, and take its energy as work."""
    if ints[layout.ARMS] >= 0:
        strike_body(y, floats, ints, ints[layout.ARMS] + 8 * p, x, y_, z)
        return
    held = ints[layout.LIST] + ints[layout.NODES] + 2 * ints[layout.EDGES]
    i, j = ends(ints, p)
    for node in (i, j):
        number = ints[ints[layout.LIST] + node]
        half = 0.5 * floats[ints[layout.INVERSE] + number]
        for c in range(3):
            part = x if c == 0 else y_ if c == 1 else z
            if ints[held + 3 * node + c] == 0 and half > 0.0:
                at = ints[layout.VELOCITY] + 3 * number + c
                before = y[at]
                y[at] += half * part
                y[ints[layout.WORK]] -= 0.25 * part * (before + y[at])


@lean_inlined
def lightness(floats, ints, p):
    """The inverse mass of a point."""
    if ints[layout.ARMS] >= 0:
        return lightness_of_body(floats, ints, ints[layout.ARMS] + 8 * p)
    i, j = ends(ints, p)
    at, first = ints[layout.INVERSE], ints[layout.LIST]
    if i == j:
        return floats[at + ints[first + i]]
    return 0.25 * (floats[at + ints[first + i]] + floats[at + ints[first + j]])


@lean(AFTER_STEP, inner=True)
def rub(t0, t1, y0, rate0, y1, floats, ints):
    """Let friction act on the velocities at the end of a step; whether it changed them."""
    numbers, objects, first = ints[layout.NUMBERS], ints[layout.OBJECTS], ints[layout.LAGGED] + layout.LOADS
    gap, slip = floats[numbers + layout.GAP], floats[numbers + layout.SLIP]
    friction, h, total, acts = floats[ints[layout.FRICTION]], t1 - t0, 0.0, False
    if h <= 0.0:
        return False
    for p in range(ints[layout.NODES] + ints[layout.EDGES]):
        px, py, pz = place(y1, floats, ints, p)
        for j in range(objects):
            at = first + layout.LAG * (objects * p + j)
            d, a, b, c = distance(floats, ints, p, j, px, py, pz, gap)
            pressed = load(floats, ints, p, d) if 0.0 < d < gap else 0.0
            floats[at + layout.MEAN] = 0.5 * (floats[at] + pressed)
            floats[at] = pressed
            if pressed > 0.0:
                floats[at + 1], floats[at + 2], floats[at + 3] = a, b, c
            total += friction * h * floats[at + layout.MEAN]
            f = at + layout.HELD
            acts = acts or total > 0.0 or floats[f] != 0.0 or floats[f + 1] != 0.0 or floats[f + 2] != 0.0
    if not acts:
        return False
    for _ in range(TURNS):
        changed = 0.0
        for p in range(ints[layout.NODES] + ints[layout.EDGES]):
            for j in range(objects):
                at = first + layout.LAG * (objects * p + j)
                f = at + layout.HELD
                u = v = w = 0.0
                if floats[at + layout.MEAN] > 0.0:
                    # The slip, and what it would be without this friction.
                    a, b, c = floats[at + 1], floats[at + 2], floats[at + 3]
                    light = h * lightness(floats, ints, p)
                    along = a * floats[f] + b * floats[f + 1] + c * floats[f + 2]
                    u, v, w = sliding(y1, floats, ints, p, j, a, b, c)
                    u -= light * (floats[f] - along * a)
                    v -= light * (floats[f + 1] - along * b)
                    w -= light * (floats[f + 2] - along * c)
                    most = friction * floats[at + layout.MEAN]
                    left = slowed(math.sqrt(u * u + v * v + w * w), light * most, slip)
                    part = most * mobilized(left, slip)
                    drag = -part / (1.0 + light * part)
                    u, v, w = drag * u, drag * v, drag * w
                elif floats[f] == 0.0 and floats[f + 1] == 0.0 and floats[f + 2] == 0.0:
                    continue
                x, y_, z = u - floats[f], v - floats[f + 1], w - floats[f + 2]
                strike(y1, floats, ints, p, h * x, h * y_, h * z)
                floats[f], floats[f + 1], floats[f + 2] = u, v, w
                changed += h * math.sqrt(x * x + y_ * y_ + z * z)
        if changed <= ENOUGH * total:
            break
    return True
