"""Checks, in every frame, of time-varying values of models, forces, contacts and solvers that have a range."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import BaseModel

from sceneql.failure import RunFailure
from sceneql.kinds import LIMITS, Value, written_name

if TYPE_CHECKING:
    from sceneql.graph import Island, SimulationGraph
    from sceneql.kinds import Moment


@dataclass(frozen=True, slots=True)
class Ranged:
    """A varying value in a part's field, and its bounds by their names (``at_least``)."""

    part: str
    field: str
    value: Value
    limits: dict[str, float]

    def check(self, moment: Moment) -> None:
        """Raise RunFailure at the value's line where it is out of its range now. It may equal an open bound.

        (A spring whose stiffness falls to 0 is switched off.)
        """
        for limit, bound in self.limits.items():
            holds, word = LIMITS[limit]
            for now in np.ravel(moment.at(self.value)).tolist():
                if now != bound and not holds(now, bound):
                    message = f"{self.field} must be {word} {bound:g}, but is {now:g} now"
                    raise RunFailure(message, part=self.part, time=moment.time, span=self.value.span)


def ranged(graph: SimulationGraph, islands: Iterable[Island]) -> tuple[Ranged, ...]:
    """The varying values with a range in the models, forces, contacts and solvers of islands."""
    names: dict[str, None] = {}
    for island in islands:
        acting = [name for name, _ in island.forces] + [name for name, *_ in island.contacts]
        names |= dict.fromkeys([*island.models, *acting, island.solver])
    return tuple(one for name in names for one in _below(name, graph.tasks[name].kind))


def _below(part: str, kind: Any) -> Iterator[Ranged]:
    if isinstance(kind, BaseModel):
        for name, info in type(kind).model_fields.items():
            value, extra = getattr(kind, name), info.json_schema_extra
            limits = extra.get("limits") if isinstance(extra, dict) else None
            if isinstance(value, Value) and not value.constant and isinstance(limits, dict) and limits:
                yield Ranged(part, written_name(name), value, {key: float(str(one)) for key, one in limits.items()})
            else:
                yield from _below(part, value)
    elif isinstance(kind, dict | list | tuple):
        for item in kind.values() if isinstance(kind, dict) else kind:
            yield from _below(part, item)
