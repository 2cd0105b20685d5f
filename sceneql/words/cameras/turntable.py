"""turntable: a camera that circles around a point."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from sceneql.kinds import Angle, Camera, DrawnRef, FixedScalar, FixedTime, Length, Moment, Position, Problem, field
from sceneql.pictures import framing
from sceneql.shapes.checked_values import positive

if TYPE_CHECKING:
    from sceneql.frame import View

AZIMUTHS = 72


class Turntable(Camera):
    """A camera that goes round at a constant height and distance, looking at what it goes around.

    Without `distance` it stands as near as it can with the parts of `fit` in the picture all the way round. With
    `follow` it moves with a part; then the size of what it fits counts, not the place.

    For example `round: {turntable: {around: ball, seconds: 12 s}}`.
    """

    said_by: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("speed", "rpm", "spin", "angular_speed", "angular_velocity", "rate", "omega"),
        "it has the time of a turn: for 30 deg/s write `seconds: 12 s`, for 10 rpm `seconds: 6 s`",
    )

    around: DrawnRef | None = field("The part it goes around; by default what it fits.", None)
    fit: tuple[DrawnRef, ...] | None = field(
        "The parts that must be in the picture all the way round; by default what it goes around, or all.", None
    )
    look_at: Position | None = field("The point in the middle; by default that of what it goes around.", None)
    follow: DrawnRef | None = field("A part that it keeps in the middle wherever it moves, and goes around.", None)
    seconds: FixedTime = field("Time of a turn.", "8 s", above=0)
    start: Angle = field("Where it begins, from +z towards +x.", "30 deg")
    tilt: Angle = field("How high it stands above the horizontal, as an angle.", "18 deg")
    distance: Length | None = field("Distance from the middle; by default as near as it can.", None, above=0)
    margin: FixedScalar = field("Part of half the picture that is left free.", "0.08", at_least=0, below=1)
    field_of_view: Angle = field("Vertical field of view.", "35 deg", above=0, below=math.pi)

    def problems(self) -> Iterator[Problem]:
        """Two middles of the picture."""
        if self.follow is not None and (self.around is not None or self.look_at is not None):
            text = "the middle of the picture is either what it follows, or `around` or `look_at`"
            yield Problem(text, ("follow",), at_key=True)

    def looks_ahead(self) -> bool:
        """Whether its distance or its middle is left to what is drawn."""
        return self.distance is None or (self.follow is None and self.look_at is None)

    def aims(self) -> Iterable[str]:
        """What it goes around."""
        return (ref.name for ref in (self.around, self.follow) if ref is not None)

    def view(self, size: tuple[int, int], moment: Moment) -> View:
        """The view of this instant."""
        half = math.tan(0.5 * float(moment.at(self.field_of_view)))
        tilt = float(moment.at(self.tilt))
        aim = self._middle(moment)
        if self.distance is not None:
            distance = positive(moment, self.distance, "distance")
        else:
            one = self.around or self.follow
            low, high = framing.bounds(moment, self.fit or (None if one is None else (one,)))
            center = (low + high) / 2 if self.follow is not None else aim
            points, slopes = framing.corners(low, high), framing.seen_slopes(half, size, self.margin)
            every = (framing.axes_towards(_towards(2 * math.pi * k / AZIMUTHS, tilt)) for k in range(AZIMUTHS))
            distance = max(framing.fitted(points, axes, slopes, center)[1] for axes in every)
        azimuth = float(moment.at(self.start)) + 2 * math.pi * moment.time / self.seconds
        axes = framing.axes_towards(_towards(azimuth, tilt))
        return framing.view(aim + distance * axes[2], axes, size, half)

    def _middle(self, moment: Moment) -> Any:
        """Point (3,) [m] at the center of the picture now."""
        if self.follow is not None:
            return framing.whereabouts(moment, self.follow)
        if self.look_at is not None:
            return moment.at(self.look_at)
        low, high = framing.bounds(moment, self.fit if self.around is None else (self.around,))
        return (low + high) / 2


def _towards(azimuth: float, tilt: float) -> Any:
    """Direction (3,) from the center of the picture towards the camera; angles [rad]."""
    return (math.cos(tilt) * math.sin(azimuth), math.sin(tilt), math.cos(tilt) * math.cos(azimuth))
