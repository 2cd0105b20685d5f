"""outline: a flat domain inside a polygon."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from math import isfinite
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from sceneql.grids.domain.sides import Corners, crossing
from sceneql.kinds import File, FixedLength, FixedScalar, Length, Moment, Object, Problem, Quantity, Record, field
from sceneql.quantities import dimension as dim

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape

Corner = Annotated[tuple[float, float], Quantity(dim.LENGTH, (2,))]


class Piece(Record):
    """A piece of an outline that has a name of its own."""

    first: int = field("Number of the corner where it begins, the first being 0.", at_least=0)
    last: int = field("Number of the corner where it ends.", at_least=0)


class Outline(Object):
    """What lies inside a polygon in the plane z = 0, less what lies inside its islands: a shore, a plate.

    Its corners stand in order, either way round; a side joins the last with the first. Or a file has it: the closed
    paths of an SVG, of which the largest is the outline and those within are islands by their ids, or a picture, in
    which it goes round what is brighter than `threshold`. As the domain of a diffusion its boundary has the pieces that
    are named here, the islands, and `shore` for all the rest. It is drawn as a line.
    """

    said_by: ClassVar = dict.fromkeys(
        ("corners", "corner_points", "vertices", "outer", "path", "polygon", "coordinates"),
        "its corners are `points`, `[0 0 m, 1 0 m, 1 1 m]`",
    )

    points: tuple[Corner, ...] | None = field("Its corners, x and y.", None)
    file: File | None = field("In their place an SVG file (.svg) or a picture.", None)
    width: FixedLength | None = field("How wide the outline of the file is.", None, above=0)
    corner: Corner = field("Low corner of the box around the outline of the file.", "0 0 m")
    threshold: FixedScalar = field("Brightness at its edge in a picture, from 0 (black) to 1.", "0.5", above=0, below=1)
    inside: Literal["bright", "dark"] = field("Which side of that edge is inside.", "bright")
    islands: dict[str, tuple[Corner, ...]] = field("Polygons that are cut out of it.", {})
    pieces: dict[str, Piece] = field("Names of runs of sides: `{inlet: {first: 3, last: 5}}`.", {})
    thickness: Length = field("Of the line.", "1 cm", above=0)

    def problems(self) -> Iterator[Problem]:
        """Not one source, polygons that cross, pieces that are none."""
        if (self.points is None) == (self.file is None):
            yield Problem("an outline has either `points` or a `file`")
            return
        if self.file is not None and self.width is None:
            yield Problem("the outline of a file needs a `width`", ("file",))
            return
        at = ("points" if self.file is None else "file",)
        try:
            own = self._own()
        except ValueError as error:
            yield Problem(str(error), at)
            return
        if twice := self._named_twice(own):
            yield Problem(twice, ("islands",), at_key=True)
            return
        rings: dict[str, Any] = {**own, **self.islands}
        few = [(name, ring) for name, ring in rings.items() if len(ring) < 3]
        for name, ring in few:
            where = ("islands", name) if name in self.islands else at
            yield Problem(f"the {_told(name)} has {len(ring)} corners: a polygon has three or more", where)
        found = None if few else crossing(rings)
        if found is not None:
            (a, i), (b, k) = found
            other = "itself" if a == b else f"the {_told(b)}"
            text = f"the {_told(a)} crosses {other}: the side from corner {i} meets that from corner {k}"
            if self.file is not None:
                x, y = rings[a][i]
                text += f", near ({x:g}, {y:g}) m"
            yield Problem(text, ("islands", a) if a in self.islands else at)
        last = len(self.points or ()) - 1
        for name, piece in self.pieces.items():
            if self.points is None:
                yield Problem("pieces are runs of `points`; on the outline of a file say `where`", ("pieces", name))
            elif max(piece.first, piece.last) > last or piece.first == piece.last:
                text = f"the piece {name} runs from one corner to another, of 0 to {last}"
                yield Problem(text, ("pieces", name))

    def _own(self) -> dict[str, Corners]:
        """Polygons without the script's islands, as far as known without numpy. Raises ValueError for a bad file."""
        found: dict[str, Corners] = {}
        if self.points is not None:
            found["shore"] = self.points
        elif self.file is not None and self._is_svg:
            from sceneql.grids.domain import svg

            for number, (name, ring) in enumerate(svg.rings(self.file).items()):
                found["shore" if number == 0 else f"{name}_" if name == "shore" else name] = ring
            found = self._scaled(found)
        return found

    def _named_twice(self, own: Mapping[str, Any]) -> str | None:
        """Message for an island with the name of another polygon; None if there is none."""
        for name in self.islands:
            if name == "shore" or name in own:
                what = "which is the outline itself" if name == "shore" else "which the file has, too"
                return f"an island is named {name}, {what}: give it another name"
        return None

    @property
    def _is_svg(self) -> bool:
        return self.file is not None and self.file.lower().endswith(".svg")

    def _scaled(self, rings: Mapping[str, Any]) -> dict[str, Any]:
        """Polygons of a file, scaled and moved to the script's width and corner."""
        shore = rings["shore"]
        low_x, high_x = min(x for x, _ in shore), max(x for x, _ in shore)
        low_y = min(y for _, y in shore)
        if not high_x > low_x:
            raise ValueError("its largest path has no width")
        scale, (x0, y0) = (self.width or 1.0) / (high_x - low_x), self.corner
        scaled = {
            name: tuple((x0 + scale * (x - low_x), y0 + scale * (y - low_y)) for x, y in ring)
            for name, ring in rings.items()
        }
        if not all(isfinite(x) and isfinite(y) for ring in scaled.values() for x, y in ring):
            raise ValueError("its largest path is too narrow to be as wide as `width` says")
        return scaled

    def rings(self) -> Mapping[str, Floats]:
        """The polygons by name, each (corners, 2) [m]; the outline itself is `shore`. Raises ValueError."""
        import numpy as np

        if self.file is not None and not self._is_svg:
            from sceneql.grids.domain.picture_mask import contours

            own = self._scaled(contours(self.file, self.threshold, self.inside == "bright"))
        else:
            own = self._own()
        if twice := self._named_twice(own):
            raise ValueError(twice)
        found = {**own, **self.islands}
        return {name: np.array(ring, dtype=float) for name, ring in found.items()}

    def domain(self) -> Any:
        """Its inside as the domain of a field (grids.polygon.Polygon)."""
        from sceneql.grids.domain.polygon import Polygon

        return Polygon(self.rings(), {name: (piece.first, piece.last) for name, piece in self.pieces.items()})

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """The box around its corners, mapped by ``place``."""
        import numpy as np

        shore = self.rings()["shore"]
        corners = np.column_stack([shore, np.zeros(len(shore)), np.ones(len(shore))]) @ place.T
        return corners.min(axis=0), corners.max(axis=0)

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """Its sides as segments."""
        import numpy as np

        from sceneql.frame import Segments
        from sceneql.shapes.checked_values import positive

        surface = moment.surface(name, self.material, self.color)
        sides = [np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in self.rings().values()]
        flat = np.concatenate(sides)
        ends = np.concatenate([flat, np.zeros((*flat.shape[:2], 1))], axis=2) @ place[:, :3].T + place[:, 3]
        yield Segments(name, surface, ends, np.full(len(ends), 0.5 * positive(moment, self.thickness, "thickness")))


def _told(name: str) -> str:
    return "outline" if name == "shore" else name
