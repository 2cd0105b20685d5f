"""Working memory of the tracer's kernels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing import layout
from sceneql.field.tape.tape_ops import SCRATCH_COLUMNS

if TYPE_CHECKING:
    from renderers.tracing.scene_kernels import Scene
    from renderers.tracing.solids.bundles import Packets
    from sceneql.frame import Floats


def scratch(rows: int) -> Floats:
    """Working memory of one thread for kernels on a scene."""
    return np.zeros((rows, SCRATCH_COLUMNS))


def scratch_beside(packets: Packets | None, scene: Scene, rows: int) -> Floats:
    """The same beside packets: the rows of the shapes hold no crossings yet, and those that packets know their items."""
    out = scratch(rows)
    out[-1 - int(scene.ints[layout.SHAPE_COUNT]) : -1, 0] = np.nan
    if packets is not None:
        count = int(scene.ints[layout.ITEM_COUNT])
        items = scene.ints[layout.ITEMS : layout.ITEMS + 4 * count].reshape(count, 4)
        for item in np.flatnonzero(items[:, layout.KIND] == layout.IMPLICIT):
            out[-2 - items[item, layout.SHAPE], layout.ITEM_OF] = item
    return out
