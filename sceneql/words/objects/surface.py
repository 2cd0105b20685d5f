"""surface: the sheet of a cloth or the skin of a solid, drawn by an object."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from sceneql.formulas.texture import Texture
from sceneql.grids.maps.map_names import ColorMap
from sceneql.grids.maps.seen import Bounds, Field, called, unfit
from sceneql.kinds import Length, ModelRef, Moment, Object, Problem, Value, field
from sceneql.quantities.dimension import PLAIN
from sceneql.quantities.expression import Call, Type
from sceneql.shapes.checked_values import positive
from sceneql.shapes.placement import apply
from sceneql.shapes.section import Section

if TYPE_CHECKING:
    from sceneql.frame import Floats, Mesh, Shape
    from sceneql.grids.maps.key import ColorKey
    from sceneql.words.models.elastic import Elastic
    from sceneql.words.models.membrane import Membrane


class Surface(Object):
    """The sheet of a cloth as a closed slab, smooth on both sides; cells with a torn side are left open.

    Of a flat `membrane` a line of the thickness. Of a solid of tetrahedra the outer faces, smooth; those with a torn
    edge are left out. With `shows` it has the colors of a number of each mass, or of each node of an `elastic` solid,
    which a `legend` explains. An `elastic` solid may have colors that stick to its material (`paint`), and be cut open
    to be seen inside.
    """

    of: ModelRef = field("The cloth, the solid, or the membrane.")
    thickness: Length = field("Thickness of a sheet.", "5 mm", above=0)
    shows: Field | None = field("What its colors show, a number for each of its masses: `beam.von_mises`.", None)
    colors: ColorMap = field("The map of colors, from the low to the high end.", "viridis")
    range: Bounds | None = field("The values at the ends of the map; by default the extremes of the whole run.", None)

    paint: Texture | None = field("Of an `elastic` solid: colors by the place of its material.", None)
    cut: tuple[Section, ...] = field(
        "An `elastic` solid is cut open where it is drawn: what lies before all these planes is away.", ()
    )

    def problems(self) -> Iterator[Problem]:
        """Bounds of another dimension, or of nothing; colors of two kinds."""
        if self.paint is not None and self.shows is not None:
            yield Problem("it has the colors of what it `shows` or those of a `paint`", ("paint",), at_key=True)
        if self.paint is not None and self.color is not None:
            yield Problem("a `paint` has colors of its own", ("color",), at_key=True)
        if self.shows is not None:
            for problem in unfit(self.shows, {"range": self.range}):
                yield replace(problem, path=("shows",)) if problem.path == ("of",) else problem
        elif self.range is not None:
            yield Problem("a range is of the colors of what it `shows`", ("range",), at_key=True)

    @cached_property
    def _ends(self) -> tuple[Value, Value]:
        """Expressions of the least and the largest value at an instant."""
        assert self.shows is not None
        of = Type((), self.shows.expr.type.dimension)
        least, largest = (Value(Call(name, (self.shows.expr,), of), self.shows.span) for name in ("min", "max"))
        return least, largest

    def courses(self, start: Moment) -> Iterable[Value]:
        """The extremes, where they give the range."""
        if self.shows is not None and self.range is None:
            yield from self._ends

    def scale(self, moment: Moment) -> tuple[float, float]:
        """The values at the ends of the map. Raises ValueError where they are not in order."""
        if self.range is not None:
            low, high = (float(c) for c in moment.at(self.range))
            if not high > low:
                raise ValueError(f"the range ends at {high:g}, which is not above {low:g}")
            return low, high
        low, high = (float(pick(moment.course(end)[1])) for end, pick in zip(self._ends, (min, max), strict=True))
        return (low, high) if high > low else (low, low + 1.0)

    def color_key(self, moment: Moment) -> ColorKey:
        """What its colors mean, for a legend. Raises ValueError where they mean nothing."""
        from sceneql.grids.maps.key import ColorKey

        if self.shows is None:
            raise ValueError("this surface has one color; say what it `shows`")
        dimension, name = self.shows.expr.type.dimension or PLAIN, called(self.shows, moment)
        return ColorKey(self.colors, *self.scale(moment), dimension, (), name)

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """A smooth mesh. Raises ValueError for a model that has no surface, or for numbers that are none of it."""
        import numpy as np

        from sceneql.bodies.spring_look import skin
        from sceneql.grids.maps.colors import colored

        cloth: Any = moment.object(self.of)
        if getattr(cloth, "carried", False):
            yield from self._carried(cloth, name, place, moment)
            return
        if "triangles" not in cloth.gives:
            drawn, own = cloth.drawn_by(self.of.name), self.of.name
            hint = "" if drawn is None else f"; write `{drawn[0]}: {{of: {own}.{drawn[1].links[0].output}}}`"
            raise ValueError(f"'{self.of.name}' has no surface: a cloth, a solid and a membrane have one{hint}")
        if getattr(cloth, "has_skin", False):
            yield from self._elastic(cloth, name, place, moment)
            return
        if self.paint is not None or self.cut:
            what = "painted by places of its material" if self.paint else "cut open"
            raise ValueError(f"'{self.of.name}' cannot be {what}: `elastic` solids can")
        triangles = moment.read(self.of.name, "triangles").astype("int32")
        if len(triangles):
            points = apply(place, moment.read(self.of.name, "positions"))
            half = 0.5 * positive(moment, self.thickness, "thickness")
            drawn = skin(name, moment.surface(name, self.material, self.color), points, triangles, half)
            if self.shows is not None:
                values = np.resize(self._values(len(points), moment), len(drawn.vertices))
                drawn = replace(drawn, colors=colored(values, self.scale(moment), self.colors))
            yield drawn

    def _carried(self, skin: Membrane, name: str, place: Floats, moment: Moment) -> Iterator[Shape]:
        """Shapes of a skin in a flow. Raises ValueError for colors by values and for cuts."""
        if self.shows is not None or self.paint is not None or self.cut:
            raise ValueError(f"'{self.of.name}' has one color, and is not cut: it is a skin that a flow carries")
        look = moment.surface(name, self.material, self.color)
        thick = positive(moment, self.thickness, "thickness")
        yield from skin.drawn(name, look, moment.state(self.of.name), thick, place)

    def _elastic(self, solid: Elastic, name: str, place: Floats, moment: Moment) -> Iterator[Mesh]:
        """Meshes of an elastic solid's skin, and of the faces where it is cut open."""
        from sceneql.bodies.elements.skin import Inside
        from sceneql.grids.maps.colors import colored
        from sceneql.shapes.cut_open import cut_open, planes_of

        points = apply(place, moment.read(self.of.name, "positions"))
        skin, own = solid.skin, None if self.shows is None else self._values(len(points), moment)
        drawn = skin.drawn(name, moment.surface(name, self.material, self.color), points)
        if self.paint is not None:
            drawn = replace(drawn, paint=self.paint.tape(moment))
        values = None if own is None else skin.at_vertices(own)
        pieces: Iterable[tuple[Mesh, Any]] = [(drawn, values)]
        if self.cut:
            inside = Inside(solid.solid.mesh, points, own)
            pieces = cut_open(drawn, values, inside, planes_of(self.cut, place))
        for mesh, shown in pieces:
            colors = None if shown is None else colored(shown, self.scale(moment), self.colors)
            yield replace(mesh, colors=colors)

    def _values(self, count: int, moment: Moment) -> Floats:
        """Values (count,) of the masses. Raises ValueError for a wrong number of values."""
        import numpy as np

        assert self.shows is not None
        values: Floats = np.asarray(moment.at(self.shows), dtype=float)
        if values.shape != (count,):
            raise ValueError(f"'{self.of.name}' has {count} masses, but it shows {values.size} numbers")
        return values
