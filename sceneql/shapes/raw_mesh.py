"""Triangles as read from a mesh file, with vertex colors in linear light."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from numpy import float32
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints


class RawMesh(NamedTuple):
    """Triangles of a file, not yet shaded."""

    vertices: Floats
    """(n, 3) [m]."""
    triangles: Ints
    """(m, 3)."""
    colors: NDArray[float32] | None
    """(n, 3) linear RGB of the vertices, or None."""


def linear(shown: NDArray[float32]) -> NDArray[float32]:
    """Linear light of sRGB from 0 to 1 (IEC 61966-2-1)."""
    import numpy as np

    found: NDArray[float32] = np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    return found
