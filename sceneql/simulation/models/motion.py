"""motion: a place and a rotation as functions of time."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from typing import ClassVar

from sceneql.kinds import FixedPosition, Gives, Model, Position, Problem, Rotation, Scalar, field, quantity_type
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Expr, Key, Keys, Number, Type, Vector
from sceneql.simulation.shift import rate_of_change

POINT = Type((3,), dim.LENGTH)


class Motion(Model):
    """A kinematic motion: the script says where it is, by an expression of `time`, by keyframes, or along a path.

    A path is the cubic through its points with the slopes of chords (Catmull & Rom 1974), over the share of the
    polygon's length; one that ends where it begins is closed, and `progress` counts laps. Other parts link to the
    motion: an object's `position: lift.position`. The velocity is the central difference over 0.2 ms.
    """

    kinematic: ClassVar[bool] = True
    has_bodies: ClassVar[bool] = False
    gives: ClassVar[Mapping[str, Gives]] = {
        "position": Gives(quantity_type(dim.LENGTH, (3,)), "Where it is."),
        "rotation": Gives(Type((4,)), "How it is turned: quaternion [w, x, y, z]."),
        "velocity": Gives(quantity_type(dim.VELOCITY, (3,)), "How fast it moves."),
    }

    position: Position | None = field("Where it is; by default at the origin.", None)
    along: tuple[FixedPosition, ...] | None = field("In place of `position`: the points of a path.", None)
    progress: Scalar = field("With `along`: the share of the path gone, 0 at its first point, 1 at its last.", "0")
    rotation: Rotation = field("How it is turned.", "1 0 0 0")

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

    def _place(self) -> Expr:
        """Its position over time."""
        if self.along is None:
            return _point((0.0, 0.0, 0.0)) if self.position is None else self.position.expr
        reached = list(itertools.accumulate((math.dist(p, q) for p, q in itertools.pairwise(self.along)), initial=0.0))
        keys = tuple(Key(Number(r / reached[-1]), _point(p)) for r, p in zip(reached, self.along, strict=True))
        lap = Number(1.0) if self.along[0] == self.along[-1] else None
        return Keys(self.progress.expr, keys, "cubic", lap, POINT)

    def formula(self, output: str) -> Expr:
        """An output as an expression of time. Raises ScriptError for the velocity of one that follows another part."""
        match output:
            case "position":
                return self._place()
            case "rotation":
                return self.rotation.expr
            case "velocity":
                try:
                    return rate_of_change(self._place())
                except ValueError as error:
                    place = self.progress if self.position is None else self.position
                    message = f"the velocity of this motion cannot be found: {error}"
                    raise ScriptError([Diagnostic("no-velocity", message, place.span)]) from None
        raise KeyError(output)


def _point(place: tuple[float, float, float]) -> Expr:
    return Vector(tuple(Number(c, Type((), dim.LENGTH)) for c in place), POINT)
