"""Shapes of the bodies and objects in a contact: convex shapes, and skins of all if one is not convex.

Imports numpy: to be imported by the method that runs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.contacts.distance import convex
from sceneql.contacts.distance.convex import POINT, SHAPE, SKINNED, Convex
from sceneql.failure import RunFailure
from sceneql.island.start import Start
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from sceneql.contacts.distance.contact_skins import Skin
    from sceneql.frame import Floats
    from sceneql.kinds import Ref
    from sceneql.system import Assembly


class Shapes:
    """Shapes requested so far, with skins made on demand."""

    def __init__(self, assembly: Assembly) -> None:
        self._assembly = assembly
        self._asked: list[tuple[Convex, Ref, Floats, Floats | None]] = []
        self._skins: list[tuple[Convex, Skin]] = []

    def of(self, ref: Ref | None, center: Floats, place: Floats | None = None) -> Convex:
        """Shape of an object in its own axes from ``center`` (3,) [m].

        ``place`` (7,): position and quaternion of an object with given motion. Raises ScriptError for an object
        without a shape to touch with.
        """
        if ref is None:
            message = "a body without an object has no shape to touch with"
            raise ScriptError([Diagnostic("no-collider", message, self._assembly.line())])
        start: Any = Start(self._assembly)
        kind: Any = self._assembly.object(ref)
        try:
            found: Convex = kind.convex(start, center)
        except (TypeError, ValueError):
            skin = self._skin(None, ref, center, place)
            found = skin.shape()
            self._skins.append((found, skin))
        self._asked.append((found, ref, center, place))
        return found

    def _skin(self, shape: Convex | None, ref: Ref, center: Floats, place: Floats | None) -> Skin:
        from sceneql.contacts.distance.contact_skins import skin_of

        try:
            return skin_of(ref, center, shape, place, self._assembly)
        except (TypeError, ValueError, RunFailure) as error:
            message = f"'{ref.name}' does not collide with rigid bodies: {error}"
            help = f"name under `between` what may touch, without '{ref.name}'"
            raise ScriptError([Diagnostic("no-collider", message, ref.span, help)]) from None

    def skin(self, shape: Convex) -> Skin:
        """Skin of a shape that `of` returned; it is made at the first call."""
        for one, skin in self._skins:
            if one is shape:
                return skin
        (asked,) = (asked for asked in self._asked if asked[0] is shape)
        made = self._skin(*asked)
        self._skins.append((shape, made))
        return made

    def written(self, shapes: Sequence[Convex], at: int) -> list[int]:
        """Indices of each shape's skin, then the skins, to stand at index ``at``; empty if all shapes are convex."""
        if all(shape.kind != SKINNED for shape in shapes):
            return []
        begins: list[int] = []
        tail: list[int] = []
        for shape in shapes:
            begins.append(at + len(shapes) + len(tail))
            if shape.kind != POINT:
                tail += self.skin(shape).written(begins[-1], self._assembly)
        return [*begins, *tail]

    def gaps(
        self, shapes: Sequence[Convex], places: Sequence[Floats], moving: int
    ) -> Iterator[tuple[tuple[int, int], float]]:
        """Pairs with overlapping boxes at ``places`` (7,), one of them moving, and gaps [m]; infinite if skins miss."""
        from sceneql.contacts.distance.gap_kernels import gap
        from sceneql.contacts.distance.near_shapes_kernels import standing_pairs

        floats, ints = convex.joined(shapes)
        room, where = np.zeros(convex.room_length(shapes)), np.concatenate(places)
        begins = np.array(self.written(shapes, 0), dtype=np.int64)
        numbers = self._assembly.numbers()
        for a, b in standing_pairs(floats, ints, len(shapes), where, room).tolist():
            if a >= moving:
                break
            if SKINNED not in (shapes[a].kind, shapes[b].kind):
                yield (a, b), float(gap(floats, ints, SHAPE * a, SHAPE * b, where, 7 * a, 7 * b, room)[0])
                continue
            from sceneql.contacts.distance.skin_contact_kernels import MOST, POINT, touching

            size = min(shapes[a].reach, shapes[b].reach)
            points, still = np.empty(MOST * POINT), np.zeros(6)
            pair = begins[a], begins[b], where, 7 * a, 7 * b
            yield (a, b), float(touching(numbers, begins, *pair, still, 0, 0, 0.0, 1.0, 0.0, size, points)[1])
