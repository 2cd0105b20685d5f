"""sphere: all points within a radius."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import pi
from typing import TYPE_CHECKING, Any, ClassVar

from sceneql.kinds import Collider, FieldBuilder, Length, Moment, Shaped, VolumeMoments, field
from sceneql.shapes.checked_values import positive
from sceneql.shapes.placement import compose
from sceneql.shapes.solid import Solid, length, less, quadric

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape
    from sceneql.system import Assembly


class Sphere(Solid):
    """The ball |p| <= radius about its position. Its field is the signed distance |p| - radius.

    For example `egg: {sphere: {radius: 0.2 m, position: 0 1 0 m, color: tomato}}`.
    """

    collides: ClassVar[bool] = True

    radius: Length = field("Its radius.", "0.5 m", above=0)

    @property
    def traced(self) -> str:
        """It is met exactly."""
        return ""

    def inside(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Signed distance."""
        return less(build, length(build, x, y, z), positive(moment, self.radius, "radius"))

    def smooth(self, moment: Moment) -> bool:
        """It is."""
        return True

    def reach(self, moment: Moment) -> tuple[Any, Any]:
        """The cube around it."""
        r = positive(moment, self.radius, "radius")
        return (-r, -r, -r), (r, r, r)

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """The box around the ellipsoid that it is in the world."""
        import numpy as np

        whole = compose(place, self.local(moment))
        half = positive(moment, self.radius, "radius") * np.linalg.norm(whole[:, :3], axis=1)
        return whole[:, 3] - half, whole[:, 3] + half

    def volume_moments(self, moment: Moment, measure: Callable[[Shaped], VolumeMoments]) -> VolumeMoments:
        """4/3 pi r^3; the mean of x^2 is r^2/5."""
        r = positive(moment, self.radius, "radius")
        return VolumeMoments.centered(4 / 3 * pi * r**3, [r * r / 5] * 3).mapped(self.local(moment))

    def convex(self, moment: Moment, center: Floats) -> Any:
        """A ball."""
        from sceneql.contacts.distance.convex import ball

        return ball(positive(moment, self.radius, "radius"), -center)

    def curved(self, moment: Moment) -> Any:
        """An ellipsoid of equal axes, which a group may stretch."""
        from sceneql.contacts.rigid_exact.curved import ellipsoid

        return ellipsoid(3 * (positive(moment, self.radius, "radius"),))

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """A quadric; under an uneven scale an ellipsoid."""
        r = positive(moment, self.radius, "radius")
        surface = moment.surface(name, self.material, self.color)
        whole = compose(place, self.local(moment))
        yield quadric(name, surface, whole, squares=(1.0, 1.0, 1.0), constant=-r * r, half=(r, r, r))

    def collider(self, assembly: Assembly) -> Collider:
        """Center, rotation and radius."""
        radius = assembly.value(self.radius)
        return Collider(
            "sceneql.contacts.shapes.sphere_kernels",
            assembly.value(self.position),
            assembly.value(self.rotation),
            radius,
            radius,
        )
