"""field_map: a field on a grid in colors."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import nullcontext
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from sceneql import kinds
from sceneql.failure import RunFailure
from sceneql.grids.maps.map_names import ColorMap
from sceneql.grids.maps.seen import Bounds, Field, Levels, called, seen, swings, unfit
from sceneql.kinds import Moment, Object, Problem, Quantity, Ref, Value, field
from sceneql.quantities.dimension import LENGTH, PLAIN
from sceneql.quantities.expression import Call, Type
from sceneql.shapes.color import linear
from sceneql.shapes.placement import apply, uniform_scale
from sceneql.shapes.section import Section

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape
    from sceneql.grids.maps.key import ColorKey
    from sceneql.grids.maps.seen import Seen
    from sceneql.grids.maps.sheets import Sheet

FOREVER = 1e30
HIGHEST = 1e15
"""Largest height, relative to the longest side: above it float64 does not distinguish corners, and rays never end."""
ROUNDING = 1e-9
"""Relative difference below which two values count as equal."""
THIN = 1.5e-3
"""Default radius of contour lines, relative to the grid's longest side."""


class FieldMap(Object):
    """A field in colors: a flat one on its domain, cut along its shore; a deep one on its domain's surface.

    With `cut` what lies before all these planes is taken away, and the field is seen inside. Between the centers of
    cells it is linear, on elements it is as their functions are. Under a sky of one color alone (`sky: {color: white}`)
    colors come out as the map has them.
    """

    covers: ClassVar[bool] = True

    of: Field = field("The field: `lake.concentration`.")
    colors: ColorMap | Literal["none"] | None = field(
        "The map of colors, from the low to the high end, by default viridis; coolwarm, that of what swings about 0, "
        "has a middle; with `none` it has those of its material alone, as a surface of water.",
        None,
    )
    range: Bounds | None = field(
        "The values at the ends of the map; by default the least and the largest at the start, where all is even then "
        "those of the whole run; of what swings about 0 as far on both sides.",
        None,
    )
    height: Annotated[Value, Quantity(None)] | None = field(
        "How far a unit of a flat field lifts it along z: `30 m*L/mg`.", None
    )
    cut: tuple[Section, ...] = field("A deep domain is cut open: what lies before all these planes is away.", ())
    surface: bool = field("Of a deep domain; without it the field is seen on the planes of `cut` alone, whole.", True)
    on: kinds.ObjectRef | None = field(
        "An object in a deep domain, drawn by this one, on whose surface it is seen.", None
    )
    contours: Levels | None = field("Values whose lines are drawn, one or several.", None)
    contour_color: kinds.Color = field("Color of these lines.", "0.05 0.05 0.06")
    contour_radius: kinds.FixedLength | None = field("Radius of these lines; by default a thin one.", None, above=0)

    def problems(self) -> Iterator[Problem]:
        """Fields of no part or of several; bounds, contours and heights of other dimensions."""
        yield from unfit(self.of, {"range": self.range, "contours": self.contours})
        own = self.of.expr.type.dimension
        has = None if self.height is None else self.height.expr.type.dimension
        if own is not None and has is not None and has not in (LENGTH / own, LENGTH):
            yield Problem("a height is a length for a unit of the field: `30 m*L/mg`", ("height",))
        if self.on is not None and (self.cut or not self.surface):
            yield Problem("it is the domain that is cut open, not what the field is seen `on`", ("on",), at_key=True)
        if not self.surface and not self.cut:
            yield Problem("without its surface a field is seen on the planes of `cut`, of which there are none")

    def members(self) -> tuple[Ref, ...]:
        """What it is seen on."""
        return () if self.on is None else (self.on,)

    def remembers(self) -> Iterable[tuple[Value, float, float]]:
        """The field at the start, where that gives the range."""
        if self.range is None:
            yield self.of, FOREVER, FOREVER

    def scale(self, moment: Moment) -> tuple[float, float]:
        """The values at the ends of the map. Raises ValueError where they are not in order."""
        if self.range is not None:
            low, high = (float(c) for c in moment.at(self.range))
            if not high > low:
                raise ValueError(f"the range ends at {high:g}, which is not above {low:g}")
            return low, high
        past = moment.past(self.of)
        values = past[0][1] if past else moment.at(self.of)
        low, high = float(values.min()), float(values.max())
        if _even(low, high):
            low, high = (float(pick(moment.course(end)[1])) for end, pick in zip(self._ends, (min, max), strict=True))
            low, high = (0.0 if abs(end) < ROUNDING * (high - low) else end for end in (low, high))
        if swings(self.of, moment):
            low, high = min(low, -high), max(high, -low)
        return (low, low + 1.0) if _even(low, high) else (low, high)

    @cached_property
    def _ends(self) -> tuple[Value, Value]:
        """Expressions of the least and the largest value at an instant."""
        of = Type((), self.of.expr.type.dimension)
        least, largest = (Value(Call(name, (self.of.expr,), of), self.of.span) for name in ("min", "max"))
        return least, largest

    def courses(self, start: Moment) -> Iterable[Value]:
        """The extremes of a field that is even at the start."""
        if self.range is None:
            values = start.at(self.of)
            if _even(float(values.min()), float(values.max())):
                yield from self._ends

    def color_key(self, moment: Moment) -> ColorKey:
        """What its colors mean, for a legend."""
        from sceneql.grids.maps.key import ColorKey

        dimension = self.of.expr.type.dimension or PLAIN
        return ColorKey(
            self._map(moment) or "gray", *self.scale(moment), dimension, self._levels(moment), called(self.of, moment)
        )

    def _map(self, moment: Moment) -> str | None:
        """Name of the color map; None: the material's color alone."""
        if self.colors is None:
            return "coolwarm" if swings(self.of, moment) else "viridis"
        return None if self.colors == "none" else self.colors

    def _levels(self, moment: Moment) -> tuple[float, ...]:
        import numpy as np

        return () if self.contours is None else tuple(np.ravel(moment.at(self.contours)).tolist())

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """A mesh with a color a vertex, and lines as segments. Raises ValueError for a cut through a flat field."""
        with moment.coloring() if self.height is None and self.on is None else nullcontext():
            return list(self._lowered(name, place, moment))

    def _lowered(self, name: str, place: Floats, moment: Moment) -> Iterator[Shape]:
        import numpy as np

        from sceneql.frame import Mesh, Segments, Surface
        from sceneql.grids.maps.colors import colored
        from sceneql.grids.maps.sheets import contour, raised
        from sceneql.shapes.placed_triangles import placed, still

        field = seen(self.of, moment)
        sheet = self._sheet(field, moment)
        values = field.at(sheet.vertices)
        if self.height is not None:
            heights, side = values * float(moment.at(self.height)), float(np.ptp(sheet.vertices[:, :2], axis=0).max())
            if (most := float(np.abs(heights).max())) > HIGHEST * side:
                told = f"the field is lifted by {most:.3g} m, over a side of {side:.3g} m: too high to be drawn"
                raise RunFailure(told, part="height", time=moment.time, span=self.height.span)
            sheet = raised(sheet, heights)
        made = placed(sheet, place) if self.height is not None else still(sheet, name, place, moment)
        matte = Surface(color=(1.0, 1.0, 1.0), roughness=1.0, specular=0.0)
        chosen = self._map(moment)
        own = self.color if chosen is None else None
        look = matte if self.material is None and own is None else moment.surface(name, self.material, own)
        colors = None if chosen is None else colored(values, self.scale(moment), chosen)
        yield Mesh(name, look, made.vertices, made.triangles, made.normals, colors)
        lines = [contour(sheet, values, level) for level in self._levels(moment)]
        if sum(map(len, lines)):
            radius = self.contour_radius or THIN * max(
                n * h for n, h in zip(field.layout.shape[:2], field.layout.spacing[:2], strict=True)
            )
            ends = apply(place, np.concatenate(lines))
            ink = Surface(color=linear(moment.at(self.contour_color)), roughness=1.0, specular=0.0)
            yield Segments(f"{name}.contours", ink, ends, np.full(len(ends), radius * uniform_scale(place)))

    def _sheet(self, field: Seen, moment: Moment) -> Sheet:
        """Surface on which the field is drawn, made once for all frames. Raises ValueError for unfit settings."""
        from sceneql.grids.maps.domains import sheet_of, skin

        if field.layout.shape[2] == 1 and (self.cut or self.on is not None):
            raise ValueError("a flat field has no inside to be cut open, or to hold an object")
        if field.layout.shape[2] > 1 and self.height is not None:
            raise ValueError("a deep field is not lifted: `height` is for flat ones")

        if self.on is not None:
            return skin(self.on, field.layout, moment)
        planes = tuple((one.through, one.normal) for one in self.cut)
        return sheet_of(field, moment, planes, self.surface)


def _even(low: float, high: float) -> bool:
    """Whether a field from ``low`` to ``high`` has one value, but for rounding."""
    return high - low <= ROUNDING * max(abs(low), abs(high))
