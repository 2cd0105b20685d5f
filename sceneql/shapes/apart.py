"""Moments of objects that do not overlap: each object measured by itself, the moments added."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from sceneql.kinds import VolumeMoments

if TYPE_CHECKING:
    from sceneql.kinds import Moment, Shaped

TOUCHING = 1e-12
"""Overlap of two boxes that still counts as rounding of touching boxes, relative to the largest coordinate."""
MANY = 1000
"""Most members whose pairs of boxes are compared."""


def apart(
    members: Sequence[Shaped], moment: Moment, measure: Callable[[Shaped], VolumeMoments]
) -> VolumeMoments | None:
    """Moments of the union of the members, as the sum of each member's ``measure``.

    None where the boxes of two members overlap, where a box is infinite or empty, and for no member or more than MANY.
    """
    import numpy as np

    if not 0 < len(members) <= MANY:
        return None
    boxes = np.array([member.extent(np.eye(3, 4), moment) for member in members])
    low, high = boxes[:, 0], boxes[:, 1]
    if not (np.isfinite(boxes).all() and (high > low).all()):
        return None
    room = TOUCHING * np.maximum(np.abs(low), np.abs(high)).max()
    beside = (high[:, None] <= low[None, :] + room).any(axis=2)
    free = beside | beside.T | np.eye(len(members), dtype=bool)
    return VolumeMoments.joined([measure(member) for member in members]) if free.all() else None
