"""union: what lies in any of its members."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.kinds import FieldBuilder, Moment
from sceneql.simulation.csg import Combination

if TYPE_CHECKING:
    from sceneql.frame import Floats


class Union(Combination):
    """All that lies in at least one member: its field is the least of theirs (Ricci 1973)."""

    def inside(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Its field from those of its members."""
        first, *others = self.values(build, x, y, z, moment)
        for value in others:
            first = build.op("min", first, value)
        return first

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """The box around those of its members."""
        low, high = self.extents(place, moment)
        return low.min(axis=0), high.max(axis=0)
