"""difference: its first member without the others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.kinds import FieldBuilder, Moment
from sceneql.simulation.blend import largest
from sceneql.simulation.csg import Combination
from sceneql.simulation.placement import compose

if TYPE_CHECKING:
    from sceneql.frame import Floats


class Difference(Combination):
    """The first member without the others: its field is max(f1, -f2, -f3, ...) (Ricci 1973).

    A `blend` rounds the edges of holes, by the smooth maximum that mirrors the smooth minimum of a blended `union`:
    what is drawn lies inside of what would be without it.
    """

    def inside(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Its field from those of its members."""
        first, *others = self.values(build, x, y, z, moment)
        return largest(build, [first, *(build.op("neg", value) for value in others)], self.width(moment))

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """The box of its first member."""
        low, high = self.extents(compose(place, self.local(moment)), moment)
        return low[0], high[0]
