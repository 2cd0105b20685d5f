"""checker: squares of two colors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from sceneql.kinds import Color, FixedLength, Material, Moment, Scalar, field
from sceneql.shapes.color import linear

if TYPE_CHECKING:
    from sceneql.frame import RGB, Surface


class Checker(Material):
    """Squares of two colors in the world's x and z (and y, off horizontal faces), one with a corner at the origin."""

    said_by: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("scale", "tiles", "count", "repeat", "frequency"), "the side of a square is its `size: 0.5 m`"
    )

    color: Color = field("Color of the first squares.", "0.84 0.84 0.85")
    other: Color = field("Color of the squares between.", "0.58 0.59 0.61")
    size: FixedLength = field("Side of a square.", "0.5 m", above=0)
    roughness: Scalar = field("1 is matte; less than that reflects.", "1", at_least=0, at_most=1)

    def surface(self, moment: Moment, color: RGB | None) -> Surface:
        """Matte at roughness 1, else a dielectric; a color given stands for the first squares."""
        from sceneql.frame import Surface

        roughness = min(max(float(moment.at(self.roughness)), 0.0), 1.0)
        return Surface(
            color=color or linear(moment.at(self.color)),
            roughness=roughness,
            specular=0.0 if roughness == 1 else 0.04,
            checker_size=self.size,
            checker_color=linear(moment.at(self.other)),
        )
