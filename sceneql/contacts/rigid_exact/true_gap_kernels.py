# mypy: ignore-errors
"""The true distance of a pair, and whether its kept contacts tell the same: what is not covered must not go unseen."""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.contacts.distance.convex import SHAPE
from sceneql.contacts.distance.gap_kernels import gap as distance
from sceneql.contacts.rigid_exact.contact_kernels import (
    GAP,
    PAIR,
    PUSHES,
    RECORD,
    SHAPE_A,
    SHAPE_B,
    SPEED,
    pace,
)
from sceneql.contacts.rigid_exact.curved_ahead_kernels import is_cut
from sceneql.contacts.rigid_exact.curved_find_kernels import ask, is_curved
from sceneql.contacts.rigid_exact.curved_meet_kernels import meet
from sceneql.contacts.rigid_exact.exact_rows_kernels import (
    KEPT,
    KEPT_AT,
    MEMORY_AT,
    PAIRS,
    PAIRS_AT,
    PLACE,
    PLACES_AT,
    RECORDS_AT,
    ROOM,
    ROOM_AT,
    SHAPES_AT,
    follow_all,
    look,
    mover_at,
    put_places,
    spots,
)
from sceneql.contacts.rigid_exact.features_kernels import smaller
from sceneql.system import channels
from sceneql.system.signatures_kernels import A, F, I, N

UNSEEN = 1e-6
"""Depth, and gap of what is held, in parts of the smaller body, that the contacts do not tell and that is an error."""
DRIFT, SINKS = 1e-3, 1e-9
"""Speed, in parts of the speeds that it is a sum of and [m/s], up to which a contact that pushed in the step before is
kept: what the step's error leaves is closed after it."""


@lean(F(A, I, N))
def true_gap(floats, ints, pair):
    """The signed distance of a pair [m], of the movers and places that were looked at."""
    a, b = ints[ints[PAIRS_AT] + 2 * pair], ints[ints[PAIRS_AT] + 2 * pair + 1]
    if is_curved(ints, ints[SHAPES_AT] + SHAPE * a):
        return meet(floats, ints, ask(ints, pair, a, b, mover_at(ints, a), mover_at(ints, b)), -1e300, 0, 0)[1]
    return distance(
        floats, ints, ints[SHAPES_AT] + SHAPE * a, ints[SHAPES_AT] + SHAPE * b, floats,
        ints[PLACES_AT] + PLACE * a, ints[PLACES_AT] + PLACE * b, floats[ints[ROOM_AT] : ints[ROOM_AT] + ints[ROOM]],
    )[0]  # fmt: skip


@lean(F(A, I, N, F))
def kept_gap(floats, ints, pair, most):
    """The least gap of the kept contacts of a pair, ``most`` at most."""
    for k in range(int(floats[ints[MEMORY_AT] + KEPT])):
        rec = ints[RECORDS_AT] + RECORD * k
        if floats[rec + PAIR] == pair:
            most = min(most, floats[rec + GAP])
    return most


@lean(types.boolean(A, I, N, F))
def drifts(floats, ints, pair, most):
    """Whether a kept contact of a pair that pushes has sunk below a gap, or approaches too fast to be kept."""
    for k in range(int(floats[ints[MEMORY_AT] + KEPT])):
        rec = ints[RECORDS_AT] + RECORD * k
        if floats[rec + PAIR] == pair and floats[rec + PUSHES] > 0.0:
            a, b = mover_at(ints, int(floats[rec + SHAPE_A])), mover_at(ints, int(floats[rec + SHAPE_B]))
            if floats[rec + GAP] < most or floats[rec + SPEED] < -SINKS - DRIFT * pace(floats, rec, a, b):
                return True
    return False


@lean(types.boolean(F, A, A, I, types.boolean))
def unseen(t, y, floats, ints, first):
    """Whether a pair is deeper than its contacts tell, or is held by contacts while it is apart.

    ``first``: at the start, when how deep they are is kept as what they may be.
    """
    look(t, y, floats, ints)
    put_places(y, floats, ints, ints[PLACES_AT])
    follow_all(floats, ints)
    found = False
    for pair in range(ints[PAIRS]):
        allowed = ints[KEPT_AT] + 3 * spots(ints) + pair
        now = true_gap(floats, ints, pair)
        if first:
            floats[allowed] = min(0.0, now)
            continue
        held = floats[ints[KEPT_AT] + pair] > 0.0
        told = kept_gap(floats, ints, pair, math.inf if held else 0.0)
        size = smaller(floats, ints, ints[ints[PAIRS_AT] + 2 * pair], ints[ints[PAIRS_AT] + 2 * pair + 1])
        a, b = ints[ints[PAIRS_AT] + 2 * pair], ints[ints[PAIRS_AT] + 2 * pair + 1]
        if (
            floats[channels.FIXED] > 0.0
            and held
            and is_curved(ints, ints[SHAPES_AT] + SHAPE * a)
            and drifts(floats, ints, pair, min(0.0, floats[allowed]) - UNSEEN * size)
        ):
            found = True
        if is_curved(ints, ints[SHAPES_AT] + SHAPE * a) and now < size:
            found = found or is_cut(floats, ints, ask(ints, pair, a, b, mover_at(ints, a), mover_at(ints, b)))
        deeper = now < min(told, floats[allowed]) - UNSEEN * size
        found = found or deeper or (held and told < math.inf and now > told + UNSEEN * size)
    return found
