"""metal: brushed or polished metal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar, Literal, get_args

from sceneql.kinds import Color, Material, Moment, Scalar, field
from sceneql.shapes.color import linear

if TYPE_CHECKING:
    from sceneql.frame import RGB, Surface


Named = Literal[
    "aluminum", "brass", "bronze", "chromium", "copper", "gold", "iron", "nickel", "platinum", "silver", "titanium"
]
REFLECTED = (
    (0.912, 0.914, 0.920), (0.910, 0.778, 0.423), (0.714, 0.428, 0.181), (0.550, 0.556, 0.554), (0.955, 0.638, 0.538),
    (1.000, 0.710, 0.291), (0.562, 0.565, 0.578), (0.660, 0.609, 0.526), (0.673, 0.637, 0.585), (0.972, 0.960, 0.915),
    (0.542, 0.497, 0.449),
)  # fmt: skip
"""Linear RGB reflectance of metals at normal incidence, from their indices of refraction in the visible spectrum."""


class Metal(Material):
    """Reflection alone, in its own color (Burley 2012, metallic 1)."""

    told_by: ClassVar[Mapping[str, str]] = {"metallic": "", "metalness": "", "metal": "", "conductor": ""}

    color: Named | Color = field("The metal by its name, or the color of its reflection.", "0.86 0.86 0.87")
    roughness: Scalar = field("0 is polished, 1 is dull.", "0.25", at_least=0, at_most=1)

    def surface(self, moment: Moment, color: RGB | None) -> Surface:
        """A conductor."""
        from sceneql.frame import Surface

        roughness = min(max(float(moment.at(self.roughness)), 0.0), 1.0)
        if isinstance(self.color, str):
            own = REFLECTED[get_args(Named).index(self.color)]
        else:
            own = linear(moment.at(self.color))
        return Surface(color=color or own, roughness=roughness, metallic=1.0)
