"""turntable: a camera that goes round."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from sceneql.kinds import Angle, Camera, DrawnRef, FixedScalar, FixedTime, Length, Moment, Position, field
from sceneql.simulation import framing
from sceneql.simulation.present import positive

if TYPE_CHECKING:
    from sceneql.frame import View

AZIMUTHS = 72


class Turntable(Camera):
    """A camera that goes round at a constant height and distance, looking at what it goes around.

    Without `distance` it stands as near as it can with that in the picture all the way round.
    """

    around: DrawnRef | None = field("The part it goes around; by default all that is drawn.", None)
    look_at: Position | None = field("The point in the middle; by default that of what it goes around.", None)
    seconds: FixedTime = field("Time of a turn.", "8 s", above=0)
    start: Angle = field("Where it begins, from +z towards +x.", "30 deg")
    tilt: Angle = field("How high it stands above the horizontal, as an angle.", "18 deg")
    distance: Length | None = field("Distance from the middle; by default as near as it can.", None, above=0)
    margin: FixedScalar = field("Part of half the picture that is left free.", "0.08", at_least=0, below=1)
    field_of_view: Angle = field("Vertical field of view.", "35 deg", above=0, below=math.pi)

    def view(self, size: tuple[int, int], moment: Moment) -> View:
        """The view of this instant."""
        half = math.tan(0.5 * float(moment.at(self.field_of_view)))
        tilt = float(moment.at(self.tilt))
        low, high = framing.bounds(moment, None if self.around is None else (self.around,))
        aim = (low + high) / 2 if self.look_at is None else moment.at(self.look_at)
        if self.distance is not None:
            distance = positive(moment, self.distance, "distance")
        else:
            points, slopes = framing.corners(low, high), framing.seen_slopes(half, size, self.margin)
            every = (framing.axes_towards(_towards(2 * math.pi * k / AZIMUTHS, tilt)) for k in range(AZIMUTHS))
            distance = max(framing.fitted(points, axes, slopes, aim)[1] for axes in every)
        azimuth = float(moment.at(self.start)) + 2 * math.pi * moment.time / self.seconds
        axes = framing.axes_towards(_towards(azimuth, tilt))
        return framing.view(aim + distance * axes[2], axes, size, half)


def _towards(azimuth: float, tilt: float) -> Any:
    """Direction from the middle towards the camera."""
    return (math.cos(tilt) * math.sin(azimuth), math.sin(tilt), math.cos(tilt) * math.cos(azimuth))
