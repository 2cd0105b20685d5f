"""motion: a place and a rotation as functions of time."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from functools import cache
from typing import ClassVar

from sceneql import kinds
from sceneql.bodies.time_shift import rate_of_change
from sceneql.kinds import Clock, Doubt, Gives, Model, Problem, field, quantity_type
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Call, Expr, Key, Keys, Number, Type, Vector

Place = tuple[float, float, float]
POINT, NUMBER, TURN = Type((3,), dim.LENGTH), Type(()), Type((4,))
UP, SIDE = (Vector(tuple(Number(c) for c in axis), Type((3,))) for axis in ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
PIECES = 24
"""Number of segments between two points of a curve, for its length."""


class Motion(Model):
    """A kinematic motion: the script says where it is, by an expression of `time`, by keyframes, or along a path.

    A path is the cubic through its points with the slopes of chords (Catmull & Rom 1974), over the share of the
    polygon's length, or with `even` over that of the curve itself; one that ends where it begins is closed, and
    `progress` counts laps. With `heading` its rotation turns the x axis along the path and keeps z level, before its
    own. Other parts link to the motion: an object's `position: lift.position`. The velocity is the central difference
    over 0.2 ms.

    For example `lift: {motion: {position: {keys: {0 s: 0 0 0 m, 2 s: 0 1 0 m}}}}`.
    """

    said_by: ClassVar[Mapping[str, str]] = {
        "of": "the object says where it is, by the motion: `position: lift.position`",
        **dict.fromkeys(
            ("speed", "velocity"),
            "write where it is by the time: `position: [1 m/s*time, 0 m, 0 m]`, or `progress: time/(4 s)`",
        ),
    }
    kinematic: ClassVar[bool] = True
    has_bodies: ClassVar[bool] = False
    gives: ClassVar[Mapping[str, Gives]] = {
        "position": Gives(quantity_type(dim.LENGTH, (3,)), "Where it is."),
        "rotation": Gives(Type((4,)), "How it is turned: quaternion [w, x, y, z]."),
        "velocity": Gives(quantity_type(dim.VELOCITY, (3,)), "How fast it moves."),
    }

    position: kinds.Position | None = field("Where it is; by default at the origin.", None)
    along: tuple[kinds.FixedPosition, ...] | None = field("In place of `position`: the points of a path.", None)
    progress: kinds.Scalar = field(
        "With `along`: the share of the path gone, 0 at its first point, 1 at its last.", "0"
    )
    even: bool = field("With `along`: equal shares of the path are equally long.", False)
    heading: kinds.FixedLength | None = field(
        "With `along`: it points along the path, as what rests on it this far before and behind does.", None, above=0
    )
    rotation: kinds.Rotation = field("How it is turned.", "1 0 0 0")

    def problems(self) -> Iterator[Problem]:
        """Two ways to move, or a path that leads nowhere."""
        if self.along is not None and self.position is not None:
            yield Problem("a motion has either `position` or `along`", ("along",), at_key=True)
        text = "`along` takes two points or more, each another than the one before"
        if self.along is not None and len(self.along) < 2:
            yield Problem(text, ("along",))
        for k, (point, following) in enumerate(itertools.pairwise(self.along or ()), 1):
            if point == following:
                yield Problem(text, ("along", k))
        for name, given in (("even", self.even), ("heading", self.heading is not None)):
            if given and self.along is None:
                yield Problem(f"`{name}` is of a path: give `along`", (name,), at_key=True)

    def doubts(self, clock: Clock) -> Iterator[Doubt]:
        """A path that nothing goes along."""
        if self.along is not None and self.progress.span is None:  # that of the default
            text = "it stands at the first point of its path, for want of a `progress`"
            yield Doubt("no-progress", text, None, f"write `progress: time/({clock.end:g} s)`, or by keys")

    def _place(self) -> Expr:
        """Position as an expression of time."""
        if self.along is None:
            return _point((0.0, 0.0, 0.0)) if self.position is None else self.position.expr
        return self._path(self.progress.expr)

    def _path(self, progress: Expr) -> Expr:
        """Place on the path as an expression of ``progress``, a fraction of it."""
        keys, lap, _ = path_of(self.along or (), self.even)
        return Keys(progress, keys, "cubic", lap, POINT)

    def _turn(self) -> Expr:
        """Rotation as an expression of time."""
        if self.heading is None:
            return self.rotation.expr
        half = Number(self.heading / path_of(self.along or (), self.even)[2])
        ahead, behind = (self._path(Call(op, (self.progress.expr, half), NUMBER)) for op in ("add", "sub"))
        way = Call("normalize", (Call("sub", (ahead, behind), POINT),), Type((3,)))
        x, y, z = (Call("component", (way, Number(float(k))), NUMBER) for k in range(3))
        yaw = Call("about", (UP, Call("atan2", (Call("neg", (z,), NUMBER), x), NUMBER)), TURN)
        pitch = Call("about", (SIDE, Call("asin", (y,), NUMBER)), TURN)
        return Call("turn", (Call("turn", (yaw, pitch), TURN), self.rotation.expr), TURN)

    def formula(self, output: str) -> Expr:
        """An output as an expression of time. Raises ScriptError for the velocity of one that follows another part."""
        match output:
            case "position":
                return self._place()
            case "rotation":
                return self._turn()
            case "velocity":
                try:
                    return rate_of_change(self._place())
                except ValueError as error:
                    place = self.progress if self.position is None else self.position
                    message = f"the velocity of this motion cannot be found: {error}"
                    raise ScriptError([Diagnostic("no-velocity", message, place.span)]) from None
        raise KeyError(output)


def _point(place: Place) -> Expr:
    return Vector(tuple(Number(c, Type((), dim.LENGTH)) for c in place), POINT)


@cache
def path_of(along: tuple[Place, ...], even: bool) -> tuple[tuple[Key, ...], Number | None, float]:
    """Keys of a path over the fraction of its length, its period (1) if it is closed, and its length [m].

    ``even``: whether equal fractions are equal lengths of the curve through the points, not of the polygon.
    """
    points = finer(along) if even else along
    reached = list(itertools.accumulate((math.dist(p, q) for p, q in itertools.pairwise(points)), initial=0.0))
    keys = tuple(Key(Number(r / reached[-1]), _point(p)) for r, p in zip(reached, points, strict=True))
    return keys, Number(1.0) if points[0] == points[-1] else None, reached[-1]


def finer(points: tuple[Place, ...]) -> tuple[Place, ...]:
    """Points of the cubic Hermite curve through points, PIECES for each segment, with slopes of chords."""
    closed = points[0] == points[-1]
    steps = [math.dist(p, q) for p, q in itertools.pairwise(points)]

    def slope(k: int) -> list[float]:
        before, behind = max(k - 1, 0), min(k + 1, len(steps))
        if closed and k in (0, len(steps)):
            before, behind = -2, 1
            width = steps[0] + steps[-1]
        else:
            width = sum(steps[before:behind])
        return [(q - p) / width for p, q in zip(points[before], points[behind], strict=True)]

    found = [points[0]]
    for k, h in enumerate(steps):
        ends = list(zip(points[k], points[k + 1], slope(k), slope(k + 1), strict=True))
        for s in (j / PIECES for j in range(1, PIECES)):
            x, y, z = (
                (2 * s**3 - 3 * s**2 + 1) * a
                + (3 * s**2 - 2 * s**3) * b
                + h * ((s - 1) ** 2 * s * p + (s - 1) * s**2 * q)
                for a, b, p, q in ends
            )
            found.append((x, y, z))
        found.append(points[k + 1])
    return tuple(found)
