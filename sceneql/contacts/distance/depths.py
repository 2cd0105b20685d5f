"""How deep rigid bodies are in one another and in objects, measured from their places alone.

Imports numpy: to be imported by the method that runs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sceneql.contacts.distance import convex
from sceneql.contacts.distance.convex import SHAPE, SKINNED
from sceneql.contacts.distance.gap_kernels import gap
from sceneql.contacts.distance.near_shapes_kernels import standing_pairs

if TYPE_CHECKING:
    from sceneql.contacts.distance.convex import Convex
    from sceneql.frame import Floats
    from sceneql.kinds import Ref
    from sceneql.quantities.span import Span


@dataclass(frozen=True, slots=True)
class Overlap:
    """Two bodies, or a body and an object, that share some space."""

    pair: tuple[int, int]
    depth: float
    """[m]"""
    part: float
    """The depth as a part of the smaller one's reach."""


class Overlaps:
    """The bodies and objects of a contact, the bodies that move first."""

    def __init__(
        self,
        shapes: Sequence[Convex],
        places: Sequence[Floats],
        moving: Sequence[tuple[int, int]],
        refs: Sequence[Ref | None],
        led: Sequence[int],
        joined: set[tuple[int, int]],
        skins: Sequence[int],
        ints: Sequence[int],
        span: Span | None,
    ) -> None:
        """``places``: position and quaternion (7,) of each at the start; ``moving``: where both of a body stand in y.

        ``led``: numbers of the objects that move by themselves; ``joined``: pairs that ties join, which may overlap;
        ``skins``: where the skin of each begins among the integers ``ints`` of the contact, empty if all are convex.
        """
        self.refs, self.led, self.span = refs, led, span
        self._shapes, self._joined = shapes, joined
        self._places = np.array(places)
        self._in_y = np.array([[*range(x, x + 3), *range(q, q + 4)] for x, q in moving], dtype=np.int64)
        self._floats, self._ints = convex.joined(shapes)
        self._room = np.zeros(convex.room_length(shapes))
        self._skins = skins
        self._all = np.array(ints if skins else (), dtype=np.int64)

    def deepest(self, y: Floats, numbers: Floats, led: Sequence[Floats]) -> Overlap | None:
        """The deepest overlap in a state, where the island's floats are ``numbers``; None without any.

        ``led``: position and quaternion (7,) of the objects that move by themselves, now.
        """
        places, moving, found = self._places, len(self._in_y), None
        places[:moving] = y[self._in_y]
        for k, place in zip(self.led, led, strict=True):
            places[k] = place
        where = places.ravel()
        for a, b in standing_pairs(self._floats, self._ints, len(places), where, self._room).tolist():
            if a >= moving:
                break
            if (a, b) in self._joined:
                continue
            depth = -self._gap(a, b, where, numbers)
            if depth > 0.0:
                part = depth / min(self._shapes[a].reach, self._shapes[b].reach)
                if found is None or part > found.part:
                    found = Overlap((a, b), depth, part)
        return found

    def _gap(self, a: int, b: int, where: Floats, numbers: Floats) -> float:
        """The gap of two shapes [m], negative where they overlap."""
        one, other = self._shapes[a], self._shapes[b]
        if SKINNED not in (one.kind, other.kind):
            return float(gap(self._floats, self._ints, SHAPE * a, SHAPE * b, where, 7 * a, 7 * b, self._room)[0])
        from sceneql.contacts.distance.skin_contact_kernels import MOST, POINT, touching

        size = min(one.reach, other.reach)
        pair, still = (self._skins[a], self._skins[b], where, 7 * a, 7 * b), np.zeros(6)
        found = touching(numbers, self._all, *pair, still, 0, 0, 0.0, 1.0, 0.0, size, np.empty(MOST * POINT))
        return float(found[1])
