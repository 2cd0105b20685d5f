"""Base class of constructive solid geometry's words: members, fields of members, blend width, colors."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar

from sceneql.kinds import FieldBuilder, Length, Moment, ObjectRef, Problem, Ref, field
from sceneql.shapes.checked_values import not_negative
from sceneql.shapes.hues import Bare, joined
from sceneql.shapes.placement import inverse
from sceneql.shapes.solid import Solid

if TYPE_CHECKING:
    from sceneql.frame import Floats, Surface


class Combination(Solid):
    """Solids joined into one by set operations on their fields (Ricci 1973)."""

    of: tuple[ObjectRef, ...] | dict[str, ObjectRef] = field("The solids, by name or in place: at least two.")
    bare: ClassVar[Bare] = "first"
    blend: Length = field("How wide its edges are rounded where surfaces of members meet.", "0 m", at_least=0)

    def problems(self) -> Iterator[Problem]:
        """A problem where there are fewer than two members."""
        if len(self.of) < 2:
            yield Problem(f"{type(self).__name__.lower()} joins at least two objects", ("of",))

    def members(self) -> tuple[Ref, ...]:
        """References to the members, in order."""
        return tuple(self.of.values()) if isinstance(self.of, dict) else self.of

    def joins(self) -> tuple[Ref, ...]:
        """References to all members: the solid is made from the insides of all."""
        return self.members()

    def width(self, moment: Moment) -> float:
        """Width of the blend now [m]. Raises RunFailure where it is below 0."""
        return not_negative(moment, self.blend, "blend")

    def values(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> list[int]:
        """Registers of its members' fields. Raises TypeError where a member has no inside."""
        return [moment.object(ref).implicit(build, x, y, z, moment) for ref in self.members()]

    def gaps(self, build: FieldBuilder, values: list[int]) -> list[int]:
        """Registers of one number a member; at a point of the surface, the smallest belongs to the visible member."""
        raise NotImplementedError

    def hues(
        self, build: FieldBuilder, x: int, y: int, z: int, surface: Surface, moment: Moment
    ) -> tuple[int, int, int] | None:
        """Registers of the members' mixed colors; None where the combination has a color or material of its own."""
        if self.color is not None or self.material is not None:
            return None
        members = [(ref.name, moment.object(ref)) for ref in self.members()]
        at = build.affine(inverse(self.local(moment)), x, y, z)
        gaps = self.gaps(build, self.values(build, *at, moment))
        return joined(build, members, gaps, at, surface, self.bare, self.width(moment), moment)

    def extents(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """Low and high corners (m, 3) of the m members' boxes, mapped by ``place`` (3, 4)."""
        import numpy as np

        boxes = [moment.object(ref).extent(place, moment) for ref in self.members()]
        return np.array([low for low, _ in boxes]), np.array([high for _, high in boxes])
