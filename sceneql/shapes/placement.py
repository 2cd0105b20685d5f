"""Places of objects: affine maps (3, 4) that take a part's own coordinates to its parent's, or to the world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from sceneql.kinds import Object, Position, Quantity, Rotation, Value, field
from sceneql.quantities import dimension as dim
from sceneql.quantities.expression import Number, Type, Vector

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.kinds import Moment

Scale = Annotated[Value, Quantity(dim.PLAIN, None)]
"""One factor, or three along the object's own axes."""
UPRIGHT = Value(Vector((Number(1.0), Number(0.0), Number(0.0), Number(0.0)), Type((4,))))
"""The identity rotation, as a quaternion [w, x, y, z]."""


class Placed(Object):
    """An object with a place: its own coordinates are turned about its own origin, then moved."""

    position: Position = field("Where its origin is.", "0 0 0 m")
    rotation: Rotation = field("How it is turned about its origin.", "1 0 0 0")

    def local(self, moment: Moment) -> Floats:
        """(3, 4) map from its own coordinates to its parent's."""
        return affine(moment.at(self.position), moment.at(self.rotation))

    def smooth(self, moment: Moment) -> bool:
        """Whether its surface is known to have one tangent plane at each place: no creases, no corners."""
        return False


def rotation_matrix(quaternion: Any) -> Floats:
    """Rotation matrix (3, 3) of a quaternion [w, x, y, z] of any length but 0. Raises ValueError for 0."""
    import numpy as np

    q = np.asarray(quaternion, dtype=float)
    length = float(np.linalg.norm(q))
    if not (length > 0 and np.isfinite(length)):
        raise ValueError("a rotation is a quaternion that is not zero")
    w, x, y, z = q / length
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def affine(position: Any, rotation: Any, scale: Any = 1.0) -> Floats:
    """(3, 4) map that scales, then turns, then moves."""
    import numpy as np

    linear = rotation_matrix(rotation) * np.broadcast_to(np.asarray(scale, dtype=float), 3)
    return np.column_stack([linear, np.asarray(position, dtype=float)])


def unit_vector(vector: Any) -> Floats:
    """Unit vector (3,) along a vector of any finite length but zero, scaled first so that no square overflows."""
    import numpy as np

    scaled = np.ldexp(np.asarray(vector, dtype=float), -np.frexp(np.abs(vector).max())[1])
    found: Floats = scaled / np.linalg.norm(scaled)
    return found


def compose(outer: Floats, inner: Floats) -> Floats:
    """(3, 4) map that applies ``inner``, then ``outer``."""
    import numpy as np

    linear = outer[:, :3] @ inner[:, :3]
    return np.column_stack([linear, outer[:, :3] @ inner[:, 3] + outer[:, 3]])


def inverse(place: Floats) -> Floats:
    """(3, 4) inverse map. Raises numpy.linalg.LinAlgError where there is none."""
    import numpy as np

    linear = np.linalg.inv(place[:, :3])
    return np.column_stack([linear, -linear @ place[:, 3]])


def apply(place: Floats, points: Any) -> Floats:
    """Mapped points (..., 3)."""
    import numpy as np

    mapped: Floats = np.asarray(points, dtype=float) @ place[:, :3].T + place[:, 3]
    return mapped


def mapped_box(place: Floats, low: Any, high: Any) -> tuple[Floats, Floats]:
    """Low and high corner (3,) of the smallest box around a mapped box, which may be infinite."""
    import numpy as np

    linear = place[:, :3]
    with np.errstate(invalid="ignore"):
        ends = np.stack([linear * np.asarray(low, dtype=float), linear * np.asarray(high, dtype=float)])
    ends = np.where(linear == 0, 0.0, ends)
    return place[:, 3] + ends.min(axis=0).sum(axis=1), place[:, 3] + ends.max(axis=0).sum(axis=1)


def balls_box(place: Floats, centers: Any, radii: Any) -> tuple[Floats, Floats]:
    """Low and high corner (3,) of the world box around mapped balls: centers (..., 3), radii (...)."""
    import numpy as np

    middle = apply(place, np.reshape(centers, (-1, 3)))
    reach = np.broadcast_to(radii, np.shape(centers)[:-1]).reshape(-1, 1) * np.linalg.norm(place[:, :3], axis=1)
    # Reduced by contiguous columns: a numpy reduction along rows of three takes ten times as long.
    columns, reaches = np.ascontiguousarray(middle.T), np.ascontiguousarray(reach.T)
    return (columns - reaches).min(axis=1), (columns + reaches).max(axis=1)


def uniform_scale(place: Floats) -> float:
    """The factor of a map that keeps angles. Raises ValueError for one that stretches unevenly."""
    import numpy as np

    lengths = np.linalg.norm(place[:, :3], axis=0)
    if not np.allclose(
        place[:, :3].T @ place[:, :3], np.eye(3) * lengths[0] ** 2, rtol=1e-9, atol=1e-9 * lengths[0] ** 2
    ):
        raise ValueError("it cannot be stretched unevenly")
    return float(lengths[0])
