"""images: numbered pictures of the frames."""

from __future__ import annotations

from typing import ClassVar

from sceneql.kinds import Clock, FixedScalar, Picture, Sink, Tools, field
from sceneql.words.outputs.image import _Stills


class Images(Picture):
    """A film as numbered PNG files (`name.0000.png`, ...), for other programs to cut."""

    imports: ClassVar[tuple[str, ...]] = ("PIL",)

    fps: FixedScalar | None = field("Frames a second; by default the clock's.", None, above=0, at_most=1000)
    compression: int = field(
        "Of the files: from 0, none, to 9, the smallest; 6 takes some three times as long as 1, for a quarter less.",
        1,
        at_least=0,
        at_most=9,
    )

    def times(self, clock: Clock) -> list[float]:
        """The instants [s] that it wants."""
        return clock.frames(clock.fps if self.fps is None else self.fps)

    def open(self, tools: Tools) -> Sink:
        """Start it."""
        return _Stills(self, tools, numbered=True, compression=self.compression)
