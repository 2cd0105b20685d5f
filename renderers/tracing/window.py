"""Where the rays of an orthographic picture begin: before all that is drawn, and no farther off than that takes.

Rounding grows with the way to a surface: of rays from 10 km off, lines and balls of a tenth of a millimetre are rough.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.frame import Floats, View

FARTHEST = 1e4
"""Heights of the window, at least metres, from which on before it nothing is seen."""
STEEP = 0.008
"""Sine of the angle to an endless floor below which nothing of it is seen: a fifth of that from which on it fades."""


def window(view: View, bounds: Floats, floors: Sequence[Floats], endless: int) -> Floats:
    """(3,) the middle of an orthographic view's window [m], moved along the view to before all that is drawn.

    ``bounds`` (0 or 1, 6) are low and high corner of what has bounds; of the ``endless`` others ``floors`` (1, 4) are
    half-spaces, by their unit normals and the heights of their faces.
    """
    origin, (right, up, back) = np.array(view.origin, dtype=np.float64), np.asarray(view.axes, dtype=np.float64)
    farthest = FARTHEST * max(1.0, view.half_height)
    fronts = [float(np.maximum(back * box[:3], back * box[3:]).sum() - back @ origin) for box in bounds]
    half = 1.1 * view.half_height  # rays of pixels at the rim are a little off it
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
