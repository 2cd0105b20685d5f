"""glass: clear or tinted, refracting."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from sceneql.kinds import Color, FixedScalar, Material, Moment, field
from sceneql.shapes.color import linear

if TYPE_CHECKING:
    from sceneql.frame import RGB, Surface


class Glass(Material):
    """Refracts by Snell's law and reflects by Fresnel's equations; light that passes its surface takes its color."""

    clear: ClassVar[bool] = True
    told_by: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("ior", "index_of_refraction", "refractive_index", "refraction"), "index_of_refraction"),
        **dict.fromkeys(("transmission", "transparency", "transparent", "dielectric"), ""),
    }

    color: Color = field("Color of the light that passes.", "1 1 1")
    index_of_refraction: FixedScalar = field("1.33 is water, 1.5 glass, 2.42 diamond.", "1.5", at_least=1, at_most=4)
    roughness: FixedScalar = field("0 is clear, more is frosted.", "0", at_least=0, at_most=1)

    def surface(self, moment: Moment, color: RGB | None) -> Surface:
        """A dielectric that transmits; its reflectance at normal incidence is ((n - 1)/(n + 1))^2 (Fresnel 1823)."""
        from sceneql.frame import Surface

        n = self.index_of_refraction
        return Surface(
            color=color or linear(moment.at(self.color)),
            roughness=self.roughness,
            specular=((n - 1) / (n + 1)) ** 2,
            transmission=1.0,
            index_of_refraction=n,
        )
