"""trail: the past path of points."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from sceneql.failure import RunFailure
from sceneql.kinds import Clock, Doubt, FixedTime, Length, Moment, Object, Quantity, Value, field
from sceneql.quantities import dimension as dim
from sceneql.shapes.checked_values import positive
from sceneql.shapes.placement import apply, uniform_scale

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape

PIECES, FINER = 60, 4
"""Default number of pieces of a trail where it is straight, and of those of a piece where it is not."""
STRAIGHT = 0.1
"""Largest distance of a path from a piece, in radii of the trail, with which it counts as straight there."""

PointOrPoints = Annotated[Value, Quantity(dim.LENGTH, None)]


class Trail(Object):
    """The way that a point, or each of some points, has come in the time before, as a chain of capsules.

    It is seen at even instants of the physics, so that it is the same at any frame rate, in a single picture too.

    For example `way: {trail: {of: swing.bob.position, keep: 2 s}}`.
    """

    decorates: ClassVar[bool] = True

    of: PointOrPoints = field("The point, or the points: `sky.moon.position`, `dust.positions`.")
    keep: FixedTime = field("How long it stays.", "1 s", above=0)
    every: FixedTime | None = field(
        "Time between its corners; by default a sixtieth of `keep`, and where it bends a fourth of that.", None, above=0
    )
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
        yield self.of, self.keep, self.keep / (PIECES * FINER) if self.every is None else self.every

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
        radius = positive(moment, self.radius, "radius") * uniform_scale(place)
        step = self.keep / (PIECES * FINER) if self.every is None else 0.0
        first, last, which = _pieces(times, path, step, STRAIGHT * radius)
        ends = np.stack([path[first, which], path[last, which]], axis=1)
        ages = (moment.time - 0.5 * (times[first] + times[last])) / self.keep
        radii = radius * (np.sqrt(np.maximum(1 - ages, 0.0)) if self.fade else np.ones(len(ages)))
        if len(ends):
            yield Segments(name, moment.surface(name, self.material, self.color), ends, radii)


def _pieces(times: Floats, path: Floats, step: float, near: float) -> tuple[Any, Any, Any]:
    """Corners, (n,) each, at which the pieces of trails begin and end, and which point each is of.

    ``path`` (instants, points, 3) [m] at ``times`` [s]. With a ``step`` [s] the corners between every FINER-th of them,
    counted from the start, are left out of paths that are within ``near`` [m] of the piece.
    """
    import numpy as np

    count, points = path.shape[:2]
    even = np.arange(points)
    if step == 0.0 or count < 3:
        first = np.repeat(np.arange(count - 1), points)
        return first, first + 1, np.tile(even, count - 1)
    fourth = np.rint(times[1:-1] / step).astype(np.int64) % FINER == 0
    stops = np.concatenate([[0], 1 + np.flatnonzero(fourth), [count - 1]])
    start, stop = stops[:-1], stops[1:]
    along = path[stop] - path[start]  # (pieces, points, 3)
    corner = np.minimum(start[:, None] + np.arange(1, FINER), stop[:, None])
    away = path[corner] - path[start][:, None]
    length = np.maximum((along * along).sum(axis=2), np.finfo(float).tiny)
    part = np.clip((away * along[:, None]).sum(axis=3) / length[:, None], 0.0, 1.0)[..., None]
    bends = (((away - part * along[:, None]) ** 2).sum(axis=3) > near * near).any(axis=1)
    piece, which = np.nonzero(~bends)
    bent, of = np.nonzero(bends)
    corners = np.column_stack([start, corner, stop])[bent]  # (bent pieces, FINER + 1)
    longer = corners[:, :-1] < corners[:, 1:]
    first = np.concatenate([start[piece], corners[:, :-1][longer]])
    last = np.concatenate([stop[piece], corners[:, 1:][longer]])
    return first, last, np.concatenate([which, np.repeat(of, longer.sum(axis=1))])
