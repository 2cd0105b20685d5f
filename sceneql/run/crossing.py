"""Monitor of rigid bodies that a contact lets into one another."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.quantities.diagnostic import Diagnostic

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.quantities.span import Span
    from sceneql.run.instant import Instant
    from sceneql.run.run import IslandRun

DEEP = 1e-3
"""Depth, as a part of the smaller body's reach, from which on there is a warning; a step leaves 1e-7 where it is solved
(rigid_local_kernels)."""


@dataclass
class Crossing:
    """The deepest overlap of an island's rigid bodies so far."""

    island: IslandRun
    part: float = 0.0
    """As a part of the smaller body's reach."""
    text: str = ""
    span: Span | None = None
    cost: float = 0.0
    """Seconds that the last look took."""

    def look(self, moment: Instant) -> None:
        """Measure all contacts of the island at a moment."""
        started = time.perf_counter()
        tasks = self.island.graph.tasks
        for overlaps in self.island.assembly.overlaps:
            led = [_place(tasks[overlaps.refs[k].name].kind, moment) for k in overlaps.led]
            found = overlaps.deepest(self.island.y, self.island.march.floats, led)
            if found is not None and found.part > self.part:
                one, other = (overlaps.refs[k].name for k in found.pair)
                self.part, self.span = found.part, overlaps.span
                self.text = f"'{one}' was {found.depth:.2g} m inside '{other}' at {moment.now:.4g} s"
        self.cost = time.perf_counter() - started

    def warnings(self) -> list[Diagnostic]:
        """A warning where bodies were deep in one another."""
        if self.part <= DEEP:
            return []
        help = "take shorter steps, or `mode: exact`; what leads or presses one into the other must leave it room"
        return [Diagnostic("bodies-cross", self.text, self.span, help, severity="warning")]


def _place(kind: Any, moment: Instant) -> Floats:
    """Position and quaternion (7,) of an object now."""
    return np.concatenate([moment.at(kind.position), moment.at(kind.rotation)])
