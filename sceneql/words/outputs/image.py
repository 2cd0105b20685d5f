"""image: one picture of an instant."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, ClassVar

from sceneql.kinds import Clock, FixedTime, Moment, Picture, Sink, Tools, field


class Image(Picture):
    """One picture as PNG (ISO/IEC 15948), at an instant of the simulation."""

    imports: ClassVar[tuple[str, ...]] = ("PIL",)

    time: FixedTime | None = field("The instant; by default the end of the clock.", None, at_least=0)
    compression: int = field("Of the file: from 0, none, to 9, the smallest and slowest.", 6, at_least=0, at_most=9)

    def times(self, clock: Clock) -> list[float]:
        """The instants [s] that it wants."""
        return [clock.end if self.time is None else min(self.time, clock.end)]

    def latest(self) -> tuple[str, float] | None:
        """Its instant."""
        return None if self.time is None else ("time", self.time)

    def open(self, tools: Tools) -> Sink:
        """Start it."""
        return _Stills(self, tools, numbered=False, compression=self.compression)


class _Stills:
    """Sink of PNG files: one, or a numbered sequence."""

    def __init__(self, picture: Picture, tools: Tools, *, numbered: bool, compression: int) -> None:
        self.picture, self.tools = picture, tools
        self.writer: Any = tools.encoder("png", numbered=numbered, compression=compression)

    def take(self, moment: Moment) -> None:
        self.writer.write(self.tools.pixels(self.picture, moment))

    def close(self) -> Iterable[Any]:
        return self.writer.close()  # type: ignore[no-any-return]

    def abort(self) -> Iterable[Any]:
        return self.writer.abort()  # type: ignore[no-any-return]
