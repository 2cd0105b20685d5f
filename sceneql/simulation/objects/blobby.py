"""blobby: a soft skin around points and segments."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated

from pydantic import model_validator

from sceneql.failure import RunFailure
from sceneql.kinds import FieldBuilder, FixedScalar, Moment, Object, Points, Quantity, Value, field
from sceneql.quantities import dimension as dim
from sceneql.simulation.placement import balls_box
from sceneql.simulation.solid import traced

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape

LengthOrLengths = Annotated[Value, Quantity(dim.LENGTH, None)]
NumberOrNumbers = Annotated[Value, Quantity(dim.PLAIN, None)]


class Blobby(Object):
    """The solid in which the summed density of skeleton parts is above a threshold c.

    A part of radius R and weight w has the density w (1 - d^2/R^2)^3 at the distance d < R from it, and 0 beyond
    (Wyvill, McPheeters & Wyvill 1986; Blinn 1982 for the idea). Its parts are the segments, and the points that no
    segment ends at; a segment has the mean radius and weight of its two ends. A lone point of weight 1 is a ball of
    radius R sqrt(1 - c^(1/3)); two equal ones are one body up to the distance 2 R sqrt(1 - (c/2)^(1/3)).

    Its field is (c - density) L, where L turns it into a distance at the surface of a lone part of mean radius.
    """

    points: Points = field("The points of the skeleton.")
    segments: tuple[tuple[int, int], ...] = field("Pairs of points, counted from 0, that are joined.", ())
    radius: LengthOrLengths = field(
        "How far a point's density reaches: one for all, or one for each.", "0.3 m", above=0
    )
    weight: NumberOrNumbers = field("Factor of a point's density, one or one each; below 0 it hollows out.", "1")
    threshold: FixedScalar = field("The density at the surface.", "0.3", above=0, below=1)

    @model_validator(mode="after")
    def _one_or_one_each(self) -> Blobby:
        for name in ("radius", "weight"):
            if len(getattr(self, name).expr.type.shape) > 1:
                raise ValueError(f"{name} is one value, or a list with one for each point")
        if self.points.expr.type.shape[0] == 0:
            raise ValueError("a skeleton has at least one point")
        if any(k < 0 for pair in self.segments for k in pair):
            raise ValueError("points are counted from 0")
        return self

    def parts(self, moment: Moment) -> Floats:
        """(p, 8) skeleton parts as in frame.Tape, in its parent's coordinates.

        Raises RunFailure for a segment to a point that is not there, and for lists of other lengths than the points'.
        """
        import numpy as np

        points = np.asarray(moment.at(self.points), dtype=float).reshape(-1, 3)
        n = len(points)
        pairs = np.array(self.segments, dtype=int).reshape(-1, 2)
        if pairs.size and pairs.max() >= n:
            raise self._failure(
                f"there is no point {pairs.max()}: the {n} points are 0 to {n - 1}", self.points, moment
            )
        lone = np.setdiff1d(np.arange(n), pairs)
        ends = np.concatenate([pairs, np.column_stack([lone, lone])])
        radii, weights = self._each(self.radius, n, moment), self._each(self.weight, n, moment)
        if not (np.isfinite(radii).all() and (radii > 0).all()):
            raise self._failure(f"a radius must be above 0, but one is {np.min(radii):g} m now", self.radius, moment)
        return np.column_stack(
            [points[ends[:, 0]], points[ends[:, 1]], radii[ends].mean(axis=1), weights[ends].mean(axis=1)]
        )

    def _each(self, value: Value, n: int, moment: Moment) -> Floats:
        import numpy as np

        numbers = np.asarray(moment.at(value), dtype=float)
        if numbers.ndim == 0:
            return np.full(n, float(numbers))
        if numbers.shape != (n,):
            raise self._failure(f"there are {n} points, but {len(numbers)} values here", value, moment)
        return numbers

    def _failure(self, message: str, value: Value, moment: Moment) -> RunFailure:
        return RunFailure(message, part="blobby", time=moment.time, span=value.span)

    def implicit(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """(threshold - density) times a length. Raises RunFailure as ``parts`` does."""
        parts = self.parts(moment)
        u = self.threshold ** (1 / 3)
        lone = float(parts[:, 6].mean()) / (6 * u * u * (1 - u) ** 0.5) if len(parts) else 1.0
        depth = build.op("sub", build.constant(self.threshold), build.density(parts, x, y, z))
        return build.op("mul", depth, build.constant(lone))

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """The box around its parts, as far as the density can be above the threshold; inverted if nowhere."""
        import numpy as np

        from sceneql.simulation.density import reaches

        parts = self.parts(moment)
        reach = reaches(parts, self.threshold)
        solid = reach > 0
        if not solid.any():
            return np.full(3, np.inf), np.full(3, -np.inf)
        return balls_box(place, parts[solid, :6].reshape(-1, 2, 3), reach[solid, None])

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """Its density as a tape."""
        return traced(self, name, place, moment)
