"""cylinder: an upright round column."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from math import pi
from typing import TYPE_CHECKING, Any, ClassVar

from sceneql.kinds import FieldBuilder, Length, Moment, Shaped, VolumeMoments, field
from sceneql.shapes.checked_values import positive
from sceneql.shapes.placement import compose
from sceneql.shapes.solid import INFINITY, Solid, largest, length, less, quadric

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape


class Cylinder(Solid):
    """The column x^2 + z^2 <= radius^2, |y| <= height / 2 about its position.

    Its field is max(sqrt(x^2 + z^2) - radius, |y| - height / 2): exact inside and in front of its side and ends, less
    than the distance in front of its rims.

    For example `post: {cylinder: {radius: 5 cm, height: 1 m, position: 0 0.5 0 m}}`.
    """

    said_by: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("from", "to", "start", "end", "ends"),
        "from one place to another reaches a tube: `{tube: {through: [0 0 0 m, 0 1 0 m], radius: 10 cm}}`",
    )

    radius: Length = field("Its radius.", "0.5 m", above=0)
    height: Length = field("Its length along its own y.", "1 m", above=0)

    def odd_section(self) -> str:
        """Along y it is cut to a rectangle."""
        round_one = "for a round one turn it along z, `rotation: {about: x, angle: 90 deg}`"
        upright = self.rotation.constant and tuple(self.rotation.number()) == (1.0, 0.0, 0.0, 0.0)
        return f"a rectangle: {round_one}" if upright else ""

    @property
    def traced(self) -> str:
        """It is met exactly."""
        return ""

    def inside(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Signed distance in the maximum norm of side and ends."""
        half = 0.5 * positive(moment, self.height, "height")
        side = less(build, length(build, x, z), positive(moment, self.radius, "radius"))
        return largest(build, side, less(build, build.op("abs", y), half))

    def reach(self, moment: Moment) -> tuple[Any, Any]:
        """The block around it."""
        r, half = positive(moment, self.radius, "radius"), 0.5 * positive(moment, self.height, "height")
        return (-r, -half, -r), (r, half, r)

    def volume_moments(self, moment: Moment, measure: Callable[[Shaped], VolumeMoments]) -> VolumeMoments:
        """pi r^2 h; the means of x^2 and z^2 are r^2/4, of y^2 h^2/12."""
        r, half = positive(moment, self.radius, "radius"), 0.5 * positive(moment, self.height, "height")
        squares = 0.25 * r * r, half * half / 3, 0.25 * r * r
        return VolumeMoments.centered(2 * pi * r * r * half, squares).mapped(self.local(moment))

    def curved(self, moment: Moment) -> Any:
        """A column with sharp rims."""
        from sceneql.contacts.rigid_exact.curved import column

        return column(positive(moment, self.radius, "radius"), 0.5 * positive(moment, self.height, "height"))

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """A quadric cut off at its ends."""
        r, half = positive(moment, self.radius, "radius"), 0.5 * positive(moment, self.height, "height")
        surface = moment.surface(name, self.material, self.color)
        whole = compose(place, self.local(moment))
        yield quadric(name, surface, whole, squares=(1.0, 0.0, 1.0), constant=-r * r, half=(INFINITY, half, INFINITY))
