# mypy: ignore-errors
"""How crowded the events of pairs are: infinitely many in a finite time end as rest, the sooner the closer they come.

A body that tips from corner to corner, or is hit again and again while it bounces, has infinitely many impacts before
infinitely many instants. Each event of a pair adds 1 to its level, which falls by a factor of e in SPAN of its natural
time: that in which it falls by its size, or moves by it, if that is shorter.
"""

import math

from numba import types

from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_V, AT_W
from sceneql.compiled.kernels import lean
from sceneql.contacts.distance.convex import CORE, SHAPE
from sceneql.contacts.distance.core_kernels import FLOATS, KIND, REACH
from sceneql.contacts.rigid_exact.contact_kernels import three
from sceneql.contacts.rigid_exact.exact_rows_kernels import (
    BODIES,
    KEPT_AT,
    PAIRS,
    PAIRS_AT,
    SHAPES_AT,
    driven_at,
    mover_at,
    pull_at,
    spots,
)
from sceneql.contacts.rigid_exact.stop_kernels import FAST, FIRST_MOVER, SIZE
from sceneql.system.signatures_kernels import A, F, I, N

SPAN = 0.1
"""Part of the natural time in which events are forgotten."""
LOWEST = 1e-9
"""Height of the next bounce, in parts of the size of the smaller body, from which the bodies stay together."""
CALM, STEEP, DECADES = 50.0, 15.0, 6.0
"""Level up to which events are not crowded; what it rises by for this height to be tenfold; how often it may be."""
TIRED = 200.0
"""Level from which impacts have no restitution."""
ENDLESS = 3000.0
"""Level from which they have no end."""
OFTEN, LIES = 40.0, 8e-6
"""Level from which a circle that rocks on a face, or runs round on it, comes to lie there; the most that it is tilted
and rises then, in parts of its size: what rocks so often is tilted by about 0.01 over the level's square."""


@lean(F(A, I, N))
def quickness(floats, ints, pair):
    """The inverse of a pair's natural time [1/s]."""
    size = strongest = fastest = 0.0
    if pair >= ints[PAIRS]:  # a stop
        own = driven_at(ints, (pair - ints[PAIRS]) // 2)
        for side in range(2):
            x, y, z = three(floats, pull_at(ints, int(floats[own + FIRST_MOVER + side])))
            strongest = max(strongest, math.sqrt(x * x + y * y + z * z))
        return max(math.sqrt(strongest / floats[own + SIZE]), abs(floats[own + FAST]) / floats[own + SIZE])
    for side in range(2):
        k = ints[ints[PAIRS_AT] + 2 * pair + side]
        shape, mover = ints[SHAPES_AT] + SHAPE * k, mover_at(ints, k)
        reach = floats[ints[shape + FLOATS] + REACH] if k < ints[BODIES] or ints[shape + KIND] == CORE else math.inf
        size = reach if side == 0 else min(size, reach)
        if k < ints[BODIES]:
            x, y, z = three(floats, pull_at(ints, k))
            strongest = max(strongest, math.sqrt(x * x + y * y + z * z))
            x, y, z = three(floats, mover + AT_V)
            p, q, r = three(floats, mover + AT_W)
            fastest = max(fastest, math.sqrt(x * x + y * y + z * z) + reach * math.sqrt(p * p + q * q + r * r))
    return max(math.sqrt(strongest / size), fastest / size)


@lean(types.void(F, A, I, N))
def count_event(t, floats, ints, pair):
    """Count an event of a pair."""
    at = ints[KEPT_AT] + spots(ints) + 2 * pair
    since = (t - floats[at + 1]) * quickness(floats, ints, pair) / SPAN
    floats[at], floats[at + 1] = 1.0 + floats[at] * math.exp(-since), t


@lean(F(A, I, N))
def level(floats, ints, pair):
    """How crowded the events of a pair were at its latest."""
    return floats[ints[KEPT_AT] + spots(ints) + 2 * pair]


@lean(types.boolean(A, I, N))
def rocks_often(floats, ints, pair):
    """Whether a circle that rocks comes to lie, if it is low, at an event of a pair."""
    return level(floats, ints, pair) > OFTEN


@lean(F(A, I, N))
def lowest(floats, ints, pair):
    """Height of the next bounce, in parts of the smaller body, from which a pair stays together."""
    return LOWEST * 10.0 ** min(DECADES, max(0.0, (level(floats, ints, pair) - CALM) / STEEP))
