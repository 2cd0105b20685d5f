"""The word `video`."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import Any, ClassVar

from sceneql.kinds import (
    CameraRef,
    Clock,
    FixedScalar,
    FixedTime,
    Moment,
    Picture,
    Problem,
    Record,
    Ref,
    Sink,
    Tools,
    bounded_moments,
    field,
)


class Shot(Record):
    """A piece of a film."""

    camera: CameraRef | None = field("Seen from; by default the film's own camera.", None)
    until: FixedTime | None = field("Where it ends in the simulation; by default the clock's end.", None, above=0)
    speed: FixedScalar | None = field("Seconds of simulation in one of film; by default the clock's.", None, above=0)


class Video(Picture):
    """A film: MP4, H.264 in yuv420p (ITU-T H.264), readable everywhere.

    Frame i shows the instant i/fps of film time; `clock.speed` relates it to the simulation. With `shots` it is cut:
    each begins where the one before ends, from its own camera and at its own speed.
    """

    imports: ClassVar[tuple[str, ...]] = ("av", "imageio")

    fps: FixedScalar | None = field("Frames a second; by default the clock's.", None, above=0, at_most=1000)
    quality: FixedScalar = field("Constant rate factor of x264: 0 is lossless, 51 worst.", "17", at_least=0, at_most=51)

    shots: tuple[Shot, ...] = field("Its pieces in their order: `[{camera: wide, until: 2 s}, {camera: near}]`.", ())

    def problems(self) -> Iterator[Problem]:
        """A size that no player shows; shots that end before they begin."""
        if any(side % 2 for side in self.pixels):
            text = f"a film's width and height must be even (yuv420p), not {self.pixels[0]} {self.pixels[1]}"
            yield Problem(text, ("size",))
        for k, (one, after) in enumerate(pairwise(self.shots)):
            if one.until is None:
                yield Problem("this shot lasts to the end, so that none can follow", ("shots", k))
            elif after.until is not None and after.until <= one.until:
                yield Problem(f"this shot begins at {one.until:g} s and ends no later", ("shots", k + 1, "until"))

    def times(self, clock: Clock) -> list[float]:
        """The instants [s] that it wants."""
        if not self.shots:
            return clock.frames(self.rate(clock))
        times: list[float] = []
        start = 0.0
        for shot in self.shots:
            end = clock.end if shot.until is None else min(shot.until, clock.end)
            step = (clock.speed if shot.speed is None else shot.speed) / self.rate(clock)
            count = math.ceil(round(bounded_moments(max(end - start, 0.0) / step), 9))
            times += [start + k * step for k in range(count)]
            start = end
        bounded_moments(len(times))
        return times

    def seen_from(self, time: float) -> Ref | None:
        """The camera of the shot at an instant [s]."""
        return next((shot.camera for shot in self.shots if shot.until is None or time < shot.until), None)

    def rate(self, clock: Clock) -> float:
        """Frames a second of film."""
        return clock.fps if self.fps is None else self.fps

    def open(self, tools: Tools) -> Sink:
        """Start it."""
        return _Film(self, tools)


class _Film:
    def __init__(self, video: Video, tools: Tools) -> None:
        self.video, self.tools = video, tools
        self.writer: Any = tools.encoder("mp4", size=video.pixels, rate=video.rate(tools.clock), quality=video.quality)

    def take(self, moment: Moment) -> None:
        self.writer.write(self.tools.pixels(self.video, moment))

    def close(self) -> Iterable[Any]:
        return self.writer.close()  # type: ignore[no-any-return]

    def abort(self) -> Iterable[Any]:
        return self.writer.abort()  # type: ignore[no-any-return]
