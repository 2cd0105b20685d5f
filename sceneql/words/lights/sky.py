"""sky: light from all around."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from sceneql.kinds import Color, Light, Moment, Scalar, Value, field
from sceneql.shapes.color import linear

if TYPE_CHECKING:
    from sceneql import frame


class Sky(Light):
    """Light from all around. Its color blends from the zenith over the horizon to the ground; `color` is all three.

    Under a sky of one color and strength 1, a matte surface in the open is as bright as its own color times the sky's.
    """

    color: Color | None = field("One color all around, in place of the three.", None)
    zenith: Color = field("Color overhead.", "0.62 0.76 0.93")
    horizon: Color = field("Color at the horizon.", "0.93 0.95 0.97")
    ground: Color = field("Color of what shines from below.", "0.55 0.54 0.52")
    strength: Scalar = field("Factor of its light.", "1", at_least=0)
    background: Color | None = field("What the camera sees where nothing is; by default the sky itself.", None)

    def lower(self, moment: Moment) -> Iterable[frame.LightSource]:
        """One sky."""
        from sceneql import frame

        factor = float(moment.at(self.strength))

        def light(color: Value) -> frame.RGB:
            r, g, b = linear(moment.at(self.color or color))
            return factor * r, factor * g, factor * b

        seen = None if self.background is None else linear(moment.at(self.background))
        yield frame.Sky(light(self.zenith), light(self.horizon), light(self.ground), seen)
