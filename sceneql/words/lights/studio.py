"""studio: the default light."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

from sceneql.kinds import Light, Moment, Scalar, field

if TYPE_CHECKING:
    from sceneql import frame

KEY_DIRECTION = (-0.50, 0.72, 0.48)
KEY = 0.75
"""Brightness of a white matte surface that faces the key light, without the dome."""
KEY_ANGLE = math.radians(8.0)
DOME = ((0.79, 0.80, 0.82), (0.45, 0.46, 0.47), (0.26, 0.26, 0.26))
"""Radiance overhead, at the horizon and from below."""
BACKGROUND = (0.665, 0.665, 0.665)
"""As bright as the stage of a plane without material (words/objects/plane.py), so that its horizon does not show."""


class Studio(Light):
    """A picture of a product: a soft key light from the upper left front, a bright dome, a light gray background."""

    key: Scalar = field("Factor of the key light.", "1", at_least=0)
    fill: Scalar = field("Factor of the dome's light.", "1", at_least=0)

    def lower(self, moment: Moment) -> Iterable[frame.LightSource]:
        """The key light and the dome."""
        from sceneql import frame

        x, y, z = KEY_DIRECTION
        far = math.hypot(x, y, z)
        power = math.pi * KEY * float(moment.at(self.key))
        yield frame.Sun((x / far, y / far, z / far), (power, 0.99 * power, 0.97 * power), KEY_ANGLE)
        fill = float(moment.at(self.fill))
        zenith, horizon, ground = ((fill * r, fill * g, fill * b) for r, g, b in DOME)
        yield frame.Sky(zenith, horizon, ground, visible=BACKGROUND)
