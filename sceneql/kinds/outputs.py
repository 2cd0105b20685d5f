"""The family of outputs: films, pictures, tables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Protocol

from sceneql.kinds.types import CameraRef, DrawnRef, FixedScalar, PanelRef, RendererRef
from sceneql.kinds.word import Kind, Problem, Record, field

if TYPE_CHECKING:
    from sceneql.frame import Frame
    from sceneql.kinds.moment import Moment
    from sceneql.kinds.settings import Clock
    from sceneql.kinds.values import Ref


class Tools(Protocol):
    """The services that the pipeline gives an output."""

    @property
    def clock(self) -> Clock:
        """Film time and simulation time."""

    def path(self, extension: str) -> Any:
        """Path of a file of the output, as ``scene.extension``; also ``0001.ply``, one of many files."""

    def pixels(self, output: Picture, moment: Moment, part: int = 0, parts: int = 1) -> Any:
        """The developed picture (h, w, 3) uint8 of this output's camera, renderer and size.

        Of several ``parts`` of one exposure the light is added up; there is a picture after the last, else None.
        """

    def frame(self, moment: Moment, *, fields: bool = False) -> Frame:
        """A frame whose ``shapes`` (the closed set of sceneql.frame, in the world) are those to draw at the moment.

        With ``fields`` objects that have an inside come as their implicit field in a box (frame.Implicit), for
        polygonisation, whatever they are drawn as; others as they are drawn. Arrays of shapes that are held
        (frame.is_held) are the same objects in the next frame where they are the same. Raises RunFailure, with
        ``fields`` also for unbounded objects: let the script name parts by `show`.
        """

    def encoder(self, word: str, **settings: Any) -> Any:
        """A writer of pictures with ``write``, ``close`` and ``abort``.

        ``close`` lets the file appear under its final name; ``abort`` keeps what was made beside it.
        """


class Sink(Protocol):
    """An open output. ``close`` and ``abort`` return the paths of the files made."""

    def take(self, moment: Moment) -> None:
        """Take the next of the instants that `Output.times` asked for."""

    def close(self) -> Iterable[Any]:
        """Finish; files appear under their final names."""

    def abort(self) -> Iterable[Any]:
        """Stop after a failed run; what was made is kept beside the final name."""


class Output(Kind):
    """Something that is made: a film, a picture, a table, a file of shapes.

    One that ``draws`` gets the shapes of a moment from `Tools.frame`, and the graph keeps what these need: no camera,
    no light and no overlay, which are for pictures alone.
    """

    family: ClassVar[str] = "outputs"
    draws: ClassVar[bool] = False
    """Whether it draws shapes (`Tools.frame`)."""

    def shown(self) -> tuple[Ref, ...] | None:
        """The parts to draw, for an output that draws; None: all that is not hidden. (`show`, where it is a field.)"""
        return None

    def times(self, clock: Clock) -> list[float]:
        """The instants [s] of the simulation that it wants, increasing, from 0 to ``clock.end``; see `Clock.frames`.

        ``Frame.index`` counts these.
        """
        raise NotImplementedError

    def latest(self) -> tuple[str, float] | None:
        """The name and value [s] of a field that asks for an instant: refused where the clock ends before it."""
        return None

    def open(self, tools: Tools) -> Sink:
        """Start the output."""
        raise NotImplementedError


class EachVariant(Record):
    """Panels of a layout: the scene in every variant of the script, under its name."""

    each: Literal["variant"] = field("What there is a panel for.")
    columns: int | None = field("Panels side by side; by default up to three, of more a square.", None, at_least=1)
    share: FixedScalar = field("Height of a row of them, where a row of others has 1.", "1", above=0)


Row = EachVariant | tuple[PanelRef, ...]


class Picture(Output):
    """An output that draws frames: what every picture has."""

    draws: ClassVar[bool] = True

    size: tuple[int, int] | Literal["360p", "480p", "720p", "1080p", "4k"] = field(
        "Width and height [pixels], or the name of a 16:9 size.", (960, 540), at_least=2, at_most=16384
    )
    camera: CameraRef | None = field("Seen from; by default the script's first camera.", None)
    renderer: RendererRef | None = field("Drawn by; by default `trace`.", None)
    show: tuple[DrawnRef, ...] | None = field("Draws only these parts; by default all that is not hidden.", None)
    exposure: FixedScalar = field("Stops by which the picture is brightened.", "0", at_least=-20, at_most=20)
    layout: tuple[Row, ...] = field(
        "Several panels in rows: `{each: variant}`, or lists of graphs and cameras, `[energy, top]`. A variant that "
        "`may_fail` stops in its panel under the message; graphs in a layout stand nowhere else.",
        (),
    )

    def problems(self) -> Iterator[Problem]:
        """Rows of a layout without a panel."""
        for k, row in enumerate(self.layout):
            if row == ():
                yield Problem("this row has no panel", ("layout", k))

    def shown(self) -> tuple[Ref, ...] | None:
        """The parts that it draws; None: all that is not hidden."""
        return self.show or None

    @property
    def laid_out(self) -> tuple[Ref, ...]:
        """The graphs and cameras that stand in its layout."""
        return tuple(ref for row in self.layout if not isinstance(row, EachVariant) for ref in row)

    @property
    def parts(self) -> int:
        """Instants of the simulation in a frame."""
        return 1

    def seen_from(self, time: float) -> Ref | None:
        """The camera at an instant [s] of the simulation, where it is not the output's own; else None."""
        return None

    @property
    def pixels(self) -> tuple[int, int]:
        """Width and height of the picture [pixels]."""
        named = {"360p": (640, 360), "480p": (854, 480), "720p": (1280, 720), "1080p": (1920, 1080), "4k": (3840, 2160)}
        return named[self.size] if isinstance(self.size, str) else self.size
