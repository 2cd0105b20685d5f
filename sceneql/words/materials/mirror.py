"""mirror: a perfect reflection."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from sceneql.kinds import Color, Material, Moment, field
from sceneql.shapes.color import linear

if TYPE_CHECKING:
    from sceneql.frame import RGB, Surface


class Mirror(Material):
    """A sharp reflection, tinted by its color."""

    told_by: ClassVar[Mapping[str, str]] = {"reflection": "", "reflectivity": "", "reflective": "", "reflectance": ""}

    color: Color = field("Tint of the reflection.", "0.97 0.97 0.97")

    def surface(self, moment: Moment, color: RGB | None) -> Surface:
        """A metal without roughness."""
        from sceneql.frame import Surface

        return Surface(color=color or linear(moment.at(self.color)), roughness=0.0, metallic=1.0)
