"""studio: the default light."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, ClassVar, Literal

from sceneql.kinds import Light, Moment, Scalar, field

if TYPE_CHECKING:
    from sceneql import frame

KEY, KEY_FROM, KEY_ANGLE = 1.0, (-0.50, 0.72, 0.48), math.radians(10.0)
"""Key light: radiance of a white matte surface facing it, without the dome; direction; apparent size [rad]."""
RIM, RIM_FROM, RIM_ANGLE = 0.30, (0.62, 0.40, -0.68), math.radians(14.0)
"""Rim light from behind, as KEY; it separates edges from the background."""
DOME = ((0.44, 0.45, 0.47), (0.24, 0.245, 0.25), (0.15, 0.15, 0.15))
"""Radiance of the dome overhead, at the horizon and from below; key and dome light a white surface 4:1."""
BOXES = (
    ((-0.50, 0.72, 0.48), (50.0, 38.0), 1.6),
    ((0.93, 0.30, 0.25), (13.0, 62.0), 1.6),
    ((0.10, 0.80, -0.60), (80.0, 16.0), 1.0),
)
"""Soft boxes that metal and glass mirror: around the key light, a strip on the right, a bar behind and above.

Each has a direction, width and height [deg], and radiance. Their light on matte surfaces is part of the dome's."""
BACKGROUND, BELOW, SWEEP = (0.325, 0.345, 0.37), (0.655, 0.655, 0.655), 0.16
"""Cove: radiance of the background straight ahead, and below, where it equals the floor of a plane without material
(words/objects/plane.py); sine of the angle below which the floor fades into it, so that there is no horizon."""
DARK, DARK_BELOW = (0.006, 0.007, 0.012), (0.016, 0.018, 0.026)
DARK_DOME = ((0.30, 0.31, 0.34), (0.10, 0.105, 0.12), (0.04, 0.042, 0.05))
"""Background and dome of a dark room: bodies are as bright towards the key light, darker away from it, and mirror
the boxes before a dark background."""


class Studio(Light):
    """A picture of a product: a soft key light from the upper left front, a bright dome, a light floor, gray behind.

    Metal, glass and gloss mirror soft boxes, that stand outside of the picture; they change nothing on matte surfaces.
    Without ground, things that shine by themselves, and bodies that pull at each other from afar, stand before the dark
    where no light is written.
    """

    stages: ClassVar[bool] = True

    key: Scalar = field("Factor of the key light.", "1", at_least=0)
    fill: Scalar = field("Factor of the dome's light.", "1", at_least=0)
    boxes: Scalar = field("Factor of the soft boxes that metal and glass mirror.", "1", at_least=0)
    backdrop: Literal["light", "dark"] = field("What is behind all.", "light")

    def lower(self, moment: Moment) -> Iterable[frame.LightSource]:
        """The key light and the dome."""
        from sceneql import frame

        for power, (x, y, z), angle in ((KEY, KEY_FROM, KEY_ANGLE), (RIM, RIM_FROM, RIM_ANGLE)):
            far, given = math.hypot(x, y, z), math.pi * power * float(moment.at(self.key))
            yield frame.Sun((x / far, y / far, z / far), (given, 0.99 * given, 0.97 * given), angle)
        dark = self.backdrop == "dark"
        ahead, below, dome = (DARK, DARK_BELOW, DARK_DOME) if dark else (BACKGROUND, BELOW, DOME)
        fill = float(moment.at(self.fill))
        zenith, horizon, ground = ((fill * r, fill * g, fill * b) for r, g, b in dome)
        shine = float(moment.at(self.boxes))
        boxes = tuple(
            frame.SoftBox(toward, (math.radians(wide), math.radians(high)), (shine * radiance,) * 3)
            for toward, (wide, high), radiance in BOXES
        )
        yield frame.Sky(zenith, horizon, ground, visible=ahead, below=below, fade=SWEEP, boxes=boxes)
