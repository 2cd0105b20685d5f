"""How fast elements swing, by the numbers of a script alone."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from sceneql.bodies.elements.laws.law import POISSON
from sceneql.grids.medium import number_in

if TYPE_CHECKING:
    from sceneql.bodies.elements.element import Element
    from sceneql.bodies.elements.laws.law import Law
    from sceneql.kinds import Formula

LEAST = {(False, False): 4.7, (True, False): 17.0, (False, True): 2.2, (True, True): 6.9}
"""Least fastest angular frequency, over speed of pressure waves by spacing: by whether elements have ten nodes, and of
blocks. The least of solved ones, at Poisson ratios of -0.5 to 0.49 and cells to 10:1; spheres, boxes and blocks of
cubes swing at 1 to 1.7 times as much."""


def fastest(
    law: Law, density: Formula | None, by_default: float, spacing: float, element: type[Element], block: bool
) -> float:
    """Angular frequency [1/s] that the fastest oscillation surpasses, of elements ``spacing`` [m] across.

    ``density``: None for the one ``by_default`` [kg/m^3]. 0 where the law or the density varies, or without a spacing.
    """
    modulus, held = number_in(law.modulus), by_default if density is None else number_in(density)
    poisson = POISSON if law.poisson is None else number_in(law.poisson)
    if modulus is None or poisson is None or held is None or held <= 0.0 or spacing <= 0.0:
        return 0.0
    wave = modulus * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson) * held)
    return LEAST[element.edges, block] * math.sqrt(wave) / spacing
