"""intersection: the common part of objects."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.kinds import FieldBuilder, Moment
from sceneql.shapes.blend import largest
from sceneql.shapes.csg import Combination
from sceneql.shapes.placement import compose

if TYPE_CHECKING:
    from sceneql.frame import Floats


class Intersection(Combination):
    """All that lies in every member: its field is the largest of theirs (Ricci 1973).

    A `blend` rounds the edges where members' surfaces meet, by the smooth maximum that mirrors the smooth minimum of
    a blended `union`: what is drawn lies inside of what would be without it. It has one material, its own; without a
    color and a material it shows the color of the member whose surface is seen, or the first member's where that has
    none.
    """

    def inside(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Its field from those of its members."""
        return largest(build, self.values(build, x, y, z, moment), self.width(moment))

    def gaps(self, build: FieldBuilder, values: list[int]) -> list[int]:
        """All turned inside out."""
        return [build.op("neg", value) for value in values]

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """What the boxes of its members have in common; inverted where that is nothing."""
        low, high = self.extents(compose(place, self.local(moment)), moment)
        return low.max(axis=0), high.min(axis=0)
