"""surface: the sheet of a cloth, drawn by an object."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from sceneql.kinds import Length, ModelRef, Moment, Object, field
from sceneql.simulation.placement import apply
from sceneql.simulation.present import positive

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape


class Surface(Object):
    """The sheet of a cloth as a closed slab, smooth on both sides; cells with a torn side are left open."""

    of: ModelRef = field("The cloth.")
    thickness: Length = field("Thickness of the sheet.", "5 mm", above=0)

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """A smooth mesh. Raises ValueError for a model that has no surface."""
        from sceneql.simulation.models.spring_look import sheet

        cloth: Any = moment.object(self.of)
        if "triangles" not in cloth.gives:
            raise ValueError(f"'{self.of.name}' has no surface; a cloth has one")
        triangles = moment.read(self.of.name, "triangles").astype("int32")
        if len(triangles):
            points = apply(place, moment.read(self.of.name, "positions"))
            half = 0.5 * positive(moment, self.thickness, "thickness")
            yield sheet(name, moment.surface(name, self.material, self.color), points, triangles, half)
