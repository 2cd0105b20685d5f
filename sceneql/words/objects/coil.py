"""coil: a spring drawn between two points."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from sceneql.kinds import FieldBuilder, FixedScalar, Length, Moment, Object, Position, field
from sceneql.shapes.checked_values import positive
from sceneql.shapes.placement import apply, balls_box
from sceneql.shapes.wire import chain, helix, swept

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape

PIECES_OF_FIELD = 10
"""Number of straight pieces of each turn in the implicit field."""


class Coil(Object):
    """A wire from one place to another: a straight lead, a helix that opens and closes within half a turn, a lead.

    However far its ends are pulled apart it keeps its turns and its radius. Its field is the distance to a chain of
    straight pieces.

    For example `wire: {coil: {from: swing.hook.position, to: swing.bob.position, radius: 5 cm}}`.
    """

    from_: Position = field("Where it begins.", "0 1 0 m")
    to: Position = field("Where it ends.", "0 0 0 m")
    radius: Length = field("Radius of its turns, to the middle of the wire.", "80 mm", above=0)
    turns: FixedScalar = field("Number of turns.", "8", at_least=1, at_most=200)
    wire: Length = field("Thickness of the wire.", "20 mm", above=0)
    lead: FixedScalar = field("Part of its length that is straight, at either end.", "0.1", at_least=0, below=0.5)

    def path(self, moment: Moment, pieces: int = 24) -> tuple[Floats, Floats]:
        """Points (n, 3) of the middle of the wire, ``pieces`` a turn, and vectors (n, 3) that point outwards there."""
        radius = positive(moment, self.radius, "radius")
        return helix(moment.at(self.from_), moment.at(self.to), radius, self.turns, self.lead, pieces)

    def _wire(self, moment: Moment) -> float:
        return 0.5 * positive(moment, self.wire, "wire")

    def implicit(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Distance to the nearest piece of the wire."""
        return chain(build, self.path(moment, PIECES_OF_FIELD)[0], self._wire(moment), x, y, z)

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """The box around its wire."""
        return balls_box(place, self.path(moment)[0], self._wire(moment))

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """A smooth mesh."""
        import numpy as np

        from sceneql.frame import Mesh

        vertices, normals, triangles = swept(*self.path(moment), self._wire(moment))
        if np.linalg.det(place[:, :3]) < 0:
            triangles = triangles[:, ::-1].copy()
        bent = normals @ np.linalg.inv(place[:, :3])
        bent /= np.linalg.norm(bent, axis=1, keepdims=True)
        surface = moment.surface(name, self.material, self.color)
        yield Mesh(name, surface, apply(place, vertices), triangles, bent)
