"""Working memory of the tracer's kernels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing import layout
from sceneql.field.tape.tape_ops import SCRATCH_COLUMNS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from renderers.tracing.scene_kernels import Scene
    from sceneql.frame import Floats


def scratch(rows: int) -> Floats:
    """Working memory (rows, SCRATCH_COLUMNS) of one thread for kernels on a scene."""
    return np.zeros((rows, SCRATCH_COLUMNS))


def begun(memory: Floats) -> Floats:
    """Working memory as a thread begins a piece of work that does not depend on the number of threads: nothing LOST."""
    memory[:, layout.LOST] = 0.0
    return memory


def given_up(memory: Floats, shapes: int) -> int:
    """How many rays at so many shapes were not searched since ``begun``, after MOST_LOST had been LOST at the same."""
    lost = memory[-1 - shapes : -1, layout.LOST]
    if not lost.size or lost.max() <= layout.MOST_LOST:  # as good as always
        return 0
    return int((lost - layout.MOST_LOST).clip(min=0.0).sum())


def patient(memory: Floats) -> Floats:
    """Working memory with which no ray is given up: each undecided one has been searched."""
    memory[:, layout.LOST] = -np.inf
    return memory


def asked_rays(rays: int, solids: Sequence[int] = ()) -> Floats:
    """Empty list of rays (1 + rays, columns), for packets that know ``solids``; see scene_kernels.ASKED."""
    out = np.empty((1 + rays, layout.ANSWERS + len(solids)))
    out[0, : layout.ANSWERS], out[0, layout.ANSWERS :] = 0.0, solids
    return out


def scratch_beside(asked: Floats, scene: Scene, rows: int) -> Floats:
    """Working memory of one thread with a list of rays for packets.

    Rows of the shapes that packets intersect get the shapes' items, and no crossings yet. Writes to ``asked`` whether
    packets cover the whole scene, and that its rays hit nothing else.
    """
    out = scratch(rows)
    out[-1 - int(scene.ints[layout.SHAPE_COUNT]) : -1, 0] = np.nan
    if asked.shape[1] > layout.ANSWERS:
        count = int(scene.ints[layout.ITEM_COUNT])
        items = scene.ints[layout.ITEMS : layout.ITEMS + 4 * count].reshape(count, 4)
        known = np.flatnonzero(items[:, layout.KIND] == layout.IMPLICIT)
        out[-2 - items[known, layout.SHAPE], layout.ITEM_OF] = known
        asked[0, layout.ALONE] = len(known) == count
        asked[1:, [layout.REST_AT, layout.REST_ITEM, layout.REST_LIGHT]] = np.inf, -1.0, 1.0
    return out
