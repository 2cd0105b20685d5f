"""arrow: a vector drawn as an arrow."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from sceneql.kinds import FixedScalar, Length, Moment, Object, Position, Quantity, Value, Words, field
from sceneql.shapes.checked_values import positive
from sceneql.shapes.placement import apply

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape

SIDES = 24
HEAD, WIDE = 5.0, 2.4
"""Length and radius of the head, in radii of the shaft."""

Vector = Annotated[Value, Quantity(None, (3,))]


class Arrow(Object):
    """An arrow from a place along a vector of any quantity: a velocity, an acceleration, a force.

    It is ``scale`` times as long as the vector, in SI; a vector of zero is not drawn, and a short one has a small head.

    For example `speed: {arrow: {at: swing.bob.position, vector: swing.bob.velocity}}`.
    """

    decorates: ClassVar[bool] = True
    said_by: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("to", "end", "head", "tip"),
        "it goes from `at` by a vector, here the tip's place less that of `at`: `vector: b.position - a.position`",
    )

    at: Position = field("Where it begins.", "0 0 0 m")
    vector: Vector = field("What it shows.")
    scale: FixedScalar = field("Meters for a unit of the vector, in SI.", "1", above=0)
    radius: Length = field("Radius of its shaft.", "15 mm", above=0)
    label: Words | None = field("What stands beyond its head.", None)

    def labels(self, name: str, moment: Moment) -> Iterable[tuple[Any, Any, str]]:
        """Its label, beyond its head."""
        import numpy as np

        start, vector = np.asarray(moment.at(self.at)), self.scale * np.asarray(moment.at(self.vector))
        length = float(np.linalg.norm(vector))
        if self.label is not None and 0.0 < length < math.inf:
            radius, axis, around = self._head(moment, vector, length)
            head = np.vstack([vector[None], (length - HEAD * radius) * axis + WIDE * radius * around])
            place = moment.place(name)
            yield apply(place, start + head), place[:, :3] @ vector, self.label.at(moment)

    def _head(self, moment: Moment, vector: Any, length: float) -> tuple[float, Floats, Floats]:
        """Radius of the shaft [m], unit axis (3,), and unit vectors (SIDES, 3) around it."""
        import numpy as np

        radius = min(positive(moment, self.radius, "radius"), length / (1.5 * HEAD))
        axis = vector / length
        across = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
        across /= np.linalg.norm(across)
        angles = 2 * np.pi * np.arange(SIDES) / SIDES
        return radius, axis, np.cos(angles)[:, None] * across + np.sin(angles)[:, None] * np.cross(axis, across)

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """A mesh of revolution: shaft, collar and head."""
        import numpy as np

        from sceneql.frame import Mesh

        start, vector = np.asarray(moment.at(self.at)), self.scale * np.asarray(moment.at(self.vector))
        length = float(np.linalg.norm(vector))
        if length == 0.0 or not math.isfinite(length):
            return
        radius, axis, around = self._head(moment, vector, length)
        neck = length - HEAD * radius
        profile = [(0.0, 0.0), (0.0, radius), (neck, radius), (neck, WIDE * radius), (length, 0.0)]
        vertices: list[Floats] = []
        normals: list[Floats] = []
        triangles: list[Floats] = []
        for (a, p), (b, q) in itertools.pairwise(profile):
            first = 2 * SIDES * len(vertices)
            vertices.append(np.concatenate([start + a * axis + p * around, start + b * axis + q * around]))
            slant = np.array([b - a, p - q]) / math.hypot(b - a, p - q)
            normals.append(np.tile(slant[0] * around + slant[1] * axis, (2, 1)))
            k = first + np.arange(SIDES)
            after = first + (np.arange(SIDES) + 1) % SIDES
            triangles += [np.stack([k, after, after + SIDES], axis=1), np.stack([k, after + SIDES, k + SIDES], axis=1)]
        faces = np.concatenate(triangles).astype(np.int32)
        if np.linalg.det(place[:, :3]) < 0:
            faces = faces[:, ::-1].copy()
        bent = np.concatenate(normals) @ np.linalg.inv(place[:, :3])
        bent /= np.linalg.norm(bent, axis=1, keepdims=True)
        surface = moment.surface(name, self.material, self.color)
        yield Mesh(name, surface, apply(place, np.concatenate(vertices)), faces, bent)
