"""torus: a ring."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import pi
from typing import Any, ClassVar

from sceneql.kinds import FieldBuilder, Length, Moment, Shaped, VolumeMoments, field
from sceneql.shapes.checked_values import positive
from sceneql.shapes.solid import Solid, length, less


class Torus(Solid):
    """A tube around the circle x^2 + z^2 = radius^2 of its own plane y = 0.

    Its field is the signed distance sqrt((sqrt(x^2 + z^2) - radius)^2 + y^2) - tube.

    For example `ring: {torus: {radius: 0.5 m, tube: 0.1 m, position: 0 1 0 m}}`.
    """

    said_by: ClassVar[Mapping[str, str]] = {"R": "did you mean 'radius'?", "r": "the tube's radius is `tube`"}

    radius: Length = field("Radius of the circle in the middle of the tube.", "0.5 m", above=0)
    tube: Length = field("Radius of the tube.", "0.15 m", above=0)

    def inside(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Signed distance."""
        around = less(build, length(build, x, z), positive(moment, self.radius, "radius"))
        return less(build, length(build, around, y), positive(moment, self.tube, "tube"))

    def smooth(self, moment: Moment) -> bool:
        """Where it has a hole: else its surface has two dents on the axis."""
        return bool(positive(moment, self.tube, "tube") < positive(moment, self.radius, "radius"))

    def reach(self, moment: Moment) -> tuple[Any, Any]:
        """The flat block around it."""
        tube = positive(moment, self.tube, "tube")
        r = positive(moment, self.radius, "radius") + tube
        return (-r, -tube, -r), (r, tube, r)

    def volume_moments(self, moment: Moment, measure: Callable[[Shaped], VolumeMoments]) -> VolumeMoments | None:
        """2 pi^2 R r^2; the mean of y^2 is r^2/4, of x^2 and z^2 R^2/2 + 3/8 r^2. None where the ring has no hole."""
        R, r = positive(moment, self.radius, "radius"), positive(moment, self.tube, "tube")
        if r > R:
            return None
        across = 0.5 * R * R + 0.375 * r * r
        return VolumeMoments.centered(2 * pi**2 * R * r * r, (across, 0.25 * r * r, across)).mapped(self.local(moment))

    def curved(self, moment: Moment) -> Any:
        """A ring. Raises ValueError where it has no hole."""
        from sceneql.contacts.rigid_exact.curved import ring

        radius, tube = positive(moment, self.radius, "radius"), positive(moment, self.tube, "tube")
        if tube >= radius:
            raise ValueError("a torus without a hole has a dent")
        return ring(radius, tube)
