"""Base of the words that warp an object: its box, and its field at the preimage of a point."""

from __future__ import annotations

from collections.abc import Iterable
from math import ceil, cos, floor, hypot, pi, sin
from typing import TYPE_CHECKING, Any, Literal

from sceneql.kinds import FieldBuilder, Moment, ObjectRef, Ref, field
from sceneql.shapes.hues import joined
from sceneql.shapes.placement import inverse
from sceneql.shapes.solid import Solid, traced

if TYPE_CHECKING:
    from sceneql import frame
    from sceneql.frame import Floats, Surface

AxisName = Literal["x", "y", "z"]
Registers = tuple[int, int, int]


class Warp(Solid):
    """An object whose points are moved by a map (Barr 1984).

    Its field at p is the object's at the preimage of p, divided by a Lipschitz bound of the inverse map: where the
    object's field is a distance, the result never exceeds the distance.
    """

    of: ObjectRef = field("The object, which needs an inside; several are one as a union or group.")

    def members(self) -> tuple[Ref, ...]:
        """Reference to the warped object."""
        return (self.of,)

    def joins(self) -> tuple[Ref, ...]:
        """Reference to the warped object."""
        return (self.of,)

    def back(
        self, build: FieldBuilder, point: Registers, low: Any, high: Any, moment: Moment
    ) -> tuple[Registers, int | None]:
        """Registers of the preimage of a point, and of a factor by which the field there is multiplied (None: 1).

        low, high (3,): corners of the object's box, which is not empty. Raises ValueError for a box that the warp
        cannot map.
        """
        raise NotImplementedError

    def around(self, low: Any, high: Any, moment: Moment) -> tuple[Any, Any]:
        """Low and high corner (3,) of a box around the image of a box."""
        raise NotImplementedError

    def _box(self, moment: Moment) -> tuple[Floats, Floats]:
        """Low and high corner (3,) of the object's box, in the coordinates before the warp."""
        import numpy as np

        return moment.object(self.of).extent(np.eye(3, 4), moment)

    def inside(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Register of the object's field at the preimage of the point, times the factor of ``back``."""
        low, high = self._box(moment)
        child = moment.object(self.of)
        if not (high > low).all():
            return child.implicit(build, x, y, z, moment)
        place, factor = self.back(build, (x, y, z), low, high, moment)
        value = child.implicit(build, *place, moment)
        return value if factor is None else build.op("mul", value, factor)

    def hues(self, build: FieldBuilder, x: int, y: int, z: int, surface: Surface, moment: Moment) -> Registers | None:
        """Registers of the object's color at the preimage of the point; None where the warp has a color of its own."""
        child = moment.object(self.of)
        low, high = self._box(moment)
        own = self.material, self.color
        if own not in ((None, None), (child.material, child.color)) or not (high > low).all():
            return None
        at = build.affine(inverse(self.local(moment)), x, y, z)
        place, _ = self.back(build, at, low, high, moment)
        return joined(build, [(self.of.name, child)], [build.constant(0.0)], place, surface, "shared", 0.0, moment)

    def reach(self, moment: Moment) -> tuple[Any, Any]:
        """A box around the warped box of its object."""
        return self.around(*self._box(moment), moment)

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """A world box around the warped box of its object; inverted where the object's is."""
        low, high = self._box(moment)
        return super().extent(place, moment) if (high > low).all() else (low, high)

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[frame.Shape]:
        """The warped solid as a tape; a warp without material and color has those of its object."""
        child, own = moment.object(self.of), self
        if self.material is None and self.color is None:
            own = self.model_copy(update={"material": child.material, "color": child.color})
        return traced(own, name, place, moment)

    def bounded(self, what: str, *sides: float) -> None:
        """Raise ValueError where a side of the object's box is infinite."""
        if not all(abs(side) < float("inf") for side in sides):
            raise ValueError(f"'{self.of.name}' is unbounded {what}; an intersection with a box has ends")


def axes(name: AxisName) -> tuple[int, int, int]:
    """Numbers 0..2 of an axis and of the two that follow it cyclically: a right-handed triple."""
    first = "xyz".index(name)
    return first, (first + 1) % 3, (first + 2) % 3


def arc(radius: float, start: float, stop: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """(least, largest) of radius cos(a) and of radius sin(a) over the angles a in start..stop [rad], start <= stop."""
    found = []
    for value, top in ((cos, 0.0), (sin, 0.5 * pi)):
        ends = [value(start), value(stop)]
        # Extremes lie at top + k pi: 1 where k is even, -1 where it is odd.
        first, last = ceil((start - top) / pi), floor((stop - top) / pi)
        ends += [1.0 if k % 2 == 0 else -1.0 for k in range(first, min(last, first + 1) + 1)]
        found.append((radius * min(ends), radius * max(ends)))
    return found[0], found[1]


def steepest(stretch: float, shear: float, along: float) -> float:
    """The largest singular value of [[stretch, shear], [0, along]]."""
    return 0.5 * (hypot(stretch + along, shear) + hypot(stretch - along, shear))
