"""Monitor of time-varying colors: no surface reflects more light than falls on it, or less than none."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sceneql.failure import failing_as
from sceneql.kinds import Paint, Record, Value, grammar_of, written_name
from sceneql.quantities.diagnostic import Diagnostic

if TYPE_CHECKING:
    from sceneql.graph import SimulationGraph
    from sceneql.kinds import Moment

ROUNDING = 1e-6
"""Tolerance beyond 0 and 1 of a component, for rounding: a small part of a level of 8 bits."""
NAMES = ("red", "green", "blue")


@dataclass
class Painted:
    """A color that varies in time, and when and how it first left the range."""

    part: str
    field: str
    value: Value
    left: tuple[float, str, float] | None = None
    """Time [s], component and its value."""

    def look(self, moment: Moment) -> None:
        """Record the component that is farthest out now, unless one was before."""
        if self.left is None:
            with failing_as(self.part, moment.time, self.value.span):
                color = [float(c) for c in moment.at(self.value)]
            beyond, name, c = max((max(c - 1.0, -c), name, c) for name, c in zip(NAMES, color, strict=True))
            if beyond > ROUNDING:
                self.left = moment.time, name, c

    def warnings(self) -> Iterator[Diagnostic]:
        """The warning for a color that left the range."""
        if self.left is not None:
            time, name, c = self.left
            text = f"the {self.field} of '{self.part}' leaves the numbers from 0 to 1: at {time:.3g} s its {name} is"
            text += f" {c:.3g}, drawn as {'1' if c > 1 else '0'}"
            help = "write `clamp(..., 0, 1)` around it; what shall shine has the material `glow`, a light its `power`"
            yield Diagnostic("color-range", text, self.value.span, help, severity="warning")


def painted(graph: SimulationGraph) -> list[Painted]:
    """The colors of a script's parts, and of its background, that vary in time."""
    found = [one for name, task in graph.tasks.items() for one in _below(name, task.kind)]
    background = graph.settings.background
    if background is not None and not background.constant:
        found.append(Painted("background", "color", background))
    return found


def _below(part: str, kind: Any) -> Iterator[Painted]:
    if isinstance(kind, Record) and not kind.own_time:
        for name, info in type(kind).model_fields.items():
            value = getattr(kind, name)
            if not isinstance(value, Value):
                yield from _below(part, value)
            elif not value.constant and isinstance(grammar_of(info)[0], Paint):
                yield Painted(part, written_name(name), value)
    elif isinstance(kind, dict | list | tuple):
        for item in kind.values() if isinstance(kind, dict) else kind:
            yield from _below(part, item)
