"""difference: an object without others."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from sceneql.kinds import FieldBuilder, Moment
from sceneql.shapes.blend import largest
from sceneql.shapes.csg import Combination
from sceneql.shapes.placement import compose

if TYPE_CHECKING:
    from sceneql.frame import Floats


class Difference(Combination):
    """The first member without the others: its field is max(f1, -f2, -f3, ...) (Ricci 1973).

    A `blend` rounds the edges of holes, by the smooth maximum that mirrors the smooth minimum of a blended `union`:
    what is drawn lies inside of what would be without it. It has one material, its own; without a color and a material
    it shows the color of the member whose surface is seen: in a hole that of what cut it, or the first member's where
    that has none.
    """

    said_by: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("less", "minus", "without", "subtract", "holes", "hole", "cut", "cutter", "remove", "tool", "tools", "base"),
        "the first of `of` is what is cut, the others are cut away: write `of: [block, hole]`",
    )

    def inside(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Its field from those of its members."""
        first, *others = self.values(build, x, y, z, moment)
        return largest(build, [first, *(build.op("neg", value) for value in others)], self.width(moment))

    def gaps(self, build: FieldBuilder, values: list[int]) -> list[int]:
        """The first turned inside out, the others as they are."""
        return [build.op("neg", values[0]), *values[1:]]

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """The box of its first member."""
        low, high = self.extents(compose(place, self.local(moment)), moment)
        return low[0], high[0]
