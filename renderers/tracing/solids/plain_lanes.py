"""Choice of SIMD lanes to intersect listed rays with the half-spaces and quadrics of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing import layout

if TYPE_CHECKING:
    from renderers.tracing.scene_kernels import Scene
    from sceneql.frame import Floats

KINDS = (layout.HALF_SPACE, layout.QUADRIC)
MOST = 8
"""Largest number of items: each is tested against all rays, without a hierarchy."""


def lanes_for(scene: Scene, packets: bool) -> Floats | None:
    """Working memory for ``meet_plain``; None unless all items are of KINDS, or implicit ones of ``packets``.

    There must be 1 to MOST items of KINDS.
    """
    kinds = scene.ints[layout.ITEMS + layout.KIND :][: 4 * int(scene.ints[layout.ITEM_COUNT]) : 4]
    plain = np.isin(kinds, KINDS)
    others = kinds[~plain]
    if not 0 < plain.sum() <= MOST or (others != layout.IMPLICIT).any() or (len(others) > 0 and not packets):
        return None
    from renderers.tracing.solids.plain_lanes_kernels import ROOM

    return np.zeros(ROOM)
