# mypy: ignore-errors
"""Contacts of rigid bodies as a list of points: where they touch or may touch in a step, and what is asked there.

The list grows as it needs. A point is known from step to step by its pair and its name (manifold_kernels).
"""

import math

import numpy as np
from numba import types

from sceneql.bodies.rigid.point_list import (
    AT_ARM_A,
    AT_ARM_B,
    AT_GIVEN,
    AT_LED,
    AT_POINT,
    AT_PUSH,
    BODY_A,
    BODY_B,
    FIRST_NAME,
    LAST_NAME,
    WHERE,
    WHO,
)
from sceneql.bodies.rigid.velocity_step_kernels import BODY_INTS, Q_AT, X_AT
from sceneql.compiled.integers_kernels import longer
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.contacts.distance.manifold_kernels import MOST, NAME, POINT
from sceneql.contacts.distance.rigid_layout import BODIES, BODIES_AT
from sceneql.system.signatures_kernels import A, F, I, N

PLACE, MOTION = 7, 6
BOUNCES = 2.0
"""A contact bounces that approaches faster than the step's forces make it in so many steps."""


@kernel(types.Tuple((I, A))(I, A, N), inner=True)
def with_room(who, where, count):
    """The list, with room for another pair behind so many points."""
    if (count + MOST) * WHO <= who.size:
        return who, where
    more = 2 * count + 8 * MOST
    wider = np.empty(WHERE * more)
    for k in range(WHERE * count):
        wider[k] = where[k]
    return longer(who, WHO * count, WHO * more), wider


@lean(types.void(A, A, I, N), inner=True)
def note_places(y, places, ints, unit):
    """Write the places of the bodies in a state; ``unit`` 1: with quaternions of length 1."""
    for k in range(ints[BODIES]):
        x, q = ints[ints[BODIES_AT] + BODY_INTS * k + X_AT], ints[ints[BODIES_AT] + BODY_INTS * k + Q_AT]
        whole = 1.0
        if q >= 0 and unit == 1:
            whole = math.sqrt(y[q] ** 2 + y[q + 1] ** 2 + y[q + 2] ** 2 + y[q + 3] ** 2)
        for c in range(3):
            places[PLACE * k + c] = y[x + c]
        for c in range(4):
            places[PLACE * k + 3 + c] = y[q + c] / whole if q >= 0 else 1.0 * (c == 0)


@lean_inlined
def speed_along(motions, a, b, rx, ry, rz, sx, sy, sz, nx, ny, nz):
    """The normal velocity of a's point against b's."""
    p, q = MOTION * a, MOTION * b
    ux = motions[p] + motions[p + 4] * rz - motions[p + 5] * ry
    uy = motions[p + 1] + motions[p + 5] * rx - motions[p + 3] * rz
    uz = motions[p + 2] + motions[p + 3] * ry - motions[p + 4] * rx
    ux -= motions[q] + motions[q + 4] * sz - motions[q + 5] * sy
    uy -= motions[q + 1] + motions[q + 5] * sx - motions[q + 3] * sz
    uz -= motions[q + 2] + motions[q + 3] * sy - motions[q + 4] * sx
    return nx * ux + ny * uy + nz * uz


@lean(types.void(I, A, N, N, N, N, N, A, I, F, F, F, A, F, F, A, A, N), inner=True)
def add_points(
    who, where, at, count, a, b, n, points, names, nx, ny, nz, places, h, restitution, motions, before, ahead
):  # fmt: skip
    """Write the points of a manifold behind the first ``at`` of the list.

    Of the step's start (``ahead`` 0), with the velocities without contacts in ``motions``: the pair may come nearer by
    its gap, or bounces. Of its end, to which ``motions`` led: it is to be farther away by what it is too deep there.
    """
    for k in range(count):
        p, to, name = POINT * k, WHERE * (at + k), WHO * (at + k)
        who[name + BODY_A], who[name + BODY_B] = a, b
        who[name + FIRST_NAME], who[name + LAST_NAME] = names[NAME * k], names[NAME * k + 1]
        rx, ry, rz = points[p] - places[PLACE * a], points[p + 1] - places[PLACE * a + 1], 0.0
        rz = points[p + 2] - places[PLACE * a + 2]
        sx, sy = points[p + 3] - places[PLACE * b], points[p + 4] - places[PLACE * b + 1]
        sz = points[p + 5] - places[PLACE * b + 2]
        where[to], where[to + 1], where[to + 2] = nx, ny, nz
        where[to + AT_ARM_A], where[to + AT_ARM_A + 1], where[to + AT_ARM_A + 2] = rx, ry, rz
        where[to + AT_ARM_B], where[to + AT_ARM_B + 1], where[to + AT_ARM_B + 2] = sx, sy, sz
        for c in range(3):
            where[to + AT_PUSH + c], where[to + AT_POINT + c] = 0.0, points[p + c]
        gap = points[p + 6]
        given = gap / h
        will = speed_along(motions, a, b, rx, ry, rz, sx, sy, sz, nx, ny, nz)
        if ahead != 0:
            given -= will
        elif restitution > 0.0 and gap + h * will < 0.0:
            was = speed_along(before, a, b, rx, ry, rz, sx, sy, sz, nx, ny, nz)
            if was < 0.0 and -was > BOUNCES * abs(will - was):
                given = restitution * was
        where[to + AT_GIVEN] = given
        for c in range(3):
            where[to + AT_LED + c] = 0.0
        if b >= n:
            q = MOTION * b
            where[to + AT_LED] = motions[q] + motions[q + 4] * sz - motions[q + 5] * sy
            where[to + AT_LED + 1] = motions[q + 1] + motions[q + 5] * sx - motions[q + 3] * sz
            where[to + AT_LED + 2] = motions[q + 2] + motions[q + 3] * sy - motions[q + 4] * sx


@lean(types.void(I, A, N, I, A, N), inner=True)
def recall(who, where, count, kept_who, kept_push, kept):
    """Write the impulses of the step before to the points that have the names of then; both lists by rising pairs."""
    first = 0
    for k in range(count):
        w = WHO * k
        a, b = who[w + BODY_A], who[w + BODY_B]
        while first < kept:
            u = WHO * first
            if kept_who[u] > a or (kept_who[u] == a and kept_who[u + 1] >= b):
                break
            first += 1
        j = first
        while j < kept and kept_who[WHO * j] == a and kept_who[WHO * j + 1] == b:
            if (
                kept_who[WHO * j + FIRST_NAME] == who[w + FIRST_NAME]
                and kept_who[WHO * j + LAST_NAME] == who[w + LAST_NAME]
            ):
                for c in range(3):
                    where[WHERE * k + AT_PUSH + c] = kept_push[3 * j + c]
                break
            j += 1
