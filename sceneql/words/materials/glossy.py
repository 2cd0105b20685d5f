"""glossy: plastic, paint, porcelain."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from sceneql.kinds import Color, FixedScalar, Material, Moment, Scalar, field
from sceneql.shapes.color import linear

if TYPE_CHECKING:
    from sceneql.frame import RGB, Surface


class Glossy(Material):
    """A diffuse color under a clear reflecting surface (Burley 2012): plastic, paint, porcelain."""

    told_by: ClassVar[Mapping[str, str]] = {
        "roughness": "roughness",
        "specular": "specular",
        "shininess": "",
        "clearcoat": "",
    }

    color: Color = field("The diffuse color.", "0.8 0.8 0.8")
    roughness: Scalar = field("0 reflects like a mirror, 1 is dull.", "0.3", at_least=0, at_most=1)
    specular: FixedScalar = field("Part of the light reflected at normal incidence.", "0.04", at_least=0, at_most=1)

    def surface(self, moment: Moment, color: RGB | None) -> Surface:
        """A dielectric."""
        from sceneql.frame import Surface

        roughness = min(max(float(moment.at(self.roughness)), 0.0), 1.0)
        return Surface(color=color or linear(moment.at(self.color)), roughness=roughness, specular=self.specular)
