"""union: several objects as one."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from sceneql.kinds import FieldBuilder, Moment, Shaped, VolumeMoments
from sceneql.shapes.apart import apart
from sceneql.shapes.blend import bulge, least
from sceneql.shapes.csg import Combination
from sceneql.shapes.placement import compose, mapped_box
from sceneql.shapes.solid import block

if TYPE_CHECKING:
    from sceneql.frame import Floats

SLOPE = 3**-0.5
"""Least ratio of a field to the distance, for fields in the maximum norm such as a box's."""


class Union(Combination):
    """All that lies in at least one member: its field is the least of theirs (Ricci 1973).

    With a `blend` k it is the smooth minimum of the fields a and b, min(a, b) - max(k - |a - b|, 0)^2 / (4 k)
    (Quilez), which fills the notches where members meet: between flat faces at a right angle by a parabola that
    starts at the distance k from the edge. Of more members it is their least weighted mean, with weights that such a
    quadratic term keeps apart (Nesterov 2005), whatever their order. Where no second surface is within k, nothing
    changes; where several run together it bulges, by k/4 for two and less than k/2 for any number. It asks for fields
    that are distances near the surface, as those of all solids but formulas and skeletons are. Nothing is filled
    farther from the members' boxes than the bulge reaches. The union has one material, its own; without a color and a
    material it shows the colors of its members, mixed where a blend runs between them.
    """

    bare = "shared"

    def inside(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Its field from those of its members; with a blend, cut at its box."""
        width = self.width(moment)
        value = least(build, self.values(build, x, y, z, moment), width)
        if width == 0.0:
            return value
        low, high = self._room(moment)
        if not ((low > -float("inf")) | (high < float("inf"))).any():
            return value
        return build.op("max", value, block(build, (x, y, z), low, high))

    def volume_moments(self, moment: Moment, measure: Callable[[Shaped], VolumeMoments]) -> VolumeMoments | None:
        """Those of its members together, where nothing blends and their boxes do not overlap; else None."""
        members = [moment.object(ref) for ref in self.members()]
        found = None if self.width(moment) > 0.0 else apart(members, moment, measure)
        return None if found is None else found.mapped(self.local(moment))

    def gaps(self, build: FieldBuilder, values: list[int]) -> list[int]:
        """They themselves."""
        return values

    def _room(self, moment: Moment) -> tuple[Floats, Floats]:
        """Low and high corner (3,) [m], in own coordinates, of the box around all members and blends between them."""
        import numpy as np

        low, high = self.extents(np.eye(3, 4), moment)
        room = bulge(len(self.of), self.width(moment)) / SLOPE
        return low.min(axis=0) - room, high.max(axis=0) + room

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """The box around those of its members and what is filled between them."""
        whole = compose(place, self.local(moment))
        if self.width(moment) > 0.0:
            return mapped_box(whole, *self._room(moment))
        low, high = self.extents(whole, moment)
        return low.min(axis=0), high.max(axis=0)
