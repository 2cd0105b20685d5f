"""pyramid: a square, and a point above it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from sceneql.kinds import Length, Moment, field
from sceneql.shapes.placement import Placed, apply, compose

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape


class Pyramid(Placed):
    """A pyramid on a square about its own origin, with the tip up its own y axis."""

    width: Length = field("Side of the square.", "1 m", above=0)
    height: Length = field("From the square to the tip.", "1 m", above=0)

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """A mesh of six triangles. Its sizes may vary in time: ``moment.at`` is their value now."""
        import numpy as np

        from sceneql.frame import Mesh

        half, height = moment.at(self.width) / 2, moment.at(self.height)
        corners = [(-half, 0, -half), (half, 0, -half), (half, 0, half), (-half, 0, half), (0, height, 0)]
        triangles = np.array([(0, 1, 2), (0, 2, 3), (1, 0, 4), (2, 1, 4), (3, 2, 4), (0, 3, 4)], dtype=np.int32)
        vertices = apply(compose(place, self.local(moment)), np.array(corners, dtype=float))
        yield Mesh(name, moment.surface(name, self.material, self.color), vertices, triangles)
