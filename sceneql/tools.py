"""What the pipeline lends to outputs: paths, frames, developed pictures, encoders; and the account that it keeps."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast

from sceneql import __version__
from sceneql.compiler.catalogue import Catalogue
from sceneql.doing import doing
from sceneql.failure import Unsuitable, failing_as
from sceneql.files import NUMBERS, refuse_unwritable
from sceneql.graph import SimulationGraph
from sceneql.kinds import Camera, Clock, EachVariant, Light, Object, Overlay, Picture, Renderer

if TYPE_CHECKING:
    from sceneql.frame import Frame, LightSource, SeenFrame, View
    from sceneql.pictures.arrangement import Arrangement
    from sceneql.pictures.layout import Panel
    from sceneql.quantities.diagnostic import Diagnostic
    from sceneql.run.covered import Sights
    from sceneql.run.framed import Framed
    from sceneql.run.instant import Instant


@dataclass
class Report:
    """What a render made and what it took."""

    files: list[Path] = field(default_factory=list)
    frames: int = 0
    undecided: dict[str, dict[int, int]] = field(default_factory=dict)
    """By output and frame: pixels whose ray could be proved neither hit nor miss; only frames that have some."""
    unsearched: dict[str, int] = field(default_factory=dict)
    """By output: rays in such frames that were given up unsearched, after others at the same object were in vain."""
    compile_seconds: float = 0.0
    compilations: int = 0
    run_seconds: float = 0.0
    """Wall time, compilation left out."""
    steps: int = 0
    present: dict[str, str] = field(default_factory=dict)
    """Implicit objects that were drawn, and what none of their values was in any frame; nothing where some may be."""
    rounded: dict[str, float] = field(default_factory=dict)
    """Implicit objects in pictures with undecided pixels: in which share of their bounds rounding decides."""
    within: dict[tuple[str, str], tuple[float, float]] = field(default_factory=dict)
    """By camera and part the first and the last instant [s] at which the one stood inside the other (run.blind)."""
    covered: dict[tuple[str, str], Sights] = field(default_factory=dict)
    """By camera and part that it is aimed at, in which frames the one hardly saw the other (run.covered)."""
    warnings: tuple[Diagnostic, ...] = ()
    conserved: list[str] = field(default_factory=list)
    """For each island that tells an energy, how far it drifted; momentum where it is conserved."""


class Part(NamedTuple):
    """A panel of a picture."""

    scale: float
    """How many times as high the picture is."""
    taken: Sequence[tuple[int, int, int, int]] = ()
    """Left, top, right, bottom [pixels] of what is written on the panel besides overlays."""


WHOLE = Part(1.0)


class Tools:
    """What the pipeline lends to an output (kinds.Tools)."""

    def __init__(
        self,
        graph: SimulationGraph,
        name: str,
        report: Report,
        target: Path,
        named: bool = False,
        draft: bool = False,
    ) -> None:
        """``named``: the user gave the target, else it is a path without extension; ``draft``: draw coarsely."""
        self.graph, self.name, self.report, self.target, self.named = graph, name, report, target, named
        self.panels: dict[str, Panel] = {}
        self.draft = draft
        self._frames, self._light = 0, cast(Any, None)
        self._framed: float | None = None
        self._fit: set[Path] = set()
        self._arranged: dict[tuple[str | None, tuple[int, int]], Arrangement] = {}

    @property
    def clock(self) -> Clock:
        """Film time and simulation time."""
        return self.graph.settings.clock

    def path(self, extension: str, *, numbered: bool = False) -> Path:
        """Path of the output's file; numbers of a row of files go before the extension.

        Raises Unsuitable where the user's name ends in something else, is too long, or is that of a file read.
        """
        target = self.target
        if target.suffix != f".{extension}":
            if self.named and target.suffix:
                raise Unsuitable(f"'{self.name}' is written as .{extension}, which {target.name} does not end in")
            target = target.with_name(f"{target.name}.{extension}")
        if target not in self._fit:
            refuse_unwritable(target, self.graph.origin.files, marks=NUMBERS if numbered else "")
            self._fit.add(target)
        return target

    def pixels(self, output: Picture, moment: Any, part: int = 0, parts: int = 1) -> Any:
        """The developed picture (h, w, 3) uint8; of several parts of an exposure after the last, else None."""
        if output.layout:
            picture = self._composed(output, moment)
        else:
            picture = self._seen(output, moment, None, part, parts)
        self._frames += 1
        self.report.frames += part == parts - 1
        return picture

    def _seen(
        self,
        output: Picture,
        moment: Any,
        camera: str | None = None,
        part: int = 0,
        parts: int = 1,
        panel: Part = WHOLE,
    ) -> Any:
        """The scene from a camera, by default the output's own; None before the last part of an exposure."""
        from renderers.develop import develop
        from renderers.drafts import coarser, enlarged
        from sceneql.run import blind, covered
        from sceneql.run.never_drawn import look, look_at_rounding, solids

        renderer = self._renderer(output)
        arrangement = self._arrangement(output, moment, camera, panel)
        moment = replace(moment, room=arrangement.room, rooms=arrangement.rooms)
        eye = self._eye(output, moment.time, camera)
        frame = frame_of(self.graph, self.name, output.pixels, moment, self._frames, eye)
        self.prepare(output)()
        drawn_by = self.graph.tasks[self.name if output.renderer is None else output.renderer.name]
        with failing_as(drawn_by.name, moment.time, drawn_by.span), doing("drawing"):
            picture = renderer.draw(replace(frame, view=coarser(frame.view)) if self.draft else frame)
        asked = solids(self.graph.drawn[self.name], self.graph.tasks)
        look(frame.shapes, asked, self.graph.tasks, self.report.present)
        blind.look(frame, eye, self.report.within)
        covered.look(frame, eye, self.graph.tasks, self.report.covered)
        if picture.undecided:
            look_at_rounding(frame.shapes, self.report.rounded)
            counts = self.report.undecided.setdefault(self.name, {})
            counts[frame.index] = counts.get(frame.index, 0) + picture.undecided
            self.report.unsearched[self.name] = self.report.unsearched.get(self.name, 0) + picture.unsearched
        linear = picture.linear
        if parts > 1:
            self._light = linear / parts if part == 0 else self._light + linear / parts
            linear = self._light
        if part < parts - 1:
            return None
        pixels = develop(linear, exposure=output.exposure, data=renderer.data)
        if self.draft:
            pixels = enlarged(pixels, frame.view.size)
        if not renderer.data:
            self._draw_over(pixels, frame.view, moment, partial(develop, exposure=output.exposure), arrangement, panel)
        return pixels

    def _eye(self, output: Picture, time: float, camera: str | None) -> str:
        """The camera of an instant [s]: that of the panel, of the shot, or the output's own."""
        shot = output.seen_from(time) if camera is None else None
        return camera or (self.graph.cameras[self.name] if shot is None else shot.name)

    def _arrangement(self, output: Picture, moment: Instant, camera: str | None, panel: Part) -> Arrangement:
        """Where the overlays of a picture stand, found at its first instant and kept."""
        from sceneql.pictures.arrangement import Sight, arranged

        key = camera, output.pixels
        if key not in self._arranged:

            def look(then: Instant) -> View:
                eye = self.graph.tasks[self._eye(output, then.time, camera)]
                with failing_as(eye.name, then.now, eye.span):
                    return cast(Camera, eye.kind).view(output.pixels, then)

            without = {ref.name for ref in output.laid_out}
            over = {name: task for name, task in self.graph.tasks.items() if isinstance(task.kind, Overlay)}
            yields = cast(Camera, self.graph.tasks[self._eye(output, moment.time, camera)].kind).yields
            sight = Sight(output.pixels, panel.scale, moment, look, yields, self.graph.drawn[self.name])
            self._arranged[key] = arranged(
                sight, {name: task for name, task in over.items() if name not in without}, panel.taken
            )
        return self._arranged[key]

    def _composed(self, output: Picture, moment: Any) -> Any:
        """The panels of a layout."""
        from sceneql.pictures.layout import Panel, boxes, page

        if not self.panels and any(isinstance(row, EachVariant) for row in output.layout):
            self.panels = {name: Panel(self.graph.variant(name)) for name in self.graph.variants.names}
        pixels, seen = page(output.pixels), replace(moment, beside=tuple(self.panels.values()))
        shown = any(isinstance(self.graph.tasks[ref.name].kind, Camera) for ref in output.laid_out)
        base = (moment.run,) if shown else ()
        for item, (left, top, wide, high) in boxes(output.layout, self.graph.variants.names, output.pixels):
            block, scale = pixels[top : top + high, left : left + wide], len(pixels) / high
            if isinstance(item, str):
                block[:] = self._variant(item, (wide, high), moment.time, scale, base)
                continue
            task = self.graph.tasks[item.name]
            with failing_as(task.name, moment.time, task.span):
                if isinstance(task.kind, Overlay):
                    task.kind.fill(block, moment, scale)
                else:
                    part = output.model_copy(update={"size": (wide, high)})
                    block[:] = self._seen(part, seen, item.name, panel=Part(scale))
        return pixels

    def _variant(self, name: str, size: tuple[int, int], time: float, scale: float, base: tuple[Framed, ...]) -> Any:
        """The panel (h, w, 3) of a variant; one whose run has failed stays as it was, under the message.

        ``base``: the script's own run, where a panel shows it.
        """
        from sceneql.pictures.layout import label, label_box

        panel = self.panels[name]
        if panel.tools is None:
            panel.tools = Tools(panel.graph, self.name, self.report, self.target, draft=self.draft)
        if panel.failure is None or panel.picture is None:
            others = tuple(other for other in self.panels.values() if other is not panel)
            moment = replace(panel.at(time), beside=(*base, *others))
            kind = cast(Picture, panel.graph.tasks[self.name].kind).model_copy(update={"size": size})
            panel.picture = panel.tools._seen(kind, moment, panel=Part(scale, (label_box(size, self.panels, scale),)))
            panel.tools._frames += 1
            label(panel.picture, name, panel.told(moment), scale)
        return panel.picture

    def _draw_over(
        self, pixels: Any, view: View, moment: Any, develop: Callable[[Any], Any], arrangement: Arrangement, panel: Part
    ) -> None:
        """What is drawn on a developed picture: labels of objects, and overlays but those of the layout."""
        from sceneql.pictures.fading import strength
        from sceneql.words.overlays.labels import draw_labels

        draw_labels(pixels, view, self.graph.tasks, self.graph.drawn[self.name], moment, panel.scale)
        for name, kind in arrangement.overlays.items():
            with failing_as(name, moment.time, self.graph.tasks[name].span):
                part = strength(kind, moment)
                if part > 0:
                    under = None if part == 1 else pixels.astype("float32")
                    kind.draw(pixels, view, moment, develop, panel.scale)
                    if under is not None:
                        pixels[:] = (under + part * (pixels - under) + 0.5).astype("uint8")

    def frame(self, moment: Any, *, fields: bool = False) -> Frame:
        """The shapes that the output draws now. Raises Unsuitable for one that does not draw, and RunFailure."""
        from sceneql.run.never_drawn import look, solids

        if self.name not in self.graph.drawn:
            raise Unsuitable(f"'{self.name}' gets no shapes: its word does not say that it `draws`")
        names = self.graph.drawn[self.name]
        if moment.time != self._framed:  # else the same frame is asked for once more
            self._frames, self._framed = self._frames + (self._framed is not None), moment.time
            self.report.frames += 1
        frame = shapes_of(names, moment, self._frames, fields=fields)
        look(frame.shapes, solids(names, self.graph.tasks), self.graph.tasks, self.report.present)
        return frame

    def encoder(self, word: str, **settings: Any) -> Any:
        """A writer of the encoders' folder."""
        from importlib import import_module

        comment = f"sceneql {__version__} script {self.graph.script_hash}"
        module = import_module(f"renderers.encoders.{word}")
        path = self.path(word, numbered=settings.get("numbered", False))
        return module.Writer(path, comment=comment, **settings)

    def prepare(self, output: Picture) -> Callable[[], None]:
        """Start compiling what the output is drawn with, beside the physics; call the result to wait for it."""
        modules = self._renderer(output).kernels(self._traced(self.graph.drawn[self.name]))
        return _compile_beside(modules) if modules else lambda: None

    def _traced(self, names: Iterable[str]) -> set[str]:
        """By which fields parts, or what these draw, are drawn."""
        kinds = [kind for name in names if isinstance(kind := self.graph.tasks[name].kind, Object)]
        within = (self._traced(ref.name for ref in kind.members()) for kind in kinds if not kind.traced)
        return {kind.traced for kind in kinds if kind.traced}.union(*within)

    def _renderer(self, output: Picture) -> Renderer:
        task = None if output.renderer is None else self.graph.tasks[output.renderer.name]
        renderer = _default_renderer() if task is None else cast("Renderer", task.kind)
        if not self.draft:
            return renderer
        draft = renderer.draft()
        if draft is None:
            told = f"'{self.name}' is drawn by '{task.word if task else 'trace'}', of which there is no draft"
            raise Unsuitable(f"{told}: leave out --draft, or --set outputs.{self.name}.renderer=trace")
        return draft


@cache
def _default_renderer() -> Renderer:
    cls = Catalogue().load("renderers", "trace")
    if cls is None:
        raise LookupError("the default renderer is missing")
    return cast("Renderer", cls())


@cache
def _compile_beside(modules: tuple[str, ...]) -> Callable[[], None]:
    """Start compiling a renderer's kernels, once for all outputs that it draws."""
    from sceneql.compiled.compile_beside import compile_beside

    return compile_beside(modules)


def shapes_of(names: Iterable[str], moment: Instant, index: int = 0, *, fields: bool = False) -> Frame:
    """The Frame of some parts at a moment (kinds.Tools.frame). Raises RunFailure."""
    from sceneql.frame import Frame

    return Frame(index, moment.now, tuple(moment.lower(names, fields=fields)))


def frame_of(
    graph: SimulationGraph, output: str, size: tuple[int, int], moment: Instant, index: int, camera: str | None = None
) -> SeenFrame:
    """The frame that a renderer gets for an output at a moment; by default of the output's own camera."""
    from sceneql.frame import SeenFrame, Sky
    from sceneql.shapes.color import linear

    drawn = shapes_of(graph.drawn[output], moment, index)  # first: what cannot be drawn is no failure of the camera's
    shapes = (*drawn.shapes, *moment.supports(graph.drawn[output]))
    moment = replace(moment, shown=shapes)
    eye = graph.tasks[camera or graph.cameras[output]]
    with failing_as(eye.name, moment.time, eye.span):
        view = cast(Camera, eye.kind).view(size, moment)
    lights: list[LightSource] = []
    for task in graph.tasks.values():
        if isinstance(task.kind, Light):
            with failing_as(task.name, moment.time, task.span):
                lights += task.kind.lower(moment)
    if graph.settings.background is not None:
        with failing_as("background", moment.time, graph.settings.background.span):
            seen = linear(moment.at(graph.settings.background))
        skies = [light for light in lights if isinstance(light, Sky)] or [Sky((0, 0, 0), (0, 0, 0), (0, 0, 0))]
        lights = [light for light in lights if not isinstance(light, Sky)]
        lights += [replace(sky, visible=seen, below=None, fade=None) for sky in skies]
    return SeenFrame(
        index=drawn.index,
        time=drawn.time,
        shapes=shapes,
        lights=tuple(lights),
        view=view,
        seed=graph.settings.clock.seed,
    )
