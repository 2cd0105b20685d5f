"""Start of the rays of an orthographic picture: in front of all shapes, but no farther away than necessary.

Rounding errors grow with the distance to a surface: from 10 km away, lines and balls of 0.1 mm look rough.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.frame import Floats, View

FARTHEST = 1e4
"""Largest distance of the rays' start in front of the window, in half heights of it or in metres if that is more."""
STEEP = 0.008
"""Sine of the angle to an endless floor below which it is invisible: a fifth of the sine at which it starts to fade."""


def window(view: View, bounds: Floats, floors: Sequence[Floats], endless: int) -> Floats:
    """Center (3,) [m] of an orthographic view's window, moved along the view to a place in front of all shapes.

    ``bounds`` (0 or 1, 6) [m]: low and high corner of all bounded items; ``endless``: number of the other items;
    ``floors``: half-spaces among these, (1, 4) each, unit normal and height of the face.
    """
    origin, (right, up, back) = np.array(view.origin, dtype=np.float64), np.asarray(view.axes, dtype=np.float64)
    farthest = FARTHEST * max(1.0, view.half_height)
    fronts = [float(np.maximum(back * box[:3], back * box[3:]).sum() - back @ origin) for box in bounds]
    half = 1.1 * view.half_height  # rays of pixels at the rim start a little outside
    sides = np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]]) * [half * view.size[0] / view.size[1], half]
    corners = origin + sides @ np.array([right, up])
    for floor in floors:
        slope = float(floor[0, :3] @ back)
        if abs(slope) > STEEP:
            fronts.append(float(((floor[0, 3] - corners @ floor[0, :3]) / slope).max()))
    if endless > len(floors):
        fronts.append(farthest)
    moved: Floats = origin + min(max(fronts, default=0.0) + view.half_height, farthest) * back
    return moved
