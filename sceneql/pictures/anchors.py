"""Where blocks stand in a picture: at an edge, or over a point of the scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from sceneql.frame import View

Place = Literal["top left", "top", "top right", "left", "right", "bottom left", "bottom", "bottom right"]


MARGIN = 0.025
"""Free space at the edges in parts of the picture's height."""


def corner(place: str, block: tuple[int, int], picture: tuple[int, int]) -> tuple[int, int]:
    """Left and top [pixels] of a block (width, height) at a named place of a picture (width, height)."""
    margin = round(MARGIN * picture[1])
    left, top = (picture[0] - block[0]) // 2, (picture[1] - block[1]) // 2
    left = margin if "left" in place else picture[0] - margin - block[0] if "right" in place else left
    top = margin if "top" in place else picture[1] - margin - block[1] if "bottom" in place else top
    return left, top


def projected(point: Any, view: View) -> tuple[float, float] | None:
    """Where a point (3,) is seen [pixels], from the top left; None behind the camera."""
    import numpy as np

    x, y, z = view.axes @ (np.asarray(point, dtype=float) - np.array(view.origin))
    if z >= 0 and not view.orthographic:
        return None
    scale = 0.5 * view.size[1] / view.half_height / (1.0 if view.orthographic else -z)
    return 0.5 * view.size[0] + scale * x, 0.5 * view.size[1] - scale * y
