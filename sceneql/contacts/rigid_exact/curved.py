"""Curved shapes for exact contacts of rigid bodies: ellipsoids, rings, columns, and smooth fields.

Imports numpy: to be imported by the method that runs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sceneql.contacts.distance.convex import Convex, capsule, mass

if TYPE_CHECKING:
    from sceneql.frame import Floats

CURVED = 5
"""Kind of a shape, beside those of convex.py."""
ELLIPSOID, RING, COLUMN, FIELD = range(4)
FORM, CENTER, AXES, SIZES, FLOATS = 2, 3, 6, 15, 18
"""Numbers of a shape, behind radius (0) and reach: its form; its middle (3) and its axes (3, 3), an axis a row, in the
body's axes; sizes (3): half axes of an ellipsoid; radius of the circle and of the tube of a ring, whose own axis is the
second; radius and half height of a column; of a field where its object's integers begin (contacts/layout.py)."""
UNEVEN = 1e-12
"""Part by which lengths of a map may differ that is taken to keep angles."""


@dataclass(frozen=True, slots=True, eq=False)
class Curved:
    """A curved shape in an object's own coordinates."""

    form: int
    sizes: Sequence[float]
    """[m], as of SIZES."""
    center: Floats
    axes: Floats
    """(3, 3), an axis a row."""

    def mapped(self, place: Floats) -> Curved:
        """Under an affine map (3, 4). Raises ValueError where it would be none of the forms any more."""
        linear = place[:, :3]
        center = linear @ self.center + place[:, 3]
        if self.form == ELLIPSOID:
            whole = linear @ self.axes.T * np.asarray(self.sizes)
            turn, sizes, _ = np.linalg.svd(whole)
            return Curved(ELLIPSOID, sizes.tolist(), center, _right(turn.T))
        lengths = np.linalg.norm(linear, axis=0)
        if np.abs(linear.T @ linear - lengths[0] ** 2 * np.eye(3)).max() > UNEVEN * lengths[0] ** 2:
            raise ValueError("it is stretched unevenly")
        sizes = lengths[0] * np.asarray(self.sizes)
        return Curved(self.form, sizes.tolist(), center, _right(self.axes @ linear.T / lengths[0]))

    def shape(self, center: Floats) -> Convex:
        """For the kernels, from a center of mass (3,) in the object's own axes."""
        a, b, *_ = self.sizes
        far = max(self.sizes) if self.form == ELLIPSOID else (a + b if self.form == RING else float(np.hypot(a, b)))
        middle = self.center - center
        reach = far + float(np.linalg.norm(middle))
        sizes = [*self.sizes, 0.0][:3]
        floats = np.concatenate([[0.0, reach, self.form], middle, self.axes.ravel(), sizes])
        return Convex(CURVED, floats, np.zeros(0, dtype=np.int64))


def ellipsoid(half: Sequence[float]) -> Curved:
    """An ellipsoid of half axes (3,) [m] around the origin."""
    return Curved(ELLIPSOID, tuple(half), np.zeros(3), np.eye(3))


def ring(radius: float, tube: float) -> Curved:
    """A ring about the axis y [m]."""
    return Curved(RING, (radius, tube), np.zeros(3), np.eye(3))


def column(radius: float, half: float) -> Curved:
    """A round column along the axis y, of this radius and half height [m]."""
    return Curved(COLUMN, (radius, half), np.zeros(3), np.eye(3))


def axis_of(shape: Convex) -> Convex:
    """What others meet a column by: its axis with its radius; nothing of any other shape."""
    numbers = shape.floats
    if shape.kind != CURVED or numbers[FORM] != COLUMN:
        return mass()
    center, axis = numbers[CENTER : CENTER + 3], numbers[AXES + 3 : AXES + 6]
    radius, half = numbers[SIZES : SIZES + 2].tolist()
    return capsule(center - half * axis, center + half * axis, radius)


def _right(axes: Floats) -> Floats:
    """Axes that make a right-handed triple."""
    if np.linalg.det(axes) < 0:
        axes = axes * np.array([[1.0], [1.0], [-1.0]])
    return np.ascontiguousarray(axes)
