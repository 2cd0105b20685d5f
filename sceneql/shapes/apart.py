"""Objects that stand apart from one another, measured each by itself."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from sceneql.kinds import VolumeMoments

if TYPE_CHECKING:
    from sceneql.kinds import Moment, Shaped

TOUCHING = 1e-12
"""By how much of their size boxes may overlap that touch but for rounding."""
MANY = 1000
"""Members above which pairs are not looked at."""


def apart(
    members: Sequence[Shaped], moment: Moment, measure: Callable[[Shaped], VolumeMoments]
) -> VolumeMoments | None:
    """The moments of all members together; None where boxes of two overlap, or one has no end, or one is empty."""
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
