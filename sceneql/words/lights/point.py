"""point: a lamp."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

from sceneql.kinds import Color, Length, Light, Moment, Position, Power, field
from sceneql.shapes.color import linear

if TYPE_CHECKING:
    from sceneql import frame


class Point(Light):
    """A small glowing ball whose light falls with the square of the distance.

    A power P shines P/(4 pi) in every direction, so a white matte surface that faces it at the distance r is as bright
    as P/(4 pi^2 r^2): 60 W at 1.2 m as bright as its color.

    For example `lamp: {point: {position: 1 3 2 m, power: 200 W}}`.
    """

    position: Position = field("Where it is.", "0 2 0 m")
    power: Power = field("What it shines in all directions together.", "60 W", at_least=0)
    color: Color = field("Color of its light.", "1 1 1")
    radius: Length = field("Its radius; larger: softer shadows. What is within throws none.", "50 mm", at_least=0)

    def lower(self, moment: Moment) -> Iterable[frame.LightSource]:
        """One point light."""
        from sceneql import frame

        intensity = float(moment.at(self.power)) / (4 * math.pi)
        x, y, z = (float(c) for c in moment.at(self.position))
        r, g, b = linear(moment.at(self.color))
        shine = (intensity * r, intensity * g, intensity * b)
        yield frame.PointLight((x, y, z), shine, float(moment.at(self.radius)))
