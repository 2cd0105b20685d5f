# mypy: ignore-errors
"""A closed line of vertices in the plane z = 0: its tension, and what keeps the area inside."""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.skins.skin_layout import (
    COUNT,
    DEPTH_AT,
    FORCE_AT,
    HELD_AT,
    LENGTHS_AT,
    MODULUS_AT,
    NORMALS_AT,
    POSITION_AT,
    PRETENSION_AT,
    STIFFNESS_AT,
    TALLY_AT,
    VOLUME_AT,
)
from sceneql.system.signatures_kernels import AFTER_STEP, TERM

MOST = 20
"""Newton's updates of the area."""
ROUNDING = 2e-16
"""Of a sum of as many areas as vertices, in parts of the whole, where updates end."""


LEAST = 0.1
"""The least slope of Skalak's law that a solver is told, in parts of that at its own length: it turns when pressed."""


@lean_inlined
def by_stretch(s, floats, ints):
    """What a side pulls [N] at s, length over own length: pretension + stiffness (s - 1) + modulus (s - 1/s^3) + skalak
    (s^3 - s), the last two of sheets that do not stretch across."""
    modulus, skalak = floats[ints[MODULUS_AT]], floats[ints[MODULUS_AT] + 1]
    sheets = modulus * (s - 1.0 / (s * s * s)) + skalak * (s * s * s - s)
    return floats[ints[PRETENSION_AT]] + floats[ints[STIFFNESS_AT]] * (s - 1.0) + sheets


@lean_inlined
def slope(s, floats, ints):
    """How much that grows by s [N]."""
    modulus, skalak = floats[ints[MODULUS_AT]], floats[ints[MODULUS_AT] + 1]
    sheets = modulus * (1.0 + 3.0 / (s * s * s * s)) + skalak * max(3.0 * s * s - 1.0, 2.0 * LEAST)
    return floats[ints[STIFFNESS_AT]] + sheets


@lean(TERM, inner=True)
def tension(t, y, rate, floats, ints):
    """Adds what each side pulls at its ends [N], by its stretch; or what a solver has found."""
    count, at, force = ints[COUNT], ints[POSITION_AT], ints[FORCE_AT]
    lengths, held = floats[ints[LENGTHS_AT] : ints[LENGTHS_AT] + count], floats[ints[HELD_AT] :]
    for v in range(count):
        w = v + 1 if v < count - 1 else 0
        dx, dy = y[at + 3 * w] - y[at + 3 * v], y[at + 3 * w + 1] - y[at + 3 * v + 1]
        length = math.sqrt(dx * dx + dy * dy)
        if length > 0.0:
            pull = by_stretch(length / lengths[v], floats, ints) / length
            px, py = pull * dx, pull * dy
            if held[0] != 0.0:
                px, py = held[1 + 2 * v], held[2 + 2 * v]
            floats[force + 3 * v] += px
            floats[force + 3 * v + 1] += py
            floats[force + 3 * w] -= px
            floats[force + 3 * w + 1] -= py


@lean_inlined
def area(y, at, count):
    """What a closed line goes around counterclockwise."""
    x0, y0 = y[at], y[at + 1]
    total = 0.0
    for v in range(1, count - 1):
        a, b = at + 3 * v, at + 3 * v + 3
        total += (y[a] - x0) * (y[b + 1] - y0) - (y[b] - x0) * (y[a + 1] - y0)
    return 0.5 * total


@lean_inlined
def corner_normals(y, at, count, out):
    """(count, 3) the derivative of the area by each vertex, in a row; the sum of their squares."""
    total = 0.0
    for v in range(count):
        a = at + 3 * (v - 1 if v > 0 else count - 1)
        b = at + 3 * (v + 1 if v < count - 1 else 0)
        out[3 * v], out[3 * v + 1] = 0.5 * (y[b + 1] - y[a + 1]), 0.5 * (y[a] - y[b])
        total += out[3 * v] ** 2 + out[3 * v + 1] ** 2
    return total


@lean(AFTER_STEP, inner=True)
def keep_area(t0, t1, y0, rate0, y1, floats, ints):
    """Moves the vertices by s dA/dX so that the area is what it was; at the end of a step sums what that put back.

    That is far less than a step's error, and so the rate stays.
    """
    count, at, depth = ints[COUNT], ints[POSITION_AT], floats[ints[DEPTH_AT]]
    wanted = floats[ints[VOLUME_AT]] / depth
    normals = floats[ints[NORMALS_AT] : ints[NORMALS_AT] + 3 * count]
    left = wanted - area(y1, at, count)
    if t1 > t0:
        y1[ints[TALLY_AT]] += abs(left) * depth
    for _ in range(MOST):
        if not abs(left) > ROUNDING * wanted:
            break
        s = left / corner_normals(y1, at, count, normals)
        for k in range(3 * count):
            y1[at + k] += s * normals[k]
        before, left = left, wanted - area(y1, at, count)
        if abs(left) >= 0.5 * abs(before):
            break
    return False
