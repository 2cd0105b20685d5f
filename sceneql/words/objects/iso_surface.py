"""iso_surface: the surface on which a deep field has a value."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from sceneql.grids.maps.map_names import ColorMap
from sceneql.grids.maps.seen import Field, Levels, seen, unfit
from sceneql.kinds import Moment, Object, Problem, field

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape


class IsoSurface(Object):
    """The surface on which a field that fills a space has a value: of the interpolant between the centers of its cells.

    Rays find its roots exactly, cell by cell; as `polygonised` it is drawn, and by `sceneql mesh` written, as what
    marching cubes make of it (Lorensen & Cline 1987; of the topology that the trilinear interpolant has in each cube,
    Chernyaev 1995). Its front faces lower values, its normals are those of the interpolated gradient. It ends where the
    domain does.
    """

    of: Field = field("The field: `room.concentration`.")
    at: Levels = field("The value, or several.")
    colors: ColorMap | None = field("A map that gives each of several values its color, the least the low end's.", None)

    def problems(self) -> Iterator[Problem]:
        """Fields of no part or of several; values of other dimensions."""
        yield from unfit(self.of, {"at": self.at})

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """A surface on the field's grid for each value that it has. Raises ValueError for a flat field."""
        import numpy as np

        from sceneql.frame import Grid
        from sceneql.grids.maps.colors import colored

        surface = moment.surface(name, self.material, self.color)
        whole = seen(self.of, moment)
        if whole.layout.shape[2] == 1:
            raise ValueError("a flat field has no surfaces of a value: a `field_map` draws its contours")
        to_nodes, low, high = whole.nodes(place)
        bounds = whole.bounds(moment)
        values = np.ravel(moment.at(self.at))
        for value in values:
            beyond = float(value) - whole.filled
            if not beyond.min() < 0.0 <= beyond.max():
                continue
            if self.colors is not None and np.ptp(values) > 0:
                scale = float(values.min()), float(values.max())
                r, g, b = colored(np.array([value]), scale, self.colors)[0]
                surface = replace(surface, color=(float(r), float(g), float(b)))
            yield Grid(name, surface, to_nodes, beyond, low, high, bounds)
