"""sun: light from far away."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from sceneql.kinds import Angle, Color, Direction, Doubt, Light, Moment, Scalar, field
from sceneql.shapes.color import linear

if TYPE_CHECKING:
    from sceneql import frame

STEEP = 0.3
"""Part of a direction down from which on it is taken for that of the light's rays; rims may shine from below."""


class Sun(Light):
    """Light from one direction, everywhere equally strong.

    At strength 1 a white matte surface that faces it is as bright as its color: it gets the irradiance pi.

    For example `noon: {sun: {elevation: 60 deg, azimuth: 30 deg}}`.
    """

    direction: Direction | None = field("From the scene towards it; in place of elevation and azimuth.", None)
    elevation: Angle = field("How high it stands above the horizon.", "45 deg")
    azimuth: Angle = field("Where it stands, from +z (the viewer's side) towards +x (the right).", "-40 deg")
    strength: Scalar = field("Factor of its light.", "1", at_least=0)
    color: Color = field("Color of its light.", "1 1 1")
    angle: Angle = field("How wide it looks; wider gives softer shadows.", "0.53 deg", at_least=0, at_most=math.pi)

    def doubts(self) -> Iterator[Doubt]:
        """A direction that points down, as from the sun to the scene."""
        if self.direction is None and self.elevation.constant and (low := math.sin(self.elevation.number())) < -STEEP:
            text = f"it shines from below: its `elevation` is {math.degrees(math.asin(low)):.3g} deg"
            up = f"{-math.degrees(math.asin(low)):.3g}"
            yield Doubt("light-from-below", text, self.elevation.span, f"write `elevation: {up} deg`")
        if self.direction is None or not self.direction.constant:
            return
        x, y, z = (float(c) for c in self.direction.number())
        if y < -STEEP * math.hypot(x, y, z):
            text = "it shines from below: its `direction` is that from the scene towards it, and this points down"
            back = " ".join(f"{0.0 - c:g}" for c in (x, y, z))
            yield Doubt("light-from-below", text, self.direction.span, f"write `direction: {back}`")

    def lower(self, moment: Moment) -> Iterable[frame.LightSource]:
        """One distant light. Raises ValueError for a direction of zero."""
        from sceneql import frame

        if self.direction is not None:
            x, y, z = (float(c) for c in moment.at(self.direction))
        else:
            up, around = float(moment.at(self.elevation)), float(moment.at(self.azimuth))
            x, y, z = math.cos(up) * math.sin(around), math.sin(up), math.cos(up) * math.cos(around)
        far = math.hypot(x, y, z)
        if not far > 0:
            raise ValueError("a direction is not zero")
        power = math.pi * float(moment.at(self.strength))
        r, g, b = linear(moment.at(self.color))
        irradiance = (power * r, power * g, power * b)
        yield frame.Sun((x / far, y / far, z / far), irradiance, float(moment.at(self.angle)))
