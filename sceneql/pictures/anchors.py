"""Places of blocks in a picture: at an edge, or over a point of the scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from sceneql.frame import View

Place = Literal["top left", "top", "top right", "left", "center", "right", "bottom left", "bottom", "bottom right"]
Box = tuple[int, int, int, int]
"""Left, top, right, bottom [pixels]."""
EDGES: tuple[Place, ...] = (
    "top left",
    "top",
    "top right",
    "bottom left",
    "bottom",
    "bottom right",
    "left",
    "right",
)
"""Places that words try, best first."""
CORNERS: tuple[Place, ...] = ("bottom left", "bottom right", "top left", "top right", "bottom", "top")
"""Places that panels try, best first."""

MARGIN = 0.025
"""Free space at the edges, relative to the picture's height."""


def corner(place: str, block: tuple[int, int], picture: tuple[int, int]) -> tuple[int, int]:
    """Left and top [pixels] of a block (width, height) at a named place of a picture (width, height)."""
    margin = round(MARGIN * picture[1])
    left, top = (picture[0] - block[0]) // 2, (picture[1] - block[1]) // 2
    left = margin if "left" in place else picture[0] - margin - block[0] if "right" in place else left
    top = margin if "top" in place else picture[1] - margin - block[1] if "bottom" in place else top
    return left, top


def box_at(place: str, block: tuple[int, int], picture: tuple[int, int]) -> Box:
    """Box of a block (width, height) at a named place of a picture (width, height)."""
    left, top = corner(place, block, picture)
    return left, top, left + block[0], top + block[1]


def outline(points: Any, view: View) -> tuple[float, float, float, float] | None:
    """Left, top, right, bottom [pixels] of the points (n, 3) [m] in front of the camera; None if there is none."""
    seen = [place for point in points if (place := projected(point, view)) is not None]
    if not seen:
        return None
    return min(x for x, _ in seen), min(y for _, y in seen), max(x for x, _ in seen), max(y for _, y in seen)


def projected(point: Any, view: View) -> tuple[float, float] | None:
    """Place of a point (3,) [m] in the picture [pixels], from the top left; None behind the camera."""
    import numpy as np

    x, y, z = view.axes @ (np.asarray(point, dtype=float) - np.array(view.origin))
    if z >= 0 and not view.orthographic:
        return None
    scale = 0.5 * view.size[1] / view.half_height / (1.0 if view.orthographic else -z)
    return 0.5 * view.size[0] + scale * x, 0.5 * view.size[1] - scale * y
