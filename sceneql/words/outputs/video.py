"""video: a film."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from itertools import pairwise
from typing import Any, ClassVar

from sceneql import kinds
from sceneql.kinds import Clock, Moment, Picture, Problem, Record, Ref, Sink, Tools, bounded_moments, field


class Shot(Record):
    """A piece of a film."""

    camera: kinds.CameraRef | None = field("Seen from; by default the film's own camera.", None)
    until: kinds.FixedTime | None = field("Where it ends in the simulation; by default the clock's end.", None, above=0)
    speed: kinds.FixedScalar | None = field(
        "Seconds of simulation in one of film; by default the clock's.", None, above=0
    )


class Video(Picture):
    """A film: MP4, H.264 in yuv420p (ITU-T H.264), readable everywhere.

    Frame i shows the instant i/fps of film time; `clock.speed` relates it to the simulation. With `shots` it is cut:
    each begins where the one before ends, from its own camera and at its own speed.
    """

    imports: ClassVar[tuple[str, ...]] = ("av", "imageio")
    said_by: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("duration", "length", "end", "seconds", "time"), "a film lasts as long as the clock: `clock: {end: 4 s}`"
    )

    fps: kinds.FixedScalar | None = field(
        "Frames a second; by default the clock's.", None, at_least=0.001, at_most=1000
    )
    quality: kinds.FixedScalar = field(
        "Constant rate factor of x264: 0 is lossless, 51 worst.", "17", at_least=0, at_most=51
    )
    shutter: kinds.FixedAngle = field(
        "How long the light of a frame is gathered, 360 deg being the time to the next: what moves is blurred, and "
        "drawing takes `exposures` times as long.",
        "0 deg",
        at_least=0,
        at_most=math.tau,
    )
    exposures: int = field("With a shutter: instants that a frame is made of.", 8, at_least=2, at_most=256)
    shots: tuple[Shot, ...] = field("Its pieces in their order: `[{camera: wide, until: 2 s}, {camera: near}]`.", ())

    def problems(self) -> Iterator[Problem]:
        """A size that no player shows; shots that end before they begin."""
        yield from super().problems()
        if any(side % 2 for side in self.pixels):
            text = f"a film's width and height must be even (yuv420p), not {self.pixels[0]} {self.pixels[1]}"
            yield Problem(text, ("size",))
        if self.shutter > 0 and self.layout:
            yield Problem("a film of several panels has no shutter", ("shutter",))
        for k, (one, after) in enumerate(pairwise(self.shots)):
            if one.until is None:
                yield Problem("this shot lasts to the end, so that none can follow", ("shots", k))
            elif after.until is not None and after.until <= one.until:
                yield Problem(f"this shot begins at {one.until:g} s and ends no later", ("shots", k + 1, "until"))

    def times(self, clock: Clock) -> list[float]:
        """The instants [s] that it wants."""
        times: list[float] = []
        rate = self.rate(clock)
        for start, end, speed in self._pieces(clock):
            frames = max(end - start, 0.0) / speed * rate
            bounded_moments(frames * self.parts)
            for k in range(math.ceil(round(frames, 9))):
                frame = start + k / rate * speed
                gathered = min(self.shutter / math.tau / rate * speed, clock.end - frame)
                times += [frame + part * gathered / self.parts for part in range(self.parts)]
        bounded_moments(len(times))
        return times or [0.0]

    def _pieces(self, clock: Clock) -> Iterator[tuple[float, float, float]]:
        """Start [s], end [s] and speed of each shot."""
        start = 0.0
        for shot in self.shots or (Shot(),):
            end = clock.end if shot.until is None else min(shot.until, clock.end)
            yield start, end, clock.speed if shot.speed is None else shot.speed
            start = end

    @property
    def parts(self) -> int:
        """Instants of the simulation in a frame."""
        return self.exposures if self.shutter > 0 else 1

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
        self.taken = 0

    def take(self, moment: Moment) -> None:
        picture = self.tools.pixels(self.video, moment, self.taken % self.video.parts, self.video.parts)
        self.taken += 1
        if picture is not None:
            self.writer.write(picture)

    def close(self) -> Iterable[Any]:
        return self.writer.close()  # type: ignore[no-any-return]

    def abort(self) -> Iterable[Any]:
        return self.writer.abort()  # type: ignore[no-any-return]
