"""auto: the default camera."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

from sceneql.kinds import Angle, Camera, FixedScalar, Moment, field
from sceneql.pictures import framing

if TYPE_CHECKING:
    from sceneql.frame import View

THREE_QUARTER = (0.55, 0.38, 1.0)
FRONT = (0.0, 0.1, 1.0)
FLAT = 0.2
"""What is shallower in z than this part of its height and width is seen from the front."""


class Auto(Camera):
    """A three-quarter view of all that is drawn, from the right front and above, that holds still over the whole film.

    A scene that is flat in z is seen from the front. The few of many things that leave for good are let go. Panels of
    variants share one view, and overlays are left room.
    """

    yields: ClassVar[bool] = True

    field_of_view: Angle = field("Vertical field of view.", "30 deg", above=0, below=math.pi)
    margin: FixedScalar = field("Part of half the picture that is left free.", "0.12", at_least=0, below=1)

    def view(self, size: tuple[int, int], moment: Moment) -> View:
        """The view of the whole film."""
        half = math.tan(0.5 * float(moment.at(self.field_of_view)))
        low, high = framing.bounds(moment, None)
        width, height, depth = high - low
        axes = framing.axes_towards(FRONT if depth < FLAT * min(width, height) else THREE_QUARTER)
        slopes, middle = framing.inner(half, size, self.margin, moment.room)
        origin, _ = framing.fitted(framing.corners(low, high), axes, slopes, middle=middle)
        return framing.view(origin, axes, size, half)
