"""Detection of variants that diverge: panels that share one framing leave them out, so that the others stay large."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sceneql.kinds import Interaction, Kind, Model, Object
from sceneql.kinds.values import Checked
from sceneql.quantities.diagnostic import Diagnostic
from sceneql.quantities.span import Span

if TYPE_CHECKING:
    from sceneql.graph import SimulationGraph
    from sceneql.run.framed import Framed

BURST = 100.0
"""Size ratio to the smallest variant from which on a variant counts as burst: the common framing leaves it out."""
DIVERGED = 3.0
"""The same of a variant that differs from the smallest in what solves it alone. Both start alike and obey the same
laws, so one of them is wrong, and what grows is what a solver that is unstable makes."""


@dataclass(frozen=True, slots=True)
class Diverged:
    """A variant that the common framing leaves out though it differs in its solver alone."""

    graph: SimulationGraph
    beside: SimulationGraph
    """The smallest variant."""
    ratio: float
    """By how much it is larger."""
    time: float
    """Instant from which on it is outside of the framing [s]."""

    @property
    def burst(self) -> bool:
        """Whether it leaves its panel; else the panel's camera goes back, so that it stays in the picture."""
        return self.ratio > BURST

    def said(self) -> str:
        """What is written on its panel from then on."""
        does = "it leaves the picture" if self.burst else "seen from farther away"
        return f"from {self.time:.3g} s on {does}: {self.ratio:.2g} times as large"

    def warning(self) -> Diagnostic:
        """What is told of it."""
        solvers = [task for task in self.graph.tasks.values() if task.family == "solvers" and task.span is not None]
        name, other = (graph.variants.this or graph.name for graph in (self.graph, self.beside))
        does = "leaves its panel" if self.burst else "is seen from farther away"
        text = f"'{name}' {does}, from {self.time:.3g} s on: it grows {self.ratio:.2g} times as large as"
        text += f" '{other}', which differs in its solver alone"
        help = "take shorter steps or a stable solver, end the `clock` before, or write a camera that shows all"
        return Diagnostic("diverges", text, solvers[0].span if solvers else None, help, severity="warning")


def together(runs: Sequence[Framed]) -> tuple[list[Framed], list[Diverged]]:
    """The runs that one framing shows, in order, and those left out though they differ in their solver alone."""
    if len(runs) < 2:
        return list(runs), []
    boxes = [(run, np.array(box)) for run in runs if (box := run.bounds(())) is not None]
    sizes = [float(np.linalg.norm(box[1] - box[0])) for _, box in boxes]
    if not min(sizes, default=0.0) > 0.0:
        return [run for run, _ in boxes], []
    smallest = int(np.argmin(sizes))
    graph = boxes[smallest][0].graph
    ratios = [size / sizes[smallest] for size in sizes]
    alone = [
        ratio > DIVERGED and solved_otherwise(run.graph, graph) for (run, _), ratio in zip(boxes, ratios, strict=True)
    ]
    kept = [box for box, ratio, out in zip(boxes, ratios, alone, strict=True) if ratio <= BURST and not out]
    low, high = np.min([box[0] for _, box in kept], axis=0), np.max([box[1] for _, box in kept], axis=0)
    found = []
    for (run, _), ratio, out in zip(boxes, ratios, alone, strict=True):
        if out:
            rows = run.moving(math.inf)
            beyond = ((rows[:, 1:] < low) | (rows[:, 1:] > high)).any(axis=1)
            found.append(Diverged(run.graph, graph, ratio, float(rows[beyond, 0].min(initial=np.inf))))
    return [run for run, _ in kept], found


def solved_otherwise(one: SimulationGraph, other: SimulationGraph) -> bool:
    """Whether two graphs have the same models, forces, contacts, ties and objects."""
    kinds = Model, Interaction, Object
    first, second = ({n: t.kind for n, t in graph.tasks.items() if isinstance(t.kind, kinds)} for graph in (one, other))
    return _alike(first, second)


def _alike(one: Any, other: Any) -> bool:
    """Whether two fields of parts have the same values, wherever they are written; False where that is not known."""
    if type(one) is not type(other):
        return False
    if one is other or isinstance(one, Span):
        return True
    if isinstance(one, Kind):
        return _alike(dict(one), dict(other))
    if isinstance(one, Checked):
        compared = [each.name for each in fields(cast(Any, one)) if each.compare]
        return all(_alike(getattr(one, name), getattr(other, name)) for name in compared)
    if isinstance(one, Mapping):
        return one.keys() == other.keys() and all(_alike(value, other[key]) for key, value in one.items())
    if isinstance(one, list | tuple):
        return len(one) == len(other) and all(map(_alike, one, other))
    try:
        return bool(one == other)
    except ValueError:  # arrays
        return False
