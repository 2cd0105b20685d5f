"""sprites: points as soft discs that face the camera."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Literal

from sceneql.kinds import FixedScalar, Length, Moment, Object, Points, field
from sceneql.shapes.checked_values import positive
from sceneql.shapes.placement import apply, uniform_scale

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape

DARKEST = 0.3
"""Brightest channel (sRGB) below which covering discs count as soot, which needs a light background."""


class Sprites(Object):
    """A soft disc at each of some points, which always faces the camera: sparks, glowing gas, spray, smoke, dust.

    Brightest in its middle, by (1 - q^2)^2 of the distance q in parts of its radius. Discs that add, and those of a
    `glow`, shine by themselves, in their color as it is. Others that cover are lit as smoke: by lamps and sky, less
    what the object's own discs hide of these, so that it is darker inside and away from the lamp, and of lamps less
    what solids hide. Discs throw no shadow on other things; no mirror shows them; where they cut through a surface they
    fade.
    """

    at: Points = field("Where they are: `dust.positions`.")
    radius: Length = field("Radius of a disc.", "20 mm", above=0)
    blend: Literal["adds", "covers"] = field("Whether their light adds to what is behind, or covers it.", "adds")
    opacity: FixedScalar = field(
        "How much of what is behind a disc covers in its middle; or what the light that it adds is multiplied by.",
        "1",
        at_least=0,
        at_most=1,
    )

    def darkens(self) -> bool:
        """They shine; where they cover what is behind, unless their color is dark."""
        color = self.color
        dark = color is not None and color.constant and max(color.number()) < DARKEST
        return self.blend == "adds" or not dark

    def lower(self, name: str, place: Floats, moment: Moment) -> Iterable[Shape]:
        """Soft points."""
        import numpy as np

        from sceneql.frame import Points as Spheres

        centers = apply(place, np.asarray(moment.at(self.at), dtype=float).reshape(-1, 3))
        radii = np.full(len(centers), positive(moment, self.radius, "radius") * uniform_scale(place))
        surface = moment.surface(name, self.material, self.color)
        yield Spheres(name, surface, centers, radii, soft=self.blend, opacity=self.opacity)
