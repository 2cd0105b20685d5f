"""matte: an ideal diffuse surface."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.kinds import Color, Material, Moment, field
from sceneql.shapes.color import linear

if TYPE_CHECKING:
    from sceneql.frame import RGB, Surface


class Matte(Material):
    """Equally bright from all sides: reflects color/pi of the light that falls on it (Lambert 1760), and no gloss."""

    color: Color = field("The part of the light that it reflects.", "0.8 0.8 0.8")

    def surface(self, moment: Moment, color: RGB | None) -> Surface:
        """Rough, without specular reflection."""
        from sceneql.frame import Surface

        return Surface(color=color or linear(moment.at(self.color)), roughness=1.0, specular=0.0)
