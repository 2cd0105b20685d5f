"""group: objects that move together."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from sceneql.kinds import FieldBuilder, Moment, ObjectRef, Ref, Shaped, VolumeMoments, field
from sceneql.shapes.apart import apart
from sceneql.shapes.placement import Placed, Scale, affine, compose, inverse

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape, Surface


class Group(Placed):
    """Objects in coordinates of their own, scaled, turned and moved together.

    A point p of a child stands at position + rotation (scale p). A child that is written in place under a name is a
    part of that name, for others to link to; its position is told in the group's coordinates. Children keep their
    materials; one without gets the group's. Its field is the least of its children's, times the least factor of its
    scale.
    """

    children: tuple[ObjectRef, ...] | dict[str, ObjectRef] = field("The objects, by name or in place.", ())
    scale: Scale = field("Factor by which it is larger, or three along its own axes.", "1", above=0)

    def local(self, moment: Moment) -> Floats:
        """(3, 4) map from its own coordinates to its parent's."""
        return affine(moment.at(self.position), moment.at(self.rotation), moment.at(self.scale))

    def members(self) -> tuple[Ref, ...]:
        """Its objects."""
        return tuple(self.children.values()) if isinstance(self.children, dict) else self.children

    def _objects(self, moment: Moment) -> Iterable[tuple[str, Shaped]]:
        for ref in self.members():
            child = moment.object(ref)
            if child.material is None and child.color is None:
                child = child.model_copy(update={"material": self.material, "color": self.color})
            yield ref.name, child

    def volume_moments(self, moment: Moment, measure: Callable[[Shaped], VolumeMoments]) -> VolumeMoments | None:
        """Those of its children together, where their boxes do not overlap; else None."""
        found = apart([child for _, child in self._objects(moment)], moment, measure)
        return None if found is None else found.mapped(self.local(moment))

    def smooth(self, moment: Moment) -> bool:
        """Whether its only child is, scaled or not."""
        children = [child for _, child in self._objects(moment)]
        return len(children) == 1 and isinstance(children[0], Placed) and children[0].smooth(moment)

    def curved(self, moment: Moment) -> Any:
        """That of its only child, scaled. Raises TypeError for several, ValueError where it is none any more."""
        if len(self.members()) != 1:
            raise TypeError("several objects together have no smooth shape")
        (ref,) = self.members()
        child: Any = moment.object(ref)
        if not isinstance(child, Placed):
            raise TypeError("it has no place of its own")
        own = affine((0, 0, 0), (1, 0, 0, 0), moment.at(self.scale))
        return child.curved(moment).mapped(compose(own, child.local(moment)))

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """The shapes of its children."""
        whole = compose(place, self.local(moment))
        for child_name, child in self._objects(moment):
            if not child.hidden:
                yield from child.lower(child_name, whole, moment)

    def implicit(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """The union of its children. Raises TypeError where a child has no inside, ValueError where there is none."""
        import numpy as np

        own = build.affine(inverse(self.local(moment)), x, y, z)
        values = [child.implicit(build, *own, moment) for _, child in self._objects(moment)]
        if not values:
            raise ValueError("a group of nothing has no inside")
        total = values[0]
        for value in values[1:]:
            total = build.op("min", total, value)
        least = float(np.min(moment.at(self.scale)))
        return total if least == 1 else build.op("mul", total, build.constant(least))

    def hues(
        self, build: FieldBuilder, x: int, y: int, z: int, surface: Surface, moment: Moment
    ) -> tuple[int, int, int] | None:
        """The color of the child that is there."""
        from sceneql.shapes.hues import joined

        own = build.affine(inverse(self.local(moment)), x, y, z)
        children = list(self._objects(moment))
        fields = [child.implicit(build, *own, moment) for _, child in children]
        return joined(build, children, fields, own, surface, "apart", 0.0, moment)

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """The box around those of its children; inverted (inf, -inf) where there is none."""
        import numpy as np

        whole = compose(place, self.local(moment))
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        for _, child in self._objects(moment):
            child_low, child_high = child.extent(whole, moment)
            low, high = np.minimum(low, child_low), np.maximum(high, child_high)
        return low, high
