"""intersection: what lies in all of its members."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.kinds import FieldBuilder, Moment
from sceneql.simulation.csg import Combination

if TYPE_CHECKING:
    from sceneql.frame import Floats


class Intersection(Combination):
    """All that lies in every member: its field is the largest of theirs (Ricci 1973)."""

    def inside(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Its field from those of its members."""
        first, *others = self.values(build, x, y, z, moment)
        for value in others:
            first = build.op("max", first, value)
        return first

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """What the boxes of its members have in common; inverted where that is nothing."""
        low, high = self.extents(place, moment)
        return low.max(axis=0), high.min(axis=0)
