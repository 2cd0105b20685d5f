# mypy: ignore-errors
"""Friction between skins in explicit methods, as that on objects (objects_friction_kernels.py)."""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.barrier import pairs_layout as layout
from sceneql.contacts.barrier.barrier_kernels import mobilized, slowed
from sceneql.contacts.barrier.objects_friction_kernels import ENOUGH, TURNS
from sceneql.contacts.barrier.on_bodies_kernels import lightness_of_body, strike_body
from sceneql.contacts.barrier.pairs_kernels import vertex
from sceneql.contacts.barrier.skin_forces_kernels import keep_all, sliding
from sceneql.system.signatures_kernels import AFTER_STEP


@lean_inlined
def strike(y, floats, ints, at, x, y_, z):
    """Change the velocities of a pair's vertices by an impulse, and take its energy as work."""
    for k in range(4):
        own, weight = vertex(ints, int(floats[at + k])), floats[at + layout.WEIGHTS + k]
        if ints[own + layout.ARM] >= 0:
            strike_body(y, floats, ints, own, weight * x, weight * y_, weight * z)
            continue
        inverse = floats[ints[own + layout.INVERSE]]
        for c in range(3):
            part = weight * (x if c == 0 else y_ if c == 1 else z)
            if ints[own + layout.HELD + c] != 1 and inverse > 0.0:
                v = ints[own + layout.VELOCITY] + c
                before = y[v]
                y[v] += inverse * part
                y[ints[own + layout.WORK]] -= 0.5 * part * (before + y[v])


@lean_inlined
def take_over(floats, ints, count):
    """Give the pairs of the list the friction that they had among the pairs before."""
    memory, before = ints[layout.MEMORY], ints[layout.LAGGED_BEFORE]
    other = 0
    for m in range(int(floats[memory + layout.LAGGED])):
        at = ints[layout.LAG_AT] + layout.LAG * m
        while other < count and floats[before + layout.BEFORE * other] < floats[at + layout.KEY]:
            other += 1
        floats[at + layout.MEAN] = 0.5 * floats[at + layout.LOAD]
        if other < count and floats[before + layout.BEFORE * other] == floats[at + layout.KEY]:
            for k in range(3):
                floats[at + layout.FRICTION_OF + k] = floats[before + layout.BEFORE * other + 1 + k]
            floats[at + layout.MEAN] += 0.5 * floats[before + layout.BEFORE * other + 4]


@lean(AFTER_STEP, inner=True)
def rub(t0, t1, y0, rate0, y1, floats, ints):
    """Let friction act on the velocities at the end of a step; whether it changed them."""
    memory, before, h = ints[layout.MEMORY], ints[layout.LAGGED_BEFORE], t1 - t0
    friction, slip = floats[ints[layout.FRICTION]], floats[ints[layout.NUMBERS] + layout.SLIP]
    if h <= 0.0:
        return False
    # Impulses of the old pairs are taken back, and those that the same pairs are to have are given with new weights.
    count = int(floats[memory + layout.LAGGED])
    for m in range(count):
        at = ints[layout.LAG_AT] + layout.LAG * m
        f = at + layout.FRICTION_OF
        floats[before + layout.BEFORE * m] = floats[at + layout.KEY]
        for k in range(3):
            floats[before + layout.BEFORE * m + 1 + k] = floats[f + k]
        floats[before + layout.BEFORE * m + 4] = floats[at + layout.LOAD]
        strike(y1, floats, ints, at, -h * floats[f], -h * floats[f + 1], -h * floats[f + 2])
    keep_all(y1, floats, ints)
    take_over(floats, ints, count)
    listed, total = int(floats[memory + layout.LAGGED]), 0.0
    for m in range(listed):
        at = ints[layout.LAG_AT] + layout.LAG * m
        f = at + layout.FRICTION_OF
        strike(y1, floats, ints, at, h * floats[f], h * floats[f + 1], h * floats[f + 2])
        total += friction * h * floats[at + layout.MEAN]
    for _ in range(TURNS):
        changed = 0.0
        for m in range(listed):
            at = ints[layout.LAG_AT] + layout.LAG * m
            f, n, light = at + layout.FRICTION_OF, at + layout.NORMAL, 0.0
            for k in range(4):
                weight = floats[at + layout.WEIGHTS + k]
                own = vertex(ints, int(floats[at + k]))
                if ints[own + layout.ARM] >= 0:
                    light += weight * weight * lightness_of_body(floats, ints, own)
                else:
                    light += weight * weight * floats[ints[own + layout.INVERSE]]
            light *= h
            a, b, c = floats[n], floats[n + 1], floats[n + 2]
            along = a * floats[f] + b * floats[f + 1] + c * floats[f + 2]
            u, v, w = sliding(y1, floats, ints, at)
            u -= light * (floats[f] - along * a)
            v -= light * (floats[f + 1] - along * b)
            w -= light * (floats[f + 2] - along * c)
            most = friction * floats[at + layout.MEAN]
            part = most * mobilized(slowed(math.sqrt(u * u + v * v + w * w), light * most, slip), slip)
            drag = -part / (1.0 + light * part)
            u, v, w = drag * u, drag * v, drag * w
            x, y_, z = u - floats[f], v - floats[f + 1], w - floats[f + 2]
            strike(y1, floats, ints, at, h * x, h * y_, h * z)
            floats[f], floats[f + 1], floats[f + 2] = u, v, w
            changed += h * math.sqrt(x * x + y_ * y_ + z * z)
        if changed <= ENOUGH * total:
            break
    return count > 0 or listed > 0
