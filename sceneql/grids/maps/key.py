"""The color scale of a field, for legends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.quantities.dimension import Dimension


@dataclass(frozen=True, slots=True)
class ColorKey:
    """A color scale: color map, values [SI] at its ends and of contours, the field's name (empty for a formula)."""

    colors: str
    low: float
    high: float
    dimension: Dimension
    marks: tuple[float, ...]
    name: str

    def ramp(self, places: Any) -> Floats:
        """Linear RGB (n, 3) at parameters (n,) from 0 (low end) to 1 (high end)."""
        from sceneql.grids.maps.colors import colored

        return colored(places, (0.0, 1.0), self.colors)
