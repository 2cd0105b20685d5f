"""perspective: a camera with a field of view."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any

from sceneql.kinds import Angle, Camera, Direction, DrawnRef, FixedScalar, FixedTime, Moment, Position, Problem, field
from sceneql.pictures import framing

if TYPE_CHECKING:
    from sceneql.frame import View
    from sceneql.kinds.moment import Remembered


class Perspective(Camera):
    """A pinhole camera. It stands at `position`, or follows a part, or is fitted to what it shall show.

    With `fit`, or without `position` and `follow`, it stands as near as it can with the named parts (without names: all
    that is drawn) inside the picture over the whole film, in the given `direction`, or in that of `position` if given.

    For example `eye: {perspective: {position: 0 2 5 m, look_at: 0 1 0 m}}`.
    """

    position: Position | None = field("Where it stands.", None)
    look_at: Position | None = field("The point in the middle of the picture; by default what it shows.", None)
    follow: DrawnRef | None = field("A part that it moves with, and looks at.", None)
    from_: Position = field("Its place as seen from what it follows.", "0 1 4 m")
    lag: FixedTime = field("By how much it stays behind what it follows, softly: a time constant.", "0 s", at_least=0)
    fit: tuple[DrawnRef, ...] | None = field("The parts that must be in the picture over the whole film.", None)
    direction: Direction = field("With `fit`: from what it shows towards the camera.", "0.5 0.35 1")
    margin: FixedScalar = field("With `fit`: part of half the picture that is left free.", "0.08", at_least=0, below=1)
    field_of_view: Angle = field("Vertical field of view.", "40 deg", above=0, below=math.pi)
    up: Direction = field("What is upwards in the picture.", "0 1 0")

    def problems(self) -> Iterator[Problem]:
        """Two places, or no direction to look in."""
        here = "a camera cannot look at its own position"
        if self.follow is not None and (self.position is not None or self.fit is not None):
            text = "a camera that follows takes its place from `from`, not from `position` or `fit`"
            yield Problem(text, ("follow",), at_key=True)
        elif self.follow is not None:
            if self.look_at is None and self.from_.constant and not any(self.from_.number()):
                yield Problem(here, ("from_",))
        elif self.position is not None and self.look_at is not None:
            places = [place.number() for place in (self.position, self.look_at) if place.constant]
            if len(places) == 2 and places[0] == places[1]:
                yield Problem(here, ("look_at",))

    def looks_ahead(self) -> bool:
        """Whether its place or its aim is left to what is drawn."""
        return self.follow is None and (self.fit is not None or self.position is None or self.look_at is None)

    def aims(self) -> Iterable[str]:
        """What it follows or looks at."""
        yield from () if self.follow is None else (self.follow.name,)
        yield from () if self.look_at is None else {link.task: None for link in self.look_at.links}

    @cached_property
    def _followed(self) -> framing.Whereabouts:
        """Part whose past places the camera needs."""
        assert self.follow is not None
        return framing.Whereabouts(self.follow)

    def remembers(self) -> Iterable[tuple[Remembered, float, float]]:
        """Where the part was that it follows."""
        if self.follow is not None and self.lag > 0:
            yield self._followed, framing.LONGEST * self.lag, self.lag / framing.FINE

    def view(self, size: tuple[int, int], moment: Moment) -> View:
        """The view of this instant. Raises ValueError where it would look at its own position."""
        half = math.tan(0.5 * float(moment.at(self.field_of_view)))
        aim: Any = None if self.look_at is None else moment.at(self.look_at)
        up = moment.at(self.up)
        if self.follow is not None:
            target = framing.whereabouts(moment, self.follow)
            if self.lag > 0:
                target = framing.behind(moment.past(self._followed), moment.time, target, self.lag)
            origin = target + moment.at(self.from_)
            axes = framing.axes_towards(origin - (target if aim is None else aim), up)
        elif self.fit is None and self.position is not None:
            origin = moment.at(self.position)
            if aim is None:
                low, high = framing.bounds(moment, None)
                aim = (low + high) / 2
            axes = framing.axes_towards(origin - aim, up)
        else:
            low, high = framing.bounds(moment, self.fit)
            towards = moment.at(self.direction)
            if self.position is not None:
                towards = moment.at(self.position) - ((low + high) / 2 if aim is None else aim)
            axes = framing.axes_towards(towards, up)
            slopes = framing.seen_slopes(half, size, self.margin)
            origin, _ = framing.fitted(framing.corners(low, high), axes, slopes, aim)
        return framing.view(origin, axes, size, half)
