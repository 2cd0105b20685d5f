"""ground: a floor for pictures alone."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, ClassVar

from sceneql.kinds import Length, Moment, Object, Value, field
from sceneql.quantities.dimension import LENGTH
from sceneql.quantities.expression import Number, Type
from sceneql.words.objects.plane import Plane

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape


class Ground(Object):
    """The level half-space under all that is drawn over the film: for pictures, without a part in the physics.

    It is the floor of a scene that has none, under `gravity` or without a simulation, in the default light;
    `floor: none` leaves it out. What masses fall on is a `plane`.
    """

    grounds: ClassVar[bool] = True

    height: Length | None = field("Where it lies; by default under the lowest point of the film.", None)

    def looks_ahead(self) -> str:
        """Where it lies, if no height is given."""
        return "lies under all of it" if self.height is None else ""

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """A half-space, as a plane's."""
        level = float(moment.bounds(())[0][1]) if self.height is None else float(moment.at(self.height))
        height = Value(Number(level, Type((), LENGTH)))
        return Plane(height=height, material=self.material, color=self.color).lower(name, place, moment)
