"""Monitor of fields that leave the range in which an exact solution stays, by an error of the solver."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

from sceneql.quantities.diagnostic import Diagnostic

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.kinds import Model
    from sceneql.run.run import IslandRun
    from sceneql.system import Grid

BEYOND = 0.01
"""Excess beyond the range, relative to its width, from which on there is a warning."""


@dataclass
class Extremes:
    """The excess of a field beyond the range in which it should stay."""

    model: str
    output: str
    grid: Grid
    beyond: float = 0.0
    """Largest excess so far; 0 below the threshold of a warning."""
    value: float = 0.0
    time: float = 0.0

    def look(self, time: float, y: Floats) -> None:
        """Record the extremes of the field in a state."""
        low, high = self.grid.keeps
        field = y[self.grid.at : self.grid.at + len(self.grid.cells.outside)][~self.grid.cells.outside]
        least, largest = float(field.min(initial=math.inf)), float(field.max(initial=-math.inf))
        way = high - low if high > low and math.isfinite(high - low) else max(abs(least), abs(largest))
        for value, beyond in ((least, low - least), (largest, largest - high)):
            if beyond > max(self.beyond, BEYOND * way):
                self.beyond, self.value, self.time = beyond, value, time

    def warnings(self, island: IslandRun) -> Iterator[Diagnostic]:
        """At most one warning."""
        if self.beyond == 0.0:
            return
        low, high = self.grid.keeps
        model = cast("Model", island.graph.tasks[self.model].kind)
        name = self.model if model.field_count() == 1 else f"{self.model}.{self.output}"
        span = island.graph.tasks[self.model].span
        if math.isinf(high):
            text = f"'{name}' has fallen to {self.value:.3g} at {self.time:.4g} s, and nothing can be less than none"
            help = "let what takes it away be less where less is there, as a formula of c, or take shorter steps"
        else:
            text = f"'{name}' has come to {self.value:.3g} at {self.time:.4g} s"
            text += f", but all that it began with or is given lies from {low:.3g} to {high:.3g}"
            help = "the solver's error: take shorter steps, tr_bdf2, or a drift with a limiter"
        yield Diagnostic("overshoot", text, span, help, severity="warning")


def watched(island: IslandRun) -> list[Extremes]:
    """The fields of an island that have a range to keep, each by its first name; none where forces act on it."""
    if island.island.forces:
        return []
    found: dict[int, Extremes] = {}
    for names, grid in island.assembly.fields.items():
        if any(map(math.isfinite, grid.keeps)):
            found.setdefault(grid.at, Extremes(*names, grid))
    return list(found.values())
