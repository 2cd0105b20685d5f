"""mooney_rivlin: rubber that is stretched far."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from sceneql.bodies.elements.laws.law import MATERIAL, Law, Ratio
from sceneql.kinds import field

if TYPE_CHECKING:
    from sceneql.frame import Floats


class MooneyRivlin(Law):
    """Energy a/2 (I_C - 3) + b/2 (II_C - 3) - (a + 2 b)(J - 1) + lambda/2 (J - 1)^2, a + b the shear modulus.

    Mooney (1940) and Rivlin (1948), the volume as in `neo_hookean`, which it is without b: lambda is larger
    by a than Lame's.
    """

    said_by: ClassVar[Mapping[str, str]] = {
        "second": "it is a share of the shear modulus, from 0 to 1 and without a unit: write `second: 0.2`"
    }
    kernels = "sceneql.bodies.elements.laws.mooney_rivlin_kernels"

    second: Ratio | None = field(f"What part b is of the shear modulus, 0 to 1, {MATERIAL}; by default 0.2.", None)

    @classmethod
    def wrong(cls, name: str, number: float) -> str:
        """As of Law; `second` must be from 0 to 1."""
        if name == "second":
            return "" if 0.0 <= number <= 1.0 else f"second must be from 0 to 1, not {number:g}"
        return super().wrong(name, number)

    def numbers(self, places: Floats) -> Floats:
        """(n, 3) [Pa]: Lame's lambda, a and b at material positions (n, 3) [m]."""
        import numpy as np

        first, shear = self.moduli(places)
        part = np.full(len(places), 0.2) if self.second is None else self.at("second", places)
        return np.column_stack([first, (1.0 - part) * shear, part * shear])
