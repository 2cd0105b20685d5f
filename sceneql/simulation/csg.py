"""What the words of constructive solid geometry share: their members, their field, the blend where surfaces meet."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from sceneql.kinds import FieldBuilder, Length, Moment, ObjectRef, Problem, Ref, field
from sceneql.simulation.present import not_negative
from sceneql.simulation.solid import Solid

if TYPE_CHECKING:
    from sceneql.frame import Floats


class Combination(Solid):
    """Solids joined into one by set operations on their fields (Ricci 1973)."""

    of: tuple[ObjectRef, ...] | dict[str, ObjectRef] = field("The solids, by name or in place: at least two.")
    blend: Length = field("How wide its edges are rounded where surfaces of members meet.", "0 m", at_least=0)

    def problems(self) -> Iterator[Problem]:
        """Too few members."""
        if len(self.of) < 2:
            yield Problem(f"{type(self).__name__.lower()} joins at least two objects", ("of",))

    def members(self) -> tuple[Ref, ...]:
        """Its members."""
        return tuple(self.of.values()) if isinstance(self.of, dict) else self.of

    def joins(self) -> tuple[Ref, ...]:
        """All of them."""
        return self.members()

    def width(self, moment: Moment) -> float:
        """Of the blend now [m]. Raises RunFailure where it is below 0."""
        return not_negative(moment, self.blend, "blend")

    def values(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> list[int]:
        """Registers of its members' fields. Raises TypeError where a member has no inside."""
        return [moment.object(ref).implicit(build, x, y, z, moment) for ref in self.members()]

    def extents(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """Low and high corners (m, 3) of its members' boxes in the coordinates that ``place`` maps its own to."""
        import numpy as np

        boxes = [moment.object(ref).extent(place, moment) for ref in self.members()]
        return np.array([low for low, _ in boxes]), np.array([high for _, high in boxes])
