"""iso_surface: the surface on which a deep field has a value."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from sceneql.kinds import Moment, Object, Problem, field
from sceneql.simulation.maps.names import ColorMap
from sceneql.simulation.maps.seen import Field, Levels, level_of, seen, unfit
from sceneql.simulation.placement import apply

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape
    from sceneql.simulation.maps.seen import Seen
    from sceneql.simulation.maps.sheets import Sheet


class IsoSurface(Object):
    """The surface on which a field that fills a space has a value, by marching cubes between the centers of its cells.

    Its front faces lower values (Lorensen & Cline 1987; of the topology that the trilinear interpolant has in each
    cube, Chernyaev 1995), its normals are those of the interpolated gradient. It ends where the domain does.
    """

    of: Field = field("The field: `room.concentration`.")
    at: Levels = field("The value, or several.")
    colors: ColorMap | None = field("A map that gives each of several values its color, the least the low end's.", None)

    def problems(self) -> Iterator[Problem]:
        """Fields of no part or of several; values of other dimensions."""
        yield from unfit(self.of, {"at": self.at})

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """A smooth mesh a value. Raises ValueError for a flat field."""
        import numpy as np

        from sceneql.frame import Mesh
        from sceneql.simulation.maps.colors import colored

        surface = moment.surface(name, self.material, self.color)
        whole = seen(self.of, moment)
        if whole.layout.shape[2] == 1:
            raise ValueError("a flat field has no surfaces of a value: a `field_map` draws its contours")
        values = np.ravel(moment.at(self.at))
        for value in values:
            sheet = self._sheet(whole, float(value), moment)
            if not len(sheet.triangles) or sheet.normals is None:
                continue
            if self.colors is not None and np.ptp(values) > 0:
                scale = float(values.min()), float(values.max())
                r, g, b = colored(np.array([value]), scale, self.colors)[0]
                surface = replace(surface, color=(float(r), float(g), float(b)))
            normals = sheet.normals @ np.linalg.inv(place[:, :3])
            normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
            triangles = sheet.triangles if np.linalg.det(place[:, :3]) > 0 else sheet.triangles[:, ::-1].copy()
            yield Mesh(name, surface, apply(place, sheet.vertices), triangles, normals)

    def _sheet(self, field: Seen, value: float, moment: Moment) -> Sheet:
        import numpy as np

        from sceneql.simulation.maps.iso import iso_sheet
        from sceneql.simulation.maps.sheets import Sheet, kept

        found = iso_sheet(*field.interpolation.nodes(value - field.filled))
        slopes = field.interpolation.gradient(field.filled, found.vertices)
        size = np.linalg.norm(slopes, axis=1, keepdims=True)
        sheet = Sheet(found.vertices, found.triangles, -slopes / np.maximum(size, 1e-300))
        level = level_of(field, moment)
        return sheet if level is None else kept(sheet, level.values)
