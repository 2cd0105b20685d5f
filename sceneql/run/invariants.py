"""Quantities that a script's equations conserve, monitored between frames."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sceneql.kinds import Model
from sceneql.quantities.diagnostic import Diagnostic

if TYPE_CHECKING:
    from sceneql.quantities.span import Span
    from sceneql.run.instant import Instant
    from sceneql.run.run import IslandRun


LOST = 1 / 3
"""Change, relative to the largest terms of the quantity's sum, from which on there is a warning."""


@dataclass
class Invariant:
    """An output of a model that an exact solution would conserve."""

    model: str
    output: str
    span: Span | None
    kind: Model
    times: list[float] = field(default_factory=list)
    drifts: list[float] = field(default_factory=list)
    """Relative change since the start at each time (absolute for a start at 0); the largest of several copies."""
    lost: float = 0.0
    """Largest change relative to the largest terms so far, which works for quantities that start at 0, too."""
    lost_at: float = 0.0
    """Time of that change [s]."""
    _start: Any = None
    _size: Any = 0.0

    def look(self, moment: Instant) -> None:
        """Record its value now."""
        now = np.atleast_1d(moment.read(self.model, self.output))
        if self._start is None:
            self._start = now
        self._size = np.maximum(self._size, self.kind.size_of(self.output, moment.state(self.model)))
        change = (now - self._start) / np.where(self._start == 0.0, 1.0, np.abs(self._start))
        part = np.abs(now - self._start) / np.where(self._size == 0.0, 1.0, self._size)
        if part.max() > self.lost:
            self.lost, self.lost_at = float(part.max()), moment.time
        self.times.append(moment.time)
        self.drifts.append(float(change[np.argmax(np.abs(change))]))

    def warnings(self) -> Iterator[Diagnostic]:
        """At most one warning."""
        if self.lost > LOST:
            most = self.drifts[self.times.index(self.lost_at)]
            message = f"'{self.model}.{self.output}', which is conserved, has changed by {most:.3g} of it"
            message += f" at {self.lost_at:.4g} s"
            help = "the step is too large: see `explain` for its bound"
            yield Diagnostic("invariant-lost", message, self.span, help, severity="warning")

    def account(self) -> str:
        """A line of text."""
        largest = max(self.drifts, key=abs)
        return f"{self.model}: {self.output} drift {self.drifts[-1]:.2e} at the end, {largest:.2e} at most"


def invariants_of(island: IslandRun) -> list[Invariant]:
    """The invariants of all models of an island."""
    kinds = {name: cast(Model, island.graph.tasks[name].kind) for name in island.island.models}
    tasks = island.graph.tasks
    return [
        Invariant(name, output, tasks[name].span, kind) for name, kind in kinds.items() for output in kind.conserves()
    ]
