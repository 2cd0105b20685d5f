"""tube: a rope through points."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import pi
from typing import TYPE_CHECKING

from sceneql.failure import RunFailure
from sceneql.kinds import FieldBuilder, Length, Moment, Object, Points, Shaped, VolumeMoments, field
from sceneql.shapes.checked_values import positive
from sceneql.shapes.placement import apply, balls_box, uniform_scale
from sceneql.shapes.wire import chain

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape


class Tube(Object):
    """All points within a radius of the line through its points. Its field is the signed distance.

    For example `rail: {tube: {through: [0 0 0 m, 1 1 0 m, 2 0 0 m], radius: 2 cm}}`.
    """

    through: Points = field("The points it runs through, at least two.")
    radius: Length = field("Its radius.", "20 mm", above=0)
    closed: bool = field("It runs on from the last point to the first.", False)

    def _path(self, moment: Moment) -> Floats:
        """Points (n, 3) [m] in the parent's coordinates. Raises RunFailure for fewer than two."""
        import numpy as np

        points = np.asarray(moment.at(self.through), dtype=float).reshape(-1, 3)
        if len(points) < 2:
            message = f"a tube runs through at least two points, not {len(points)}"
            raise RunFailure(message, part="tube", time=moment.time, span=self.through.span)
        return np.concatenate([points, points[:1]]) if self.closed else points

    def implicit(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Signed distance to the nearest piece."""
        return chain(build, self._path(moment), positive(moment, self.radius, "radius"), x, y, z)

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """The box around its points and radius."""
        return balls_box(place, self._path(moment), positive(moment, self.radius, "radius"))

    def volume_moments(self, moment: Moment, measure: Callable[[Shaped], VolumeMoments]) -> VolumeMoments | None:
        """A capsule's, of a tube through two points: of a column and two halves of a ball."""
        import numpy as np

        path, r = self._path(moment), positive(moment, self.radius, "radius")
        if len(path) != (3 if self.closed else 2):
            return None
        along = path[1] - path[0]
        length = float(np.linalg.norm(along))
        column, ball = pi * r * r * length, 4 / 3 * pi * r**3
        across = column * r * r / 4 + ball * r * r / 5
        more = column * length**2 / 12 + ball * (r * r / 5 + length * length / 4 + 3 / 8 * r * length) - across
        axis = along / (length or 1.0)
        second = across * np.eye(3) + more * np.outer(axis, axis)
        return VolumeMoments(column + ball, path[0] + 0.5 * along, second)

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """Its pieces as capsules. Raises ValueError in a group that is stretched unevenly."""
        import numpy as np

        from sceneql.frame import Segments

        path = apply(place, self._path(moment))
        radius = positive(moment, self.radius, "radius") * uniform_scale(place)
        ends = np.stack([path[:-1], path[1:]], axis=1)
        yield Segments(name, moment.surface(name, self.material, self.color), ends, np.full(len(ends), radius))
