"""What equations of a script say is conserved, looked at between frames."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sceneql.kinds import Model
from sceneql.quantities.diagnostic import Diagnostic

if TYPE_CHECKING:
    from sceneql.quantities.span import Span
    from sceneql.simulation.run import Instant, IslandRun


LOST = 0.5
"""Change, as a part of what it was at the start, that is warned of."""


@dataclass
class Invariant:
    """One output of a model that an exact solution would keep."""

    model: str
    output: str
    span: Span | None
    times: list[float] = field(default_factory=list)
    drifts: list[float] = field(default_factory=list)
    """Change since the start at each time, in parts of what it was (of 1 where that is 0); of copies the largest."""
    _start: Any = None

    def look(self, moment: Instant) -> None:
        """Note its value now."""
        now = np.atleast_1d(moment.read(self.model, self.output))
        if self._start is None:
            self._start = now
        change = (now - self._start) / np.where(self._start == 0.0, 1.0, np.abs(self._start))
        self.times.append(moment.time)
        self.drifts.append(float(change[np.argmax(np.abs(change))]))

    def warnings(self) -> Iterator[Diagnostic]:
        """At most one; none of what began with 0, which says nothing of its size."""
        most = max(self.drifts, key=abs, default=0.0)
        if abs(most) > LOST and np.all(self._start != 0.0):
            at = self.times[self.drifts.index(most)]
            message = f"'{self.model}.{self.output}', which is conserved, has changed by {most:.3g} of it at {at:.4g} s"
            help = "the step is too large: see `explain` for its bound"
            yield Diagnostic("invariant-lost", message, self.span, help, severity="warning")

    def account(self) -> str:
        """A line for people."""
        largest = max(self.drifts, key=abs)
        return f"{self.model}: {self.output} drift {self.drifts[-1]:.2e} at the end, {largest:.2e} at most"


def invariants_of(island: IslandRun) -> list[Invariant]:
    """Those of all models of an island."""
    kinds = {name: cast(Model, island.graph.tasks[name].kind) for name in island.island.models}
    tasks = island.graph.tasks
    return [Invariant(name, output, tasks[name].span) for name, kind in kinds.items() for output in kind.conserves()]
