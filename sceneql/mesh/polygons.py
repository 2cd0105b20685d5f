"""The triangle mesh that polygonization returns, and which of its triangles touch given vertices."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints


@dataclass(frozen=True, slots=True, eq=False)
class Polygons:
    """Triangles of a solid's surface, counterclockwise seen from outside."""

    vertices: Floats
    """(n, 3) [m]."""
    triangles: Ints
    """(m, 3)."""
    normals: Floats
    """(n, 3) unit gradients, pointing outward; zero where the field has none, and on edges and corners kept sharp."""
    unfolded: bool = False
    """Whether it is known that none of its triangles is `folds.overturned`, of the tape that it was made from."""


def touched(chosen: NDArray[np.bool_], corners: NDArray[np.integer]) -> NDArray[np.bool_]:
    """(t,) whether one of the vertices of polygons (t, n) is among those of the mask ``chosen`` (v,)."""
    found: NDArray[np.bool_] = chosen[corners[:, 0]]
    for k in range(1, corners.shape[1]):  # ``any`` along a short axis takes several times as long
        found |= chosen[corners[:, k]]
    return found
