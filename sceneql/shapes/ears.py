"""Triangulation of a polygon in space by ear clipping (ears_kernels)."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats


def ears(corners: Floats) -> NDArray[int64]:
    """Triangles (n - 2, 3), as rows of ``corners`` (n, 3), that fill a simple, nearly flat polygon."""
    import numpy as np

    from sceneql.shapes.ears_kernels import cut_ears

    following = np.roll(corners, -1, axis=0)
    normal = np.cross(corners, following).sum(axis=0)  # Newell's normal: twice the area vector
    axis = int(np.argmax(np.abs(normal)))
    flat = np.delete(corners, axis, axis=1)
    if (normal[axis] < 0) != (axis == 1):
        flat = flat[:, ::-1]
    count = len(corners)
    found = np.empty((count - 2, 3), dtype=np.int64)
    cut_ears(np.ascontiguousarray(flat), count, np.empty(count, dtype=np.int64), found, 1 << 62)
    return found
