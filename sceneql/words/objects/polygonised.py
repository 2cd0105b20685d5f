"""polygonised: an object drawn as triangles with edges."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

from sceneql.kinds import Color, FieldBuilder, FixedLength, Moment, Object, ObjectRef, Ref, Shaped, VolumeMoments, field
from sceneql.shapes.solid import traced

if TYPE_CHECKING:
    from sceneql import frame
    from sceneql.frame import Floats

THICKNESS = 0.025
"""Default radius of the edges, relative to the cell."""


class Polygonised(Object):
    """An object with an inside as the triangles that marching cubes makes of it (Lorensen & Cline 1987).

    The vertices lie on its surface, the topology is that of the trilinear cell. Colors that are mixed in a field are
    those of the vertices. As a member, or to be collided with, it is the object itself.
    """

    unseen: ClassVar[str] = "it was empty, or smaller than its cells, whenever it was drawn"

    of: ObjectRef = field("The object, which is drawn by this one.")
    cell: FixedLength = field("Side of the cubes; an `iso_surface` has those of its field.", "50 mm", above=0)
    edges: bool = field("The edges of the triangles are drawn too.", True)
    smooth: bool = field("The triangles are shaded as the surface that they stand for.", False)
    edge_radius: FixedLength | None = field(
        "Radius of the drawn edges; by default a fortieth of a cell.", None, above=0
    )
    edge_color: Color = field("Color of the edges.", "0.05 0.05 0.06")

    def members(self) -> tuple[Ref, ...]:
        """Its object."""
        return (self.of,)

    def _object(self, moment: Moment) -> Shaped:
        child = moment.object(self.of)
        if child.material is None and child.color is None:
            return child.model_copy(update={"material": self.material, "color": self.color})
        return child

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[frame.Shape]:
        """A mesh of each of its object's surfaces, and the edges. Raises ValueError for too small cells."""
        import numpy as np

        from sceneql import frame
        from sceneql.mesh.facets import edges, faceted

        child = self._object(moment)
        shapes = list(child.lower(name, place, moment))
        if not all(map(_has_cells, shapes)):
            shapes = list(traced(child, name, place, moment))
        radius = THICKNESS * self.cell if self.edge_radius is None else self.edge_radius
        for shape in shapes:
            if isinstance(shape, frame.Grid):
                from sceneql.grids.maps.iso_mesh import meshed

                mesh = meshed(shape)
                mesh = mesh if self.smooth else replace(mesh, normals=None)
            elif isinstance(shape, frame.Implicit):
                mesh = faceted(shape, self.cell, self.smooth)
            if not len(mesh.triangles):
                continue
            yield replace(mesh, name=name)
            if self.edges:
                ends = edges(mesh.vertices, mesh.triangles)
                dark = replace(moment.surface(name, None, self.edge_color), roughness=1.0, specular=0.0)
                yield frame.Segments(name, dark, ends, np.full(len(ends), radius))

    def implicit(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """That of its object."""
        return moment.object(self.of).implicit(build, x, y, z, moment)

    def volume_moments(self, moment: Moment, measure: Callable[[Shaped], VolumeMoments]) -> VolumeMoments | None:
        """Those of its object."""
        return measure(moment.object(self.of))

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """That of its object."""
        return moment.object(self.of).extent(place, moment)


def _has_cells(shape: frame.Shape) -> bool:
    """Whether triangles are made on cells; a sheet is replaced by the solid of which it is the surface."""
    from sceneql import frame

    return isinstance(shape, frame.Grid) or (isinstance(shape, frame.Implicit) and shape.within is None)
