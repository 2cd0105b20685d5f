"""trail: the past path of points."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, ClassVar

from sceneql.failure import RunFailure
from sceneql.kinds import Clock, Doubt, FixedTime, Length, Moment, Object, Quantity, Value, field
from sceneql.quantities import dimension as dim
from sceneql.shapes.checked_values import positive
from sceneql.shapes.placement import apply, uniform_scale

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape

PIECES = 60
"""Default number of pieces of a trail."""

PointOrPoints = Annotated[Value, Quantity(dim.LENGTH, None)]


class Trail(Object):
    """The way that a point, or each of some points, has come in the time before, as a chain of capsules.

    It is seen at even instants of the physics, so that it is the same at any frame rate, in a single picture too.

    For example `way: {trail: {of: swing.bob.position, keep: 2 s}}`.
    """

    decorates: ClassVar[bool] = True

    of: PointOrPoints = field("The point, or the points: `sky.moon.position`, `dust.positions`.")
    keep: FixedTime = field("How long it stays.", "1 s", above=0)
    every: FixedTime | None = field("Time between its corners; by default a sixtieth of `keep`.", None, above=0)
    radius: Length = field("Its radius.", "10 mm", above=0)
    fade: bool = field("It thins out towards its old end, its cross-section evenly.", True)

    def doubts(self, clock: Clock) -> Iterable[Doubt]:
        """A trail that ends before the film's next frame: the physics' time is not the film's."""
        frame = clock.speed / clock.fps
        if self.keep < frame:
            text = f"a trail that stays {self.keep:g} s is not seen, since from frame to frame {frame:.6g} s pass"
            help = (
                f"a second of the film is {clock.speed:g} s: `keep: {clock.speed:g} s`, and a `radius` by what is seen"
            )
            yield Doubt("short-trail", text, None, help)

    def remembers(self) -> Iterable[tuple[Value, float, float]]:
        """The points."""
        yield self.of, self.keep, self.keep / PIECES if self.every is None else self.every

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """Its pieces. Raises RunFailure where the number of points is not the same all the time."""
        import numpy as np

        from sceneql.frame import Segments

        seen = [*moment.past(self.of), (moment.time, moment.at(self.of))]
        times = np.array([time for time, _ in seen])
        ways = [np.asarray(points, dtype=float).reshape(-1, 3) for _, points in seen]
        if len({len(points) for points in ways}) > 1:
            message = "the points of a trail must be the same all the time, but some have come or gone"
            raise RunFailure(message, part="of", time=moment.time, span=self.of.span)
        path = apply(place, np.stack(ways))
        ends = np.stack([path[:-1], path[1:]], axis=2).reshape(-1, 2, 3)
        radius = positive(moment, self.radius, "radius") * uniform_scale(place)
        ages = (moment.time - 0.5 * (times[:-1] + times[1:])) / self.keep
        thickness = np.sqrt(np.maximum(1 - ages, 0.0)) if self.fade else np.ones(len(ages))
        radii = np.repeat(radius * thickness, len(ways[0]))
        if len(ends):
            yield Segments(name, moment.surface(name, self.material, self.color), ends, radii)
