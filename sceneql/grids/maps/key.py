"""The color scale of a field, for legends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.quantities.dimension import Dimension


@dataclass(frozen=True, slots=True)
class ColorKey:
    """A map of colors, the values at its ends and those of its contours, in SI; what it shows, empty for a formula."""

    colors: str
    low: float
    high: float
    dimension: Dimension
    marks: tuple[float, ...]
    name: str

    def ramp(self, places: Any) -> Floats:
        """Linear RGB (n, 3) at places (n,) from 0 to 1."""
        from sceneql.grids.maps.colors import colored

        return colored(places, (0.0, 1.0), self.colors)
