"""Elastic constants of skins."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.system import Flow


ACROSS, ALONG, BENT = 0.55, 0.2, 4.3
"""Factors of tension, of stretch, and of bending over the cell's square in Membrane.largest_tension."""


@dataclass(frozen=True, slots=True)
class Elasticity:
    """Elastic constants of a skin; any of them may be 0, and several may act at once."""

    tension: float = 0.0
    """Constant tension [N/m]."""
    stretch: float = 0.0
    """Tension of springs per relative stretch [N/m]."""
    modulus: float = 0.0
    """Shear modulus of a neo-Hookean sheet, times its thickness [N/m]."""
    shear: float = 0.0
    """Shear modulus of Skalak's law [N/m]."""
    area: float = 0.0
    """Resistance to changes of area in Skalak's law, relative to ``shear``."""
    bend: float = 0.0
    """Bending stiffness [J]."""


def fastest(law: Elasticity, cell: float) -> float:
    """As Membrane.largest_tension, of a law, in cells [m]."""
    # Along a side that does not stretch across.
    slope = law.stretch + 4.0 * law.modulus + 2.0 * law.shear * (1.0 + law.area)
    return max(ACROSS * law.tension + BENT * law.bend / cell**2, ALONG * slope)


def stiffness_in(flow: Flow, largest: float) -> tuple[float, float]:
    """Pressure of contacts on a skin [Pa], and the shortest side of a cell [m].

    ``largest`` [N/m]: as in Membrane.largest_tension.
    """
    cell = min(flow.spacing[: len(flow.areas)])
    return largest / cell, cell
