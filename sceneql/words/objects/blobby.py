"""blobby: a soft skin around a skeleton."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal, get_args

from sceneql.kinds import FieldBuilder, FixedScalar, Gives, Moment, Object, Points, Problem, Value, field
from sceneql.shapes.held_arrays import OfHeld
from sceneql.shapes.placement import balls_box
from sceneql.shapes.skeleton_parts import (
    MOST,
    LengthOrLengths,
    NumberOrNumbers,
    Part,
    Shape,
    each,
    failure,
    fixed_values,
    numbers,
    refuse_rounded,
)
from sceneql.shapes.solid import MEASURES, measure, traced

if TYPE_CHECKING:
    from sceneql import frame
    from sceneql.field.skeleton.skeleton import Skeleton
    from sceneql.frame import Floats

SKELETONS: OfHeld[Skeleton] = OfHeld()
TINY = 1e-300
"""Density of the object's own color everywhere, so that there is a color beyond the reach of all parts."""
OWN = ("points", "segments", "radius", "weight", "kernel")
"""Fields that define parts, besides `skeleton`."""
Kernel = Literal["wyvill", "soft_object", "metaball", "gaussian", "inverse_square"]


@dataclass(frozen=True, slots=True)
class _Same:
    """Things as a key that equals only the same ones; they live as long as the key, so that no other takes their id."""

    things: tuple[object, ...]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and all(map(operator.is_, self.things, other.things))

    def __hash__(self) -> int:
        return hash(tuple(map(id, self.things)))


class Blobby(Object):
    """The solid in which the summed density of skeleton parts is above a threshold c (Blinn 1982; Bloomenthal 1997).

    A part of weight w has the density w on its skeleton, and w K(d/R) at the distance d from it, which is 0 from its
    radius R on (Wyvill, McPheeters & Wyvill 1986). With r = d/R the kernels K are `wyvill` (1 - r^2)^3, `soft_object`
    1 - 22/9 r^2 + 17/9 r^4 - 4/9 r^6, `metaball` 1 - 3 r^2 up to r = 1/3, then 3/2 (1 - r)^2 (Nishimura et al. 1985),
    `gaussian` exp(-4 r^2) and `inverse_square` 1/(1 + 4 r^2), these two less their tangent in r^2 at r = 1, over their
    value at 0. With `wyvill` a lone point of weight 1 is a ball of radius R sqrt(1 - c^(1/3)); two equal ones are one
    body up to the distance 2 R sqrt(1 - (c/2)^(1/3)).

    Parts are entries of `skeleton`; or `points`, and `segments` between them: then a segment has the mean radius and
    weight of its two ends, and a point that a segment ends at is no part of its own. Entries that have colors are mixed
    by their densities. Parts may come and go with time. Its field is (c - density) L, where L turns it into a distance
    at the surface of a lone part of mean radius.
    """

    edgeless: ClassVar[bool] = True

    gives: ClassVar[Mapping[str, Gives]] = MEASURES

    skeleton: tuple[Part, ...] = field("Parts of any kind, each with its radius, weight and color.", ())
    points: Points | None = field("The points of the skeleton, or more of them; `{file: cloud.csv}`.", None)
    segments: tuple[tuple[int, int], ...] = field("Pairs of `points`, counted from 0, that are joined.", ())
    radius: LengthOrLengths = field(
        "How far the density of `points` reaches: one for all, or one for each.", "0.3 m", above=0
    )
    weight: NumberOrNumbers = field("Factor of a point's density, one or one each; below 0 it hollows out.", "1")
    threshold: FixedScalar = field("The density at the surface.", "0.3", at_least=1e-9, below=1)
    kernel: Kernel = field("How the density falls off with the distance.", "wyvill")

    @property
    def traced(self) -> str:
        """By another field where it has more than points, or another kernel than Wyvill's."""
        if self.kernel != "wyvill" or not all(part.lone for part in self.skeleton):
            return "skeleton"
        return "formula" if self.segments or any(part.segments is not None for part in self.skeleton) else "density"

    def problems(self) -> Iterator[Problem]:
        """Lists of values that do not go with the points, no points, and ends that are none."""
        if self.points is None and not self.skeleton:
            yield Problem("a blobby needs `points` or a `skeleton`")
        for name in ("radius", "weight"):
            if len(getattr(self, name).expr.type.shape) > 1:
                yield Problem(f"{name} is one value, or a list with one for each point", (name,))
        if self.points is not None and self.points.expr.type.shape[0] == 0:
            yield Problem("a skeleton has at least one point", ("points",))
        for k, pair in enumerate(self.segments):
            for end, point in enumerate(pair):
                if point < 0:
                    yield Problem("points are counted from 0", ("segments", k, end))
        if self.segments and self.points is None:
            yield Problem("`segments` are told by numbers of `points`", ("segments",))

    def excess(self, count: Callable[[Value], int | None]) -> Iterator[tuple[Value, str]]:
        """More parts than a skeleton can have; a segment takes at most two points' places."""
        places = [part.place() for part in self.skeleton] + [self.points]
        values = [place for place in places if place is not None]
        counts = [1 if len(value.expr.type.shape) == 1 else count(value) or 1 for value in values]
        total = sum(counts) - len(self.segments)
        if total > MOST:
            most = values[counts.index(max(counts))]
            yield most, f"a skeleton has at most {MOST:,} parts, not {total:,}"

    def parts(self, moment: Moment) -> Skeleton:
        """Its skeleton in its parent's coordinates: that of `points`, then those of its entries; made once if fixed,
        else once for a moment.

        Raises RunFailure for a segment to a point that is not there, lists of other lengths than the points', radii
        that are not above 0, numbers whose products overflow, and too many parts.
        """
        told = fixed_values(OWN, self, *self.skeleton)
        if told is None:
            own = (self.skeleton, *(getattr(self, name) for name in OWN))  # shared by copies in another material
            return moment.kept(f"skeleton {hash(_Same(own))}", _Same((moment, *own)), lambda: self._parts(moment))
        return SKELETONS.get(*told, lambda: self._parts(moment))

    def _parts(self, moment: Moment) -> Skeleton:
        import numpy as np

        from sceneql.field.skeleton.skeleton import Skeleton

        shapes = self._shapes(moment)
        most = [float(np.max(shape.groups, initial=-1)) + 1 for shape in shapes]
        starts = np.cumsum([0.0, *most])
        groups = [np.broadcast_to(s.groups, len(s.weights)) + start for s, start in zip(shapes, starts, strict=False)]
        corners, radii, weights = (
            np.concatenate([getattr(shape, name) for shape in shapes]) for name in ("corners", "radii", "weights")
        )
        middles = None
        if any(shape.middles is not None for shape in shapes):
            straight = [np.full(len(shape.weights), np.nan) for shape in shapes]
            middles = np.concatenate(
                [none if shape.middles is None else shape.middles for shape, none in zip(shapes, straight, strict=True)]
            )
        return Skeleton(corners, radii, weights, np.concatenate(groups), get_args(Kernel).index(self.kernel), middles)

    def _shapes(self, moment: Moment) -> list[Shape]:
        import numpy as np

        own = [] if self.points is None else [self._listed(self.points, moment)]
        shapes = own + [part.now(moment) for part in self.skeleton]
        values = [self.radius] * len(own) + [part.radius for part in self.skeleton]
        places = [self.points] * len(own) + [part.place() for part in self.skeleton]
        for shape, value, place in zip(shapes, values, places, strict=True):
            if not (np.isfinite(shape.radii).all() and (shape.radii > 0).all()):
                raise failure(f"a radius must be above 0, but one is {np.min(shape.radii):g} m now", value, moment)
            refuse_rounded(shape, place or value, value, moment)
        count = sum(len(shape.weights) for shape in shapes)
        if count > MOST:
            most = places[int(np.argmax([len(shape.weights) for shape in shapes]))]
            assert most is not None
            raise failure(f"a skeleton has at most {MOST:,} parts, not {count:,}", most, moment)
        return shapes

    def _listed(self, value: Points, moment: Moment) -> Shape:
        """Parts from `points` and `segments`."""
        import numpy as np

        points = numbers(value, moment).reshape(-1, 3)
        n = len(points)
        if not self.segments:
            radii, weights = each(self.radius, n, "points", moment), each(self.weight, n, "points", moment)
            return Shape(
                np.repeat(points[:, None], 3, axis=1),
                np.stack([radii, radii], axis=1),
                weights,
                np.arange(n, dtype=float),
            )
        pairs = np.array(self.segments, dtype=int).reshape(-1, 2)
        if pairs.size and pairs.max() >= n:
            raise failure(f"there is no point {pairs.max()}: the {n} points are 0 to {n - 1}", value, moment)
        lone = np.setdiff1d(np.arange(n), pairs)
        ends = np.concatenate([pairs, np.column_stack([lone, lone])])
        radii, weights = each(self.radius, n, "points", moment), each(self.weight, n, "points", moment)
        means = radii[ends].mean(axis=1)
        return Shape(
            points[ends[:, [0, 1, 0]]], np.stack([means, means], axis=1), weights[ends].mean(axis=1),
            np.arange(len(ends), dtype=float),
        )  # fmt: skip

    def implicit(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """(threshold - density) times a length. Raises RunFailure as ``parts`` does."""
        from sceneql.field.skeleton.profile import steepness

        skeleton = self.parts(moment)
        mean = float(skeleton.radii.mean()) if len(skeleton.weights) else 1.0
        depth = build.op("sub", build.constant(self.threshold), build.skeleton(skeleton, x, y, z))
        return build.op("mul", depth, build.constant(mean / steepness(skeleton.kernel, self.threshold)))

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """The box around its parts, as far as the density can be above the threshold; inverted if nowhere."""
        import numpy as np

        from sceneql.shapes.density import reaches

        skeleton = self.parts(moment)
        reach = reaches(skeleton, self.threshold)
        solid = reach > 0
        if not solid.any():
            return np.full(3, np.inf), np.full(3, -np.inf)
        corners = skeleton.corners[solid]
        points = (corners[:, 1:] == corners[:, :1]).all()
        return balls_box(place, corners[:, :1] if points else corners, reach[solid, None])

    def read(self, output: str, moment: Moment) -> Any:
        """One of its measures."""
        return measure(self, output, moment)

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[frame.Shape]:
        """Its density as a tape, with one of its colors where parts have theirs."""
        return traced(self, name, place, moment)

    def hues(
        self, build: FieldBuilder, x: int, y: int, z: int, surface: frame.Surface, moment: Moment
    ) -> tuple[int, int, int] | None:
        """The mean of its parts' colors, by what each adds to the density; None where it has but one."""
        import numpy as np

        from sceneql.shapes.color import linear

        if all(part.color is None for part in self.skeleton):
            return None
        shapes = self._shapes(moment)
        own = [surface.color] * (len(shapes) - len(self.skeleton))
        given = [surface.color if p.color is None else linear(moment.at(p.color)) for p in self.skeleton]
        colors = np.repeat(np.array(own + given), [len(shape.weights) for shape in shapes], axis=0)
        skeleton = self.parts(moment)
        gives = np.maximum(skeleton.weights, 0.0)
        total = build.op("add", build.skeleton(skeleton.weighted(gives), x, y, z), build.constant(TINY))
        sums = [build.skeleton(skeleton.weighted(gives * colors[:, k]), x, y, z) for k in range(3)]
        r, g, b = (
            build.op("div", build.op("add", one, build.constant(TINY * float(color))), total)
            for one, color in zip(sums, surface.color, strict=True)
        )
        return r, g, b
