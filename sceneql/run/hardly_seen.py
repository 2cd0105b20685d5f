"""Detection of what moves and is small in the picture of a default camera that holds still and shows the whole way."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from sceneql.quantities.diagnostic import Diagnostic

if TYPE_CHECKING:
    from sceneql.graph import SimulationGraph
    from sceneql.run.dry_run import DryRun

SMALL = 0.03
"""Size of all that moves, relative to that of the picture, below which it is hardly seen: some 10 pixels of 540."""
WINDOW = 1 / 8
"""Window of a camera that goes along, relative to the film, in what is proposed."""


def hardly_seen(seen: DryRun, graph: SimulationGraph) -> Iterator[Diagnostic]:
    """At most one warning: where the median over the film of the size of all that moves is SMALL.

    A size is the largest side of a box.
    """
    sizes = [float(np.ptp(points, axis=0).max()) for _, points in seen.moving if len(points)]
    boxes = (
        [seen.staying]
        if seen.staying is not None
        else [box for name, box in (seen.bounds or {}).items() if name in graph.tasks]
    )
    if not sizes or not boxes:
        return
    lows, highs = np.array([low for low, _ in boxes]), np.array([high for _, high in boxes])
    whole = float((highs.max(axis=0) - lows.min(axis=0)).max())
    part = float(np.median(sizes)) / whole if whole > 0 else 1.0
    if part < SMALL:
        names = ", ".join(f"'{name}'" for name in seen.changing[:3])
        text = f"what moves ({names}) is {100 * part:.1g} % as large as its surroundings and its way: it is hardly seen"
        window = f"{float(f'{graph.settings.clock.end * WINDOW:.1g}'):g} s"
        help = f"`cameras: {{near: {{auto: {{window: {window}}}}}}}` goes along with it; a `trail` shows it from afar"
        yield Diagnostic("hardly-seen", text, graph.tasks[seen.changing[0]].span, help, severity="warning")
