"""outline: a flat domain inside a polygon."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import model_validator

from sceneql.kinds import Length, Moment, Object, Quantity, Record, field
from sceneql.quantities import dimension as dim

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape

Corner = Annotated[tuple[float, float], Quantity(dim.LENGTH, (2,))]


class Piece(Record):
    """A piece of an outline that has a name of its own."""

    first: int = field("Number of the corner where it begins, the first being 0.", at_least=0)
    last: int = field("Number of the corner where it ends.", at_least=0)


class Outline(Object):
    """What lies inside a polygon in the plane z = 0, less what lies inside its islands: a shore, a plate.

    Its corners stand in order, either way round; a side joins the last with the first. As the domain of a diffusion its
    boundary has the pieces that are named here, the islands, and `shore` for all the rest. It is drawn as a line.
    """

    points: tuple[Corner, ...] = field("Its corners, x and y.")
    islands: dict[str, tuple[Corner, ...]] = field("Polygons that are cut out of it.", {})
    pieces: dict[str, Piece] = field("Names of runs of sides: `{inlet: {first: 3, last: 5}}`.", {})
    thickness: Length = field("Of the line.", "1 cm", above=0)

    @model_validator(mode="after")
    def _simple(self) -> Outline:
        from sceneql.simulation.grids.polygon import crossing

        rings = {"outline": self.points, **self.islands}
        for name, ring in rings.items():
            if len(ring) < 3:
                raise ValueError(f"the {name} has {len(ring)} corners: a polygon has three or more")
        found = crossing(rings)
        if found is not None:
            (a, i), (b, k) = found
            other = "itself" if a == b else f"the {b}"
            raise ValueError(f"the {a} crosses {other}: the side from corner {i} meets that from corner {k}")
        for name, piece in self.pieces.items():
            if max(piece.first, piece.last) >= len(self.points) or piece.first == piece.last:
                raise ValueError(f"the piece {name} runs from one corner to another, of 0 to {len(self.points) - 1}")
        return self

    def rings(self) -> Mapping[str, Floats]:
        """The polygons by name, each (corners, 2) [m]; the outline itself is `shore`."""
        import numpy as np

        return {name: np.array(ring) for name, ring in {"shore": self.points, **self.islands}.items()}

    def domain(self) -> Any:
        """Its inside as the domain of a field (grids.polygon.Polygon)."""
        from sceneql.simulation.grids.polygon import Polygon

        return Polygon(self.rings(), {name: (piece.first, piece.last) for name, piece in self.pieces.items()})

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """The box around its corners, mapped by ``place``."""
        import numpy as np

        corners = np.concatenate([self._corners(), np.ones((len(self.points), 1))], axis=1) @ place.T
        return corners.min(axis=0), corners.max(axis=0)

    def _corners(self) -> Floats:
        import numpy as np

        return np.column_stack([np.array(self.points), np.zeros(len(self.points))])

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """Its sides as segments."""
        import numpy as np

        from sceneql.frame import Segments
        from sceneql.simulation.present import positive

        surface = moment.surface(name, self.material, self.color)
        sides = [np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in self.rings().values()]
        flat = np.concatenate(sides)
        ends = np.concatenate([flat, np.zeros((*flat.shape[:2], 1))], axis=2) @ place[:, :3].T + place[:, 3]
        yield Segments(name, surface, ends, np.full(len(ends), 0.5 * positive(moment, self.thickness, "thickness")))
