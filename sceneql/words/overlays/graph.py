"""graph: curves of quantities, drawn as time goes on."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from sceneql.kinds import Color, Expected, FixedScalar, Moment, Overlay, Problem, Quantity, Value, field
from sceneql.kinds.texts import overlong
from sceneql.pictures.anchors import CORNERS, MARGIN, Box, Place, box_at
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import ScriptError
from sceneql.quantities.dimension import Dimension
from sceneql.quantities.expression import Link, Symbol, Vector
from sceneql.quantities.units import describe, parse_unit, unit_of

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from sceneql.frame import View
    from sceneql.pictures.plot import Curve

Limits = Annotated[tuple[float, float], Quantity(None, (2,))]
Shares = Annotated[tuple[float, float], Quantity(dim.PLAIN, (2,))]


ROOM = 14, 9
"""Least width and height of the panel, in heights of its letters."""
MOST_NAMED = 12
"""Largest number of curves with names."""


def _text(value: Value) -> str:
    return "..." if value.span is None else value.span.text


class Graph(Overlay):
    """Curves on a panel in the picture, which grow with the film: energies, errors, distances over time.

    Axes show the whole run from the first picture on; for this the physics runs once ahead of the film, as it does
    for a camera that fits. Operations over time (`initial`, `relative_drift`, ...) are given the whole run. Several
    curves are `{name: expression}`, or a list; a vector has a curve a component. With `each: variant` every variant of
    the script has its curves, up to where its run fails.

    For example `energy: {graph: {y: {kinetic: swing.kinetic, total: swing.energy}, title: energy}}`.
    """

    fills: ClassVar[bool] = True

    y: Expected | dict[str, Expected] = field("What is drawn: an expression, or several by name.")
    x: Expected | None = field("What it is drawn over; by default the time.", None)
    each: Literal["variant"] | None = field("Curves for each variant of the script.", None)
    log: Literal["x", "y", "xy"] | None = field("The axes that are logarithmic.", None)
    range: Limits | None = field("The ends of the upright axis; by default all is shown.", None)
    unit: str | None = field("The unit of the numbers beside the upright axis; by default that of SI.", None)
    x_unit: str | None = field("The unit of the numbers below.", None)
    title: str | None = field("What is said above; by default the expression.", None)
    colors: tuple[Color, ...] = field("Colors of the curves in their order; by default of a row of their own.", ())
    place: Place | None = field(
        "Where it stands in the picture; by default in a corner that what is shown leaves free.", None
    )
    size: Shares = field("Its width and height in parts of the picture's.", (0.36, 0.3), at_least=0.05, at_most=1)
    text: FixedScalar = field("Height of its letters in parts of the picture's.", "0.027", above=0, at_most=0.2)
    panel: FixedScalar = field("Opacity of the panel that it stands on.", "0.85", at_least=0, at_most=1)

    def problems(self) -> Iterator[Problem]:
        """Units that there are not, or of something else; curves of different quantities; a range that is none."""
        if not self._named():
            yield Problem("there is nothing to draw", ("y",))
        dimensions = [value.expr.type.dimension for value in self._named().values()]
        for (name, value), dimension in zip(self._named().items(), dimensions, strict=True):
            path = ("y", name) if isinstance(self.y, dict) else ("y",)
            if 0 in value.expr.type.shape:
                yield Problem("an empty list has no curve", path)
            elif len(value.expr.type.shape) > 1:
                yield Problem("a curve is a number at each time, or a vector; this is a list of vectors", path)
            elif dimension != dimensions[0]:
                text = f"curves of one graph are of one quantity, but here is {describe(dimensions[0])}"
                help = f"a second graph has it: write `{name or 'other'}: {{graph: {{y: {_text(value)}}}}}`"
                yield Problem(f"{text} and {describe(dimension)}", path, help=help)
        across = dim.TIME if self.x is None else self.x.expr.type.dimension
        if self.x is not None and self.x.expr.type.shape:
            yield Problem("what a curve is drawn over is one number at each time", ("x",))
        if said := overlong(self.title):
            yield Problem(said, ("title",), code="limit-refused")
        yield from _unfit("unit", self.unit, next(iter(dimensions), None))
        yield from _unfit("x_unit", self.x_unit, across)
        if self.range is not None and not self.range[0] < self.range[1]:
            yield Problem("the range ends at no larger value than it begins at", ("range",))
        elif self.range is not None and "y" in (self.log or "") and self.range[0] <= 0:
            yield Problem("a logarithmic axis begins above 0", ("range",))

    def _named(self) -> dict[str, Value]:
        return self.y if isinstance(self.y, dict) else {"": self.y}

    def courses(self) -> Iterable[Value]:
        """The curves and what they are drawn over."""
        return [*self._named().values(), *([] if self.x is None else [self.x])]

    def variants(self) -> bool:
        """Whether it asks for those of the script."""
        return self.each is not None

    def places(self) -> tuple[str, ...]:
        """Corners, and edges between them."""
        return CORNERS if self.place is None else (self.place,)

    def box(self, place: str, size: tuple[int, int], moment: Moment, scale: float) -> Box | None:
        """The box of its panel."""
        return box_at(place, self._block(size, scale), size)

    def _block(self, size: tuple[int, int], scale: float) -> tuple[int, int]:
        """Width and height [pixels] of the panel in a picture of a size (width, height), at least ROOM."""
        from sceneql.pictures.lettering import least_letters

        (width, height), most = size, 2 * round(MARGIN * size[1])
        em = max(least_letters(round(scale * height)), round(self.text * height))
        wide, high = (
            max(round(part * side), room * em) for part, side, room in zip(self.size, size, ROOM, strict=True)
        )
        return min(wide, width - most), min(high, height - most)

    def draw(
        self,
        pixels: NDArray[uint8],
        view: View,
        moment: Moment,
        develop: Callable[[Any], NDArray[uint8]],
        scale: float = 1.0,
    ) -> None:
        """Draw the panel at its place."""
        height, width = pixels.shape[:2]
        left, top, right, bottom = box_at(
            self.place or CORNERS[0], self._block((width, height), scale), (width, height)
        )
        within = height / (bottom - top)
        self._draw(pixels[top:bottom, left:right], moment, self.panel, self.text * within, scale * within)

    def fill(self, pixels: NDArray[uint8], moment: Moment, scale: float) -> None:
        """Draw it over all of the pixels."""
        from sceneql.pictures.lettering import DARK, LIGHT

        pixels[:] = (DARK if self.dark else LIGHT).paper
        self._draw(pixels, moment, 1.0, self.text * scale, scale)

    def _draw(self, pixels: NDArray[uint8], moment: Moment, opacity: float, text: float, scale: float) -> None:
        from sceneql.pictures.lettering import DARK, LIGHT
        from sceneql.pictures.plot import Axis, draw_plot

        one = next(iter(self._named().values()))
        curves = list(self._curves(moment))
        named = isinstance(self.y, dict) or self.each is not None or bool(one.expr.type.shape)
        title = self.title
        if title is None:
            title = "" if isinstance(self.y, dict) or _listed(one) else _written(one)
        log = self.log or ""
        over_time = self.x is None or isinstance(self.x.expr, Symbol)
        draw_plot(
            pixels,
            curves,
            Axis(title, _unit(self.unit, one.expr.type.dimension), "y" in log, self.range),
            Axis(
                "time" if self.x is None else _written(self.x),
                _unit(self.x_unit, dim.TIME if self.x is None else self.x.expr.type.dimension),
                "x" in log,
                (0.0, moment.end) if over_time and "x" not in log else None,
            ),
            opacity,
            text,
            scale,
            DARK if self.dark else LIGHT,
            named and len(curves) <= MOST_NAMED,
        )

    def _curves(self, moment: Moment) -> Iterator[Curve]:
        import numpy as np

        from sceneql.pictures.plot import Curve
        from sceneql.shapes.color import PALETTE, eight_bits

        colors = [eight_bits(moment.at(color)) for color in self.colors] or [eight_bits(one) for one in PALETTE]
        count = 0
        for variant in moment.variants if self.each is not None else (None,):
            for name, value in self._named().items():
                times, values = moment.course(value, variant)
                across = times if self.x is None else moment.course(self.x, variant)[1]
                values = np.asarray(values).reshape(len(times), -1)
                components = _components(value, values.shape[1])
                for k, component in enumerate(components):
                    told = " ".join(part for part in (variant or "", name, component) if part)
                    yield Curve(told, times, across, values[:, k], colors[count % len(colors)], moment.time)
                    count += 1


def _unfit(name: str, text: str | None, dimension: Dimension | None) -> Iterator[Problem]:
    """Problems of a unit: an unknown one, or one of another dimension."""
    if text is not None:
        try:
            if parse_unit(text).dimension != (dimension or dim.PLAIN):
                yield Problem(f"what is drawn is {describe(dimension)}, which {text} is no unit of", (name,))
        except ScriptError as error:
            yield Problem(error.diagnostics[0].message, (name,), code=error.diagnostics[0].code)


def _components(value: Value, count: int) -> list[str]:
    """Names of the curves of a value: those of the outputs that it lists, else of the axes, or numbers."""
    if (names := _listed(value)) and len(names) == count:
        return names
    return list("xyz"[:count]) if count in (2, 3) else [str(k) if count > 1 else "" for k in range(count)]


def _listed(value: Value) -> list[str]:
    """The outputs of which a value is a list, ``[swing.kinetic, swing.potential]``, by what they differ in."""
    items = value.expr.items if isinstance(value.expr, Vector) else ()
    links = [(one.task, one.output) for one in items if isinstance(one, Link)]
    if not links or len(links) < len(items) or len({*links}) < len(links):
        return []
    if len({task for task, _ in links}) == 1:
        return [output for _, output in links]
    return [task if len({output for _, output in links}) == 1 else f"{task}.{output}" for task, output in links]


def _written(value: Value) -> str:
    """Text of an expression in the script; empty if unknown."""
    return "" if value.span is None else " ".join(value.span.text.strip("\"'").split())


def _unit(text: str | None, dimension: Dimension | None) -> str:
    """Unit of an axis; empty for plain numbers."""
    written = text if text is not None else "1" if dimension is None else unit_of(dimension)
    return "" if written == "1" else written
