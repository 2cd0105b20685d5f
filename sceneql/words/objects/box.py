"""box: a rectangular block."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, ClassVar

from sceneql.failure import RunFailure
from sceneql.kinds import Collider, FieldBuilder, Moment, Position, Shaped, Value, VolumeMoments, field
from sceneql.quantities.dimension import LENGTH
from sceneql.quantities.expression import Call, Number, Type
from sceneql.shapes.placement import compose
from sceneql.shapes.solid import Solid, block, quadric, triple

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape
    from sceneql.system import Assembly


class Box(Solid):
    """The block |x| <= size.x / 2, |y| <= size.y / 2, |z| <= size.z / 2 about its position.

    Its field is the signed distance in the maximum norm, max(|x| - size.x / 2, ...): exact inside and in front of the
    sides, less than the distance in front of edges and corners.

    For example `crate: {box: {size: 1 0.5 0.5 m, position: 0 0.25 0 m}}`.
    """

    collides: ClassVar[bool] = True

    size: Position = field("Its sides along its own x, y and z.", "1 1 1 m", above=0)

    @property
    def traced(self) -> str:
        """It is met exactly."""
        return ""

    def own_box(self) -> str:
        """Its size and corner where they are constant; in general, where they are not."""
        size, middle = (value.number() if value.constant else None for value in (self.size, self.position))
        if size is None or middle is None:
            return "`size` and `corner`"
        corner = (at - 0.5 * side for at, side in zip(middle, size, strict=True))
        return f"`size: {' '.join(f'{one:g}' for one in size)} m`, `corner: {' '.join(f'{one:g}' for one in corner)} m`"

    def _half(self, moment: Moment) -> tuple[float, float, float]:
        half = triple(0.5 * moment.at(self.size))
        if not min(half) > 0:
            raise RunFailure("must be above 0 now", part="size", time=moment.time, span=self.size.span)
        return half

    def inside(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Signed distance in the maximum norm."""
        low, high = self.reach(moment)
        return block(build, (x, y, z), low, high)

    def reach(self, moment: Moment) -> tuple[Any, Any]:
        """The box itself."""
        a, b, c = self._half(moment)
        return (-a, -b, -c), (a, b, c)

    def volume_moments(self, moment: Moment, measure: Callable[[Shaped], VolumeMoments]) -> VolumeMoments:
        """a b c; the mean of x^2 is a^2/12."""
        a, b, c = self._half(moment)
        return VolumeMoments.centered(8 * a * b * c, (a * a / 3, b * b / 3, c * c / 3)).mapped(self.local(moment))

    def convex(self, moment: Moment, center: Floats) -> Any:
        """A block."""
        from itertools import product

        import numpy as np

        from sceneql.contacts.distance.convex import box, hull

        half = self._half(moment)
        return hull(np.array(list(product((-1, 1), repeat=3))) * half - center) if center.any() else box(half)

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """A quadric without terms: its bounds alone."""
        surface = moment.surface(name, self.material, self.color)
        yield quadric(name, surface, compose(place, self.local(moment)), constant=-1.0, half=self._half(moment))

    def collider(self, assembly: Assembly) -> Collider:
        """Center, rotation and half sides."""
        half = Call("mul", (Number(0.5), self.size.expr), Type((3,), LENGTH))
        least = Call("min", (half,), Type((), LENGTH))
        return Collider(
            "sceneql.contacts.shapes.box_kernels",
            assembly.value(self.position),
            assembly.value(self.rotation),
            assembly.value(Value(half, self.size.span)),
            assembly.value(Value(least, self.size.span)),
        )
