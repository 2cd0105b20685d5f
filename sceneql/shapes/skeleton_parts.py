"""Parts of a skeleton as a script writes them, and their geometry at an instant."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

from pydantic import BaseModel

from sceneql.failure import RunFailure
from sceneql.kinds import Color, Moment, Points, Position, Problem, Quantity, Record, Value, field
from sceneql.quantities import dimension as dim
from sceneql.shapes.solid import LARGEST

if TYPE_CHECKING:
    from sceneql.frame import Floats

LengthOrLengths = Annotated[Value, Quantity(dim.LENGTH, None)]
NumberOrNumbers = Annotated[Value, Quantity(dim.PLAIN, None)]
Pairs = Annotated[Value, Quantity(dim.LENGTH, (None, 2, 3))]
Numbers = Annotated[Value, Quantity(dim.PLAIN, (None, 3))]

MOST = 200_000
"""Most parts of a skeleton: with more a frame takes minutes and gigabytes."""
COARSEST = 1e-5
"""Spacing of float64 numbers relative to a curve's size, above which the certified root search along a ray does not
end: it would bisect the ray forever, since rounding prevents a proof on any piece."""


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """Parts of a skeleton at an instant: corners (p, 3, 3) [m], radii (p, 2) [m], weights (p,) and groups (p,) from 0.

    Parts of one group are pieces of one line or surface. Quadratic curves have their control points as third corners,
    and ``middles`` (p,) [m], the radii at these.
    """

    corners: Floats
    radii: Floats
    weights: Floats
    groups: Floats
    middles: Floats | None = None


class Part(Record):
    """A point, points, segments, a line through points, a polygon or triangles: one density each, 1 all along it.

    Where parts of *different* entries come together their densities add up; a line or a polygon does not bulge where
    its own pieces meet.
    """

    said_by: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(
            ("sphere", "ball", "metaball", "blob"),
            "a ball is a point: write `{point: <position|0 1 0 m>, radius: <radius|0.5 m>}`",
        ),
        **dict.fromkeys(
            ("cylinder", "capsule", "line", "segment", "rod"),
            "a rod is a line: write `{polyline: [<from|0 0 0 m>, <to|0 1 0 m>], radius: <radius|0.3 m>}`",
        ),
    }

    KINDS: ClassVar[tuple[str, ...]] = ("point", "points", "segments", "polyline", "spline", "polygon")

    point: Position | None = field("One point.", None)
    points: Points | None = field("Points, each a part of its own; with `triangles` their corners.", None)
    segments: Pairs | None = field("Pairs of points, each a part of its own: `cage.springs`.", None)
    polyline: Points | None = field("A line through points.", None)
    spline: Points | None = field("A smooth line through points, with the slopes of chords.", None)
    polygon: Points | None = field("A flat face with these corners, which may be concave.", None)
    triangles: Numbers | None = field("Faces of `points`, by their numbers from 0: `sheet.triangles`.", None)
    closed: bool = field("The line runs on from its last point to its first.", False)
    radius: LengthOrLengths = field(
        "How far the density reaches: one for all, or one for each point; along a line it changes evenly.",
        "0.3 m",
        above=0,
    )
    weight: NumberOrNumbers = field("Factor of the density, or one for each point or segment.", "1")
    color: Color | None = field("Its color, mixed with the others' by their densities; by default the object's.", None)

    def problems(self) -> Iterator[Problem]:
        """Problems: more or less than one kind, triangles without points, a closed part that is no line."""
        given = [name for name in self.KINDS if getattr(self, name) is not None]
        if len(given) != 1:
            said = f", not {' and '.join(given)}" if given else ""
            text = f"a part of a skeleton is one of {', '.join(self.KINDS)}{said}"
            yield Problem(text, tuple(given[1:2]), at_key=True)
            return
        if self.triangles is not None and self.points is None:
            yield Problem("`triangles` are told by numbers of `points`", ("triangles",))
        if self.closed and self.polyline is None and self.spline is None:
            yield Problem("only a polyline or a spline can be closed", ("closed",), at_key=True)

    @property
    def lone(self) -> bool:
        """Whether the entry is points or segments, each of which is a part of its own."""
        return not (self.polyline or self.spline or self.polygon or self.triangles)

    def place(self) -> Value | None:
        """The value of its points, of whichever kind; None unless exactly one is given."""
        given = [value for name in self.KINDS if (value := getattr(self, name)) is not None]
        return given[0] if len(given) == 1 else None

    def now(self, moment: Moment) -> Shape:
        """Parts of the skeleton at a moment; empty for a line or polygon whose varying number of points is too small.

        Raises RunFailure for radii or weights of another number than the points, and where a fixed number of points is
        too small.
        """
        import numpy as np

        for name in self.KINDS:
            value: Value | None = getattr(self, name)
            if value is None:
                continue
            places = numbers(value, moment)
            if places.size > 6 * MOST:
                raise failure(f"a skeleton has at most {MOST:,} parts, not {len(places):,}", value, moment)
            if name == "point":
                return self._points(places[None], moment)
            if name == "segments":
                return self._segments(places.reshape(-1, 2, 3), moment)
            places = places.reshape(-1, 3)
            if name == "points":
                return self._points(places, moment) if self.triangles is None else self._faces(places, moment)
            if len(places) < (3 if name == "polygon" else 2):
                if value.expr.type.shape[0] is None:
                    return Shape(np.empty((0, 3, 3)), np.empty((0, 2)), np.empty(0), np.empty(0))
                raise failure(f"a {name} has {len(places)} points, which are too few", value, moment)
            if name == "polygon":
                return self._polygon(places, value, moment)
            return self._line(places, value, moment)
        raise AssertionError("a part is one of its kinds")

    def _points(self, places: Floats, moment: Moment) -> Shape:
        import numpy as np

        n = len(places)
        radii, weights = each(self.radius, n, "points", moment), each(self.weight, n, "points", moment)
        return Shape(
            np.repeat(places[:, None], 3, axis=1), np.stack([radii, radii], axis=1), weights, np.arange(n, dtype=float)
        )

    def _segments(self, ends: Floats, moment: Moment) -> Shape:
        import numpy as np

        n = len(ends)
        radii, weights = each(self.radius, n, "segments", moment), each(self.weight, n, "segments", moment)
        return Shape(ends[:, [0, 1, 0]], np.stack([radii, radii], axis=1), weights, np.arange(n, dtype=float))

    def _line(self, places: Floats, value: Value, moment: Moment) -> Shape:
        import numpy as np

        from sceneql.shapes.spline import smooth

        radii = each(self.radius, len(places), "points", moment)
        if self.closed:
            places, radii = np.concatenate([places, places[:1]]), np.concatenate([radii, radii[:1]])
        if self.spline is None:
            corners = np.stack([places[:-1], places[1:], places[:-1]], axis=1)
            return Shape(corners, np.stack([radii[:-1], radii[1:]], axis=1), *self._as_one(len(corners), moment))
        if (places[1:] == places[:-1]).all(axis=1).any():
            raise failure("two points of a spline that follow each other are the same", value, moment)
        corners, radii = smooth(places, radii, self.closed)
        return Shape(corners, radii[:, :2], *self._as_one(len(corners), moment), radii[:, 2])

    def _polygon(self, places: Floats, value: Value, moment: Moment) -> Shape:
        from sceneql.shapes.ears import ears

        return self._triangles(places[ears(places)], moment)

    def _faces(self, places: Floats, moment: Moment) -> Shape:
        import numpy as np

        assert self.triangles is not None
        given = numbers(self.triangles, moment).reshape(-1, 3)
        corners = given.astype(np.int64)
        if (corners != given).any():
            raise failure("the number of a point is a whole one", self.triangles, moment)
        if corners.size and not 0 <= corners.min() <= corners.max() < len(places):
            raise failure(f"the {len(places)} points are 0 to {len(places) - 1}", self.triangles, moment)
        return self._triangles(places[corners], moment)

    def _triangles(self, corners: Floats, moment: Moment) -> Shape:
        import numpy as np

        radii = each(self.radius, len(corners), "faces", moment) if len(corners) else np.ones(0)
        return Shape(corners, np.stack([radii, radii], axis=1), *self._as_one(len(corners), moment))

    def _as_one(self, n: int, moment: Moment) -> tuple[Floats, Floats]:
        """Weights (n,) and groups (n,) of n pieces of one part. Raises RunFailure for a list of weights."""
        import numpy as np

        weight = numbers(self.weight, moment)
        if weight.ndim:
            raise failure("a line or a polygon has one weight", self.weight, moment)
        return np.full(n, float(weight)), np.zeros(n)


def refuse_rounded(shape: Shape, place: Value, radius: Value, moment: Moment) -> None:
    """Raise RunFailure for a curve or face that float64 does not resolve: too far away, or too wide for its length.

    Single points are not checked: their density is a ball wherever rounding puts them.
    """
    import numpy as np

    if (shape.corners[:, 1:] == shape.corners[:, :1]).all():
        return
    longs = np.ptp(shape.corners, axis=1).max(axis=1)
    away, wide, least = np.abs(shape.corners).max(axis=(1, 2)), shape.radii.max(axis=1), shape.radii.min(axis=1)
    if len(longs) and not shape.groups.any():  # pieces of one curve
        longs, least = np.where(longs > 0.0, longs.max(), 0.0), np.full(len(longs), least.min())
    far = np.spacing(away) > COARSEST * wide
    swollen = np.spacing(wide) > COARSEST * np.maximum(longs, least)
    bad = np.flatnonzero((longs > 0.0) & (far | swollen))
    if not len(bad):
        return
    k = bad[0]
    if far[k]:
        size, value = away[k], place
        told = f"a part of {wide[k]:.3g} m radius reaches {size:.3g} m away from the origin"
    else:
        size, value = wide[k], radius
        told = f"a part {longs[k]:.3g} m long has a radius of {size:.3g} m"
    raise failure(f"{told}, where float64 numbers are {np.spacing(size):.2g} m apart: too coarse", value, moment)


def fixed_values(own: Collection[str], *records: BaseModel) -> tuple[list[Floats], Hashable] | None:
    """Arguments of ``OfHeld.get`` for a result that depends on the fields of some records: (arrays, key).

    Of the first record only the fields ``own`` count. None where a field may change with time, or where no field is a
    list: the result is then cheap.
    """
    lists: list[Floats] = []
    rest: list[Hashable] = []
    for record in records:
        for name in own if record is records[0] else type(record).model_fields:
            value = getattr(record, name)
            if isinstance(value, Value):
                if not value.constant:
                    return None
                array = value.fixed_list()
                if array is not None:
                    lists.append(array)
                value = name if array is not None else value.number()
            rest.append((name, value))
    return (lists, tuple(rest)) if lists else None


def each(value: Value, n: int, what: str, moment: Moment) -> Floats:
    """The value as (n,) numbers, a single number repeated. Raises RunFailure for a list of another length."""
    import numpy as np

    given = numbers(value, moment)
    if given.ndim == 0:
        return np.full(n, float(given))
    if given.shape != (n,):
        raise failure(f"there are {n} {what}, but {len(given)} values here", value, moment)
    return given


def numbers(value: Value, moment: Moment) -> Floats:
    """The value at a moment as an array. Raises RunFailure for a number above LARGEST, whose products overflow."""
    import numpy as np

    given = np.asarray(moment.at(value), dtype=float)
    most = float(np.abs(given).max(initial=0.0))
    if most > LARGEST:
        raise failure(f"a number is {most:.3g} here, more than {LARGEST:g}", value, moment)
    return given


def failure(message: str, value: Value, moment: Moment) -> RunFailure:
    """A RunFailure located at the value's line of the script."""
    return RunFailure(message, part="blobby", time=moment.time, span=value.span)
