"""auto: the default camera."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

from sceneql.kinds import Angle, Camera, FixedScalar, Moment, field
from sceneql.pictures import framing

if TYPE_CHECKING:
    from sceneql.frame import Floats, View

THREE_QUARTER = (0.55, 0.38, 1.0)
ALONG = ((1.0, 0.1, 0.0), (0.0, 1.0, 0.12), (0.0, 0.1, 1.0))
"""Directions towards the camera for scenes that are flat in x, y or z."""
FLAT, EVEN = 0.2, 0.005
"""Largest depth along an axis, relative to the smaller of both other sizes, for a view along that axis. A FLAT scene is
viewed nearly along it, so that bodies stand out from their ground; an EVEN one exactly, so that right angles stay."""
LONG, ACROSS = 0.12, {0: ALONG[2], 2: ALONG[0]}
"""Larger one of both other sides, relative to the length, below which a scene long in x or z is viewed across; and
directions towards the camera by the long axis."""
HEADROOM = 0.86
"""Largest fraction of the height between the margins that is filled: pictures are wider than most subjects."""


class Auto(Camera):
    """A three-quarter view of all that is drawn, from the right front and above, that holds still over the whole film.

    A scene that is flat along an axis is seen along it, one that is long and lies across. The few of many things that
    leave for good are let go. Panels of variants share one view, and overlays are left room.
    """

    yields: ClassVar[bool] = True

    field_of_view: Angle = field("Vertical field of view.", "30 deg", above=0, below=math.pi)
    margin: FixedScalar = field("Part of half the picture that is left free.", "0.12", at_least=0, below=1)

    def view(self, size: tuple[int, int], moment: Moment) -> View:
        """The view of the whole film."""
        half = math.tan(0.5 * float(moment.at(self.field_of_view)))
        points = moment.outline()
        axes = framing.axes_towards(_towards(points))
        slopes, middle = framing.inner(half, size, self.margin, moment.room, HEADROOM)
        origin, _ = framing.fitted(points, axes, slopes, middle=middle)
        return framing.view(origin, axes, size, half)


def _towards(points: Floats) -> tuple[float, float, float]:
    """Direction from the scene to its camera, by the proportions of the box around points (n, 3)."""
    sides = points.max(axis=0) - points.min(axis=0)
    thin = int(sides.argmin())
    others = [float(side) for k, side in enumerate(sides) if k != thin]
    if sides[thin] < EVEN * min(others):
        x, y, z = (float(k == thin) for k in range(3))
        return x, y, z
    if sides[thin] < FLAT * min(others):
        return ALONG[thin]
    long = int(sides.argmax())
    return ACROSS.get(long, THREE_QUARTER) if min(others) < LONG * sides[long] else THREE_QUARTER
