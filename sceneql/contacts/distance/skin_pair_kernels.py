# mypy: ignore-errors
"""Pairs of skins among the contacts of rigid bodies (rigid_local_kernels), compiled where there are any."""

import numpy as np
from numba import types

from sceneql.compiled.kernels import kernel, lean
from sceneql.contacts.distance.convex import SHAPE
from sceneql.contacts.distance.manifold_kernels import NAME
from sceneql.contacts.distance.manifold_kernels import POINT as FLAT
from sceneql.contacts.distance.near_shapes_kernels import is_skinned, joined, reach_of, speed_at
from sceneql.contacts.distance.rigid_layout import BODIES, RESTITUTION_AT, SHAPES_AT, SKINS_AT
from sceneql.contacts.distance.rigid_rows_kernels import MOTION, PLACE, add_points, with_room
from sceneql.contacts.distance.skin_contact_kernels import MOST, POINT, safe, touching
from sceneql.system.signatures_kernels import A, F, I, N

ROUGH = 1e-3
"""Part of a body's reach that the margin of a pair has besides the way that it may go (rigid_local_kernels)."""


@kernel(types.Tuple((I, A, N))(F, A, I, N, N, A, A, A, F, N, I, A, N))
def skin_points(h, floats, ints, a, b, places, motions, before, margin, ahead, who, where, contacts):
    """The list of points (rigid_rows_kernels) with those of two skins behind; the arguments as of its add_points."""
    head, skins, n = ints[SHAPES_AT], ints[SKINS_AT], ints[BODIES]
    one, two, at_a, at_b, of_a, of_b = ints[skins + a], ints[skins + b], PLACE * a, PLACE * b, MOTION * a, MOTION * b
    reach = floats[ints[head + SHAPE * a + 1] + 1]
    size = min(reach, floats[ints[head + SHAPE * b + 1] + 1])
    curved = np.empty(MOST * POINT)
    if ahead == 0:
        fast = (margin - ROUGH * reach) / h
        if safe(floats, ints, one, two, places, at_a, at_b, motions, of_a, of_b, fast, h) < 0.0:
            return who, where, contacts
        count = touching(
            floats, ints, one, two, places, at_a, at_b, motions, of_a, of_b, h, fast, margin, size, curved
        )[0]
    else:
        count = touching(
            floats, ints, one, two, places, at_a, at_b, motions, of_a, of_b, 0.0, 1.0, margin, size, curved
        )[0]
    names = np.zeros(NAME, dtype=np.int64)
    restitution = floats[ints[RESTITUTION_AT]] if ahead == 0 else 0.0
    for k in range(count):
        who, where = with_room(who, where, contacts)
        flat, names[1] = curved[POINT * k : POINT * k + FLAT], k
        nx, ny, nz = curved[POINT * k + 7], curved[POINT * k + 8], curved[POINT * k + 9]
        add_points(
            who, where, contacts, 1, a, b, n, flat, names, nx, ny, nz, places, h, restitution, motions, before, ahead
        )
        contacts += 1
    return who, where, contacts


@lean(F(A, I, A, A, N, N), inner=True)
def nearing(floats, ints, places, motions, a, b):
    """The largest speed of points of two shapes against each other, at most."""
    head = ints[SHAPES_AT]
    reach = floats[ints[head + SHAPE * a + 1] + 1]
    fast = reach_of(motions, MOTION * a, reach)
    if b < ints[BODIES]:
        return fast + reach_of(motions, MOTION * b, floats[ints[head + SHAPE * b + 1] + 1])
    return fast + speed_at(places, motions, a, b, reach)


@lean(F(F, A, I, A, A, A, types.int64[:, ::1]), inner=True)
def shortened(h, floats, ints, places, motions, before, pairs):
    """How much of a step pairs of skins may do at once [s]."""
    n, head, least = ints[BODIES], ints[SHAPES_AT], h
    for p in range(pairs.shape[0]):
        a, b = pairs[p, 0], pairs[p, 1]
        if a < n and is_skinned(ints, a, b) and not joined(ints, a, b):
            reach = floats[ints[head + SHAPE * a + 1] + 1]
            fast = reach_of(motions, MOTION * a, reach) + reach_of(before, MOTION * a, reach)
            if b < n:
                other = floats[ints[head + SHAPE * b + 1] + 1]
                fast += reach_of(motions, MOTION * b, other) + reach_of(before, MOTION * b, other)
            else:
                fast += speed_at(places, motions, a, b, reach)
            one, two = ints[ints[SKINS_AT] + a], ints[ints[SKINS_AT] + b]
            part = safe(floats, ints, one, two, places, PLACE * a, PLACE * b, motions, MOTION * a, MOTION * b, fast, h)
            least = min(least, abs(part))
    return least
