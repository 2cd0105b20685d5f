"""How skins pull, in numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.system import Flow


@dataclass(frozen=True, slots=True)
class Elasticity:
    """What a skin resists with; none of it is 0 or more of it."""

    tension: float = 0.0
    """The same always [N/m]."""
    stretch: float = 0.0
    """Tension of springs for a relative stretch [N/m]."""
    modulus: float = 0.0
    """Shear modulus of a neo-Hookean sheet, over its thickness [N/m]."""
    shear: float = 0.0
    """That of Skalak's law [N/m]."""
    area: float = 0.0
    """How much it resists a change of area, in parts of that."""
    bend: float = 0.0
    """Stiffness against bending [J]."""


def stiffness_in(flow: Flow, largest: float) -> tuple[float, float]:
    """The pressure by which contacts push a skin off [Pa], and the side of a cell [m];
    ``largest``: of Membrane.largest_tension [N/m]."""
    cell = min(flow.spacing[: len(flow.areas)])
    return largest / cell, cell
