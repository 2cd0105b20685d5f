"""The way out of what a body starts in, for messages."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.frame import Floats

ROUNDS = 4


def help_out(name: str, gap: Callable[[Floats], float]) -> str:
    """What to write of a body that starts inside another: how far to move it, where that is clear.

    ``gap``: between both [m] by how far (3,) it is moved [m]. Components have three digits, rounded away from 0.
    """
    import numpy as np

    way: Floats = np.zeros(3)
    for _ in range(ROUNDS):
        depth = -gap(way)
        step = 0.01 * depth
        if depth <= 0.0:
            break
        slope = np.array([(gap(way + step * axis) - gap(way - step * axis)) / (2.0 * step) for axis in np.eye(3)])
        if not 0.5 < np.linalg.norm(slope) < 2.0:
            break
        way = way + 1.001 * depth * slope / (slope @ slope)
        unit = 10.0 ** (np.floor(np.log10(np.abs(way).max())) - 2.0)
        way = np.sign(way) * unit * np.ceil(np.round(np.abs(way) / unit, 6) - 0.01) + 0.0
    if not way.any() or gap(way) < 0.0:
        return "move one of them away"
    return f"move '{name}' by {way[0]:.3g} {way[1]:.3g} {way[2]:.3g} m"
