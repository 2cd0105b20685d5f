"""glow: a surface that emits light."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from sceneql.kinds import Color, FixedScalar, Material, Moment, field
from sceneql.shapes.color import linear

if TYPE_CHECKING:
    from sceneql.frame import RGB, Surface


class Glow(Material):
    """A black body that shines evenly to all sides: embers, sparks, lamps. It lights what is near.

    A sphere of it shows a lamp where a `point` light stands that is as large: it throws no shadow in that light, and
    adds none of its own.
    """

    told_by: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("emission", "emission_strength", "emissive_intensity", "luminance"), "strength"),
        **dict.fromkeys(("emissive", "emission_color"), "color"),
    }

    color: Color = field("The color of its light.", "1 1 1")
    strength: FixedScalar = field("Its radiance; 1 is as bright as a white surface in full light.", "1", at_least=0)

    def darkens(self) -> bool:
        """It shines."""
        return True

    def surface(self, moment: Moment, color: RGB | None) -> Surface:
        """Its light, and no reflection."""
        from sceneql.frame import Surface

        r, g, b = color or linear(moment.at(self.color))
        shine = (self.strength * r, self.strength * g, self.strength * b)
        return Surface(color=(0.0, 0.0, 0.0), roughness=1.0, specular=0.0, emission=shine)
