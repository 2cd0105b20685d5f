"""difference: its first member without the others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.kinds import FieldBuilder, Moment
from sceneql.simulation.csg import Combination

if TYPE_CHECKING:
    from sceneql.frame import Floats


class Difference(Combination):
    """The first member without the others: its field is max(f1, -f2, -f3, ...) (Ricci 1973)."""

    def inside(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Its field from those of its members."""
        first, *others = self.values(build, x, y, z, moment)
        for value in others:
            first = build.op("max", first, build.op("neg", value))
        return first

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """The box of its first member."""
        low, high = self.extents(place, moment)
        return low[0], high[0]
