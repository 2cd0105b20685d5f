"""The word `video`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, ClassVar

from sceneql.kinds import Clock, FixedScalar, Moment, Picture, Problem, Sink, Tools, field


class Video(Picture):
    """A film: MP4, H.264 in yuv420p (ITU-T H.264), readable everywhere.

    Frame i shows the instant i/fps of film time; `clock.speed` relates it to the simulation.
    """

    imports: ClassVar[tuple[str, ...]] = ("av", "imageio")

    fps: FixedScalar | None = field("Frames a second; by default the clock's.", None, above=0, at_most=1000)
    quality: FixedScalar = field("Constant rate factor of x264: 0 is lossless, 51 worst.", "17", at_least=0, at_most=51)

    def problems(self) -> Iterator[Problem]:
        """A size that no player shows."""
        if any(side % 2 for side in self.pixels):
            text = f"a film's width and height must be even (yuv420p), not {self.pixels[0]} {self.pixels[1]}"
            yield Problem(text, ("size",))

    def times(self, clock: Clock) -> list[float]:
        """The instants [s] that it wants."""
        return clock.frames(self.rate(clock))

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
