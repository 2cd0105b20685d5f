# mypy: ignore-errors
"""Velocities and impulses with a moment at every contact that resists rolling and spinning.

The moment is at most a length times the normal force, against the turning of the one body in the other (Coulomb 1785).
Where they turn it is one bounded row along their relative spin, else three; bound and direction are those of the
solution before, until they change no more.
"""

import math

import numpy as np
from numba import types

from sceneql.bodies.rigid.groups_kernels import solve_groups
from sceneql.bodies.rigid.point_list import AT_NORMAL, AT_PUSH, BODY_A, BODY_B, WHERE, WHO
from sceneql.bodies.rigid.velocity_step_kernels import BODY_INTS, Q_AT
from sceneql.compiled.integers_kernels import filled
from sceneql.compiled.kernels import kernel, lean
from sceneql.linear.cones.cone_layout_kernels import ROW, ROW_GIVEN, ROW_HIGH, ROW_J, ROW_LOW, ROW_X
from sceneql.system.signatures_kernels import A, F, I, N

MOTION = 6
AXES = 3
TURNS = 12
"""Most solutions of a step."""
SAME = 1e-12
"""Change of bounds and directions, in parts of these, that counts no more."""
STILL = 1e-12
"""Relative spin [rad/s] up to which bodies do not turn in each other."""


@lean(types.UniTuple(F, 6)(F, F, F), inner=True)
def across(x, y, z):
    """Two unit vectors across a unit vector."""
    if abs(x) <= min(abs(y), abs(z)):
        u, v, w = 0.0, z, -y
    elif abs(y) <= abs(z):
        u, v, w = -z, 0.0, x
    else:
        u, v, w = y, -x, 0.0
    size = math.sqrt(u * u + v * v + w * w)
    u, v, w = u / size, v / size, w / size
    return u, v, w, y * w - z * v, z * u - x * w, x * v - y * u


@lean(types.UniTuple(F, 3)(N, I, N, A, A), inner=True)
def relative(n, who, k, motions, led):
    """The spin of the first body of a contact in the second, by motions of what is solved and of what is led."""
    a, b = who[WHO * k + BODY_A], who[WHO * k + BODY_B]
    p, q = MOTION * a + 3, MOTION * b + 3
    x, y, z = motions[p], motions[p + 1], motions[p + 2]
    if b < n:
        return x - motions[q], y - motions[q + 1], z - motions[q + 2]
    return x - led[q], y - led[q + 1], z - led[q + 2]


@lean(F(N, I, N, A, F, A, A, A, F, A, N, N), inner=True)
def aim(n, who, k, where, turns, spins, led, bounds, rolling, rows, first, free):
    """Write the rows of a contact for the normal impulse and the spins of the latest solution; what this changes.

    ``free`` 1: the spins are those without contacts, by which what is at rest would turn. ``bounds``: the latest bound,
    of each contact. ``turns``: 0 where one of both does not turn, being a mass.
    """
    at, q = WHERE * k, MOTION * who[WHO * k + BODY_B] + 3
    push = 0.0
    for c in range(3):
        push += where[at + AT_NORMAL + c] * where[at + AT_PUSH + c]
    bound = turns * rolling * max(0.0, push)
    x, y, z = relative(n, who, k, spins, led)
    size = math.sqrt(x * x + y * y + z * z)
    stuck = 1.0 if size <= STILL or free == 1 else 0.0
    row = ROW * (first + AXES * k)
    if size > STILL:
        x, y, z = x / size, y / size, z / size
    elif rows[row + ROW_J + 3] != 0.0 or rows[row + ROW_J + 4] != 0.0 or rows[row + ROW_J + 5] != 0.0:
        x, y, z = rows[row + ROW_J + 3], rows[row + ROW_J + 4], rows[row + ROW_J + 5]
    else:
        x, y, z = where[at + AT_NORMAL], where[at + AT_NORMAL + 1], where[at + AT_NORMAL + 2]
    change = abs(bound - bounds[k])
    for c in range(3):
        change = max(change, bound * abs((x, y, z)[c] - rows[row + ROW_J + 3 + c]))
    bounds[k] = bound
    tx, ty, tz, sx, sy, sz = across(x, y, z)
    for axis in range(AXES):
        e = (x, y, z) if axis == 0 else ((tx, ty, tz) if axis == 1 else (sx, sy, sz))
        own, given = row + ROW * axis, 0.0
        for c in range(3):
            rows[own + ROW_J + 3 + c], rows[own + ROW_J + 9 + c] = e[c], -e[c]
            if who[WHO * k + BODY_B] >= n:
                given -= e[c] * led[q + c]
        rows[own + ROW_GIVEN] = given
        most = bound if axis == 0 or stuck == 1.0 else 0.0
        rows[own + ROW_LOW], rows[own + ROW_HIGH] = -most, most
        rows[own + ROW_X] = min(most, max(-most, rows[own + ROW_X]))
    return change / bound if bound > 0.0 else (1.0 if change > 0.0 else 0.0)


@kernel(N(N, N, I, A, N, A, A, A, A, A, F, F, A, I, I, N), inner=True)
def solve_rolling(
    n, every, who, where, contacts, masses, motions, before, led, found, friction, rolling, bounded, sides, ints, own_at
):  # fmt: skip
    """As `groups_kernels.solve_groups`, with moments that resist rolling, of at most ``rolling`` [m] times the force.

    ``motions``: velocities without impulses; ``before``: at the start of the step; ``led``: those of what is led;
    ``ints[own_at:]``: the bodies' integers.
    """
    ties, loose = sides.size // 2, 0
    rows, both = np.zeros(ROW * (ties + AXES * contacts)), filled(2 * (ties + AXES * contacts), -1)
    turns, bounds = np.ones(contacts), np.zeros(contacts)
    for k in range(bounded.size):
        rows[k] = bounded[k]
    for k in range(sides.size):
        both[k] = sides[k]
    for k in range(contacts):
        a, b = who[WHO * k + BODY_A], who[WHO * k + BODY_B]
        for one in (a, b):
            if one < n and ints[own_at + BODY_INTS * one + Q_AT] < 0:
                turns[k] = 0.0
        for axis in range(AXES):
            at = 2 * (ties + AXES * k + axis)
            both[at], both[at + 1] = a, b if b < n else -1
    spins = before.copy()
    for turn in range(TURNS):
        change = 0.0
        for k in range(contacts):
            x, y, z = relative(n, who, k, spins, led)
            size = max(abs(x), abs(y), abs(z))
            # What does not turn at the start of the step is held against the way in which it would.
            rests = turn == 0 and size <= STILL
            part = aim(
                n, who, k, where, turns[k], motions if rests else spins, led, bounds, rolling, rows, ties,
                1 if rests else 0,
            )  # fmt: skip
            change = max(change, part)
        if turn > 0 and change <= SAME:
            break
        loose = solve_groups(n, every, who, where, contacts, masses, motions, found, friction, rows, both)
        for k in range(MOTION * every):
            spins[k] = found[k]
    for k in range(bounded.size):
        bounded[k] = rows[k]
    return loose
