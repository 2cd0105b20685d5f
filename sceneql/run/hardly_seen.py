"""Detection of what moves and is small in the picture of a default camera."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from sceneql.quantities.diagnostic import Diagnostic

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.graph import SimulationGraph
    from sceneql.run.dry_run import DryRun

SMALL = 0.03
"""Size of all that moves, relative to that of the picture, below which it is hardly seen: some 10 pixels of 540."""
WINDOW = 1 / 8
"""Window of a camera that goes along, relative to the film, in what is proposed."""


def hardly_seen(seen: DryRun, graph: SimulationGraph, window: float) -> Iterator[Diagnostic]:
    """At most one warning: where the median over the film of the size of all that moves is SMALL.

    A size is the largest side of a box; it is relative to that of all that a camera shows within a window [s].
    """
    rows = [(time, points) for time, points in seen.moving if len(points)]
    boxes = {name: box for name, box in (seen.bounds or {}).items() if name in graph.tasks}
    if not rows or not boxes:
        return
    still = [corner for name, box in boxes.items() if name not in seen.changing for corner in box]
    sizes = [_side(points) for _, points in rows]
    shown = [
        _side(
            np.concatenate(
                [*(some for then, some in rows if abs(then - time) <= 0.5 * window), *map(np.atleast_2d, still)]
            )
        )
        for time, _ in rows
    ]
    all_that_stays = seen.staying or np.array(list(boxes.values())).reshape(-1, 3)
    whole = min(float(np.median(shown)), _side(np.array(all_that_stays)))
    part = float(np.median(sizes)) / whole if whole > 0 else 1.0
    if part < SMALL:
        names = ", ".join(f"'{name}'" for name in seen.changing[:3])
        text = f"what moves ({names}) is {100 * part:.1g} % as large as its surroundings and its way: it is hardly seen"
        proposed = f"{float(f'{graph.settings.clock.end * WINDOW:.1g}'):g} s"
        help = f"`cameras: {{near: {{auto: {{window: {proposed}}}}}}}` goes along with it; a `trail` shows it from afar"
        yield Diagnostic("hardly-seen", text, graph.tasks[seen.changing[0]].span, help, severity="warning")


def _side(points: Floats) -> float:
    """The largest side [m] of the box around points (n, 3)."""
    return float(np.ptp(points, axis=0).max())
