"""plane: the half space below an infinite plane."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from sceneql.kinds import Collider, Direction, FieldBuilder, Length, Moment, Object, Position, Value, field
from sceneql.quantities.dimension import LENGTH
from sceneql.quantities.expression import Call, Type
from sceneql.shapes.placement import compose
from sceneql.shapes.solid import INFINITY, quadric

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape
    from sceneql.system import Assembly


class Plane(Object):
    """The half-space n . (p - position) <= height with the unit normal n; its field is the signed distance.

    As a floor it needs no field: it is the level y = 0.
    """

    collides: ClassVar[bool] = True
    grounds: ClassVar[bool] = True

    said_by: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(
            ("size", "width", "length", "depth", "sides"),
            "it is endless; a plate is a flat box, `{box: {size: 4 0.1 4 m}}`",
        ),
        **dict.fromkeys(
            ("rotation", "rotate", "angle", "tilt", "slope", "inclination"),
            "it is tilted by its normal, by 20 deg about z: `normal: [-sin(20 deg), cos(20 deg), 0]`",
        ),
    }

    height: Length = field("How far along its normal it lies from `position`.", "0 m")
    position: Position = field("A point that `height` counts from.", "0 0 0 m")
    normal: Direction = field("The direction that it faces, of any length.", "0 1 0")

    def _level(self, moment: Moment) -> tuple[Floats, float]:
        """Unit normal (3,) n, and n . x [m] for points x of the plane."""
        import numpy as np

        n = np.asarray(moment.at(self.normal), dtype=float)
        n = n / np.linalg.norm(n)
        return n, float(n @ moment.at(self.position) + moment.at(self.height))

    def convex(self, moment: Moment, center: Floats) -> Any:
        """A half space, from its position."""
        from sceneql.contacts.distance.convex import half_space

        normal, _ = self._level(moment)
        return half_space(normal, float(moment.at(self.height)))

    def implicit(self, build: FieldBuilder, x: int, y: int, z: int, moment: Moment) -> int:
        """Signed distance."""
        n, level = self._level(moment)
        (value, _, _) = build.affine(_rows(n, level), x, y, z)
        return value

    def extent(self, place: Floats, moment: Moment) -> tuple[Floats, Floats]:
        """Everywhere, but for a plane across an axis of the world: up to its level."""
        import numpy as np

        n, level = self._level(moment)
        low, high = np.full(3, -np.inf), np.full(3, np.inf)
        # Equation of the plane in the world: normals are mapped by the transposed inverse.
        normal = np.linalg.solve(place[:, :3].T, n)
        offset = level + float(normal @ place[:, 3])
        (across,) = np.nonzero(np.abs(normal) > 1e-12 * np.abs(normal).max())
        if len(across) == 1:
            bound = high if normal[across[0]] > 0 else low
            bound[across[0]] = offset / normal[across[0]]
        return low, high

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """A half-space."""
        import numpy as np

        from sceneql.frame import Surface

        n, level = self._level(moment)
        if self.material is None and self.color is None:  # the default stage: matte, light gray
            surface = Surface(color=(0.54, 0.54, 0.54), roughness=1.0, specular=0.0)
        else:
            surface = moment.surface(name, self.material, self.color)
        beside = np.cross(n, np.eye(3)[np.argmin(np.abs(n))])
        beside /= np.linalg.norm(beside)
        own = np.column_stack([beside, n, np.cross(beside, n), level * n])
        half = (INFINITY, INFINITY, INFINITY)
        yield quadric(name, surface, compose(place, own), linear=(0.0, 1.0, 0.0), constant=0.0, half=half)

    def collider(self, assembly: Assembly) -> Collider:
        """A point on it and its normal, in the world's axes."""
        normal = Call("normalize", (self.normal.expr,), Type((3,)))
        shift = Call("mul", (self.height.expr, normal), Type((3,), LENGTH))
        place = Value(Call("add", (self.position.expr, shift), Type((3,), LENGTH)), self.position.span)
        return Collider(
            "sceneql.contacts.shapes.plane_kernels",
            assembly.value(place),
            assembly.floats([1.0, 0.0, 0.0, 0.0]),
            assembly.value(Value(normal, self.normal.span)),
            assembly.floats([INFINITY]),
            flat=True,
        )


def _rows(normal: Floats, level: float) -> Floats:
    """Affine map (3, 4) whose first row is the signed distance from the plane."""
    import numpy as np

    rows = np.zeros((3, 4))
    rows[0, :3], rows[0, 3] = normal, -level
    return rows
