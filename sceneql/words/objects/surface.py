"""surface: the sheet of a cloth or the skin of a solid, drawn by an object."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from sceneql.kinds import Length, ModelRef, Moment, Object, field
from sceneql.shapes.checked_values import positive
from sceneql.shapes.placement import apply

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape


class Surface(Object):
    """The sheet of a cloth as a closed slab, smooth on both sides; cells with a torn side are left open.

    Of a solid of tetrahedra the outer faces, smooth; those with a torn edge are left out.
    """

    of: ModelRef = field("The cloth, or the solid.")
    thickness: Length = field("Thickness of a sheet.", "5 mm", above=0)

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """A smooth mesh. Raises ValueError for a model that has no surface."""
        from sceneql.bodies.spring_look import skin

        cloth: Any = moment.object(self.of)
        if "triangles" not in cloth.gives:
            raise ValueError(f"'{self.of.name}' has no surface; a cloth and a solid have one")
        triangles = moment.read(self.of.name, "triangles").astype("int32")
        if len(triangles):
            points = apply(place, moment.read(self.of.name, "positions"))
            half = 0.5 * positive(moment, self.thickness, "thickness")
            yield skin(name, moment.surface(name, self.material, self.color), points, triangles, half)
