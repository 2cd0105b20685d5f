"""metal: brushed or polished metal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.kinds import Color, Material, Moment, Scalar, field
from sceneql.shapes.color import linear

if TYPE_CHECKING:
    from sceneql.frame import RGB, Surface


class Metal(Material):
    """Reflection alone, in its own color (Burley 2012, metallic 1): gold, copper, steel."""

    color: Color = field("Color of its reflection; gold is 1 0.85 0.57.", "0.86 0.86 0.87")
    roughness: Scalar = field("0 is polished, 1 is dull.", "0.25", at_least=0, at_most=1)

    def surface(self, moment: Moment, color: RGB | None) -> Surface:
        """A conductor."""
        from sceneql.frame import Surface

        roughness = min(max(float(moment.at(self.roughness)), 0.0), 1.0)
        return Surface(color=color or linear(moment.at(self.color)), roughness=roughness, metallic=1.0)
