"""History of values that parts of a picture remember, at evenly spaced instants of the physics, not at frames."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

from sceneql.failure import failing_as
from sceneql.kinds import Camera, Object, Value

if TYPE_CHECKING:
    from sceneql.graph import Task
    from sceneql.kinds import Moment
    from sceneql.kinds.moment import Remembered

SLACK = 1e-9
MOST, SHORTEST = 20_000, 1e-12
"""Largest number of instants that are kept of a value, and their least distance [s]; a finer request is coarsened."""


class History:
    """The values that objects and cameras among ``tasks`` ask for by `remembers`, kept as far back as asked."""

    def __init__(self, tasks: Iterable[Task]) -> None:
        asked = [
            (task, one) for task in tasks if isinstance(task.kind, Object | Camera) for one in task.kind.remembers()
        ]
        self._kept: dict[int, tuple[Remembered, float, float, deque[tuple[float, Any]]]] = {
            id(value): (value, keep, max(every, min(keep, 1e300) / MOST, SHORTEST), deque())
            for _, (value, keep, every) in asked
        }
        self._of = {id(value): task for task, (value, _, _) in asked}
        self._seen = dict.fromkeys(self._kept, -1)

    def due(self, time: float) -> Iterator[tuple[float, list[int]]]:
        """Instants [s] after the previous call, up to ``time``, at which values are due, with these values' keys."""
        wanted: dict[float, list[int]] = {}
        for key, (_, keep, every, _) in self._kept.items():
            first = max(self._seen[key] + 1, math.ceil((time - keep) / every - SLACK))
            last = max(math.floor(time / every - SLACK), 0 if time > 0.0 else -1)  # the start is due in any case
            for k in range(first, last + 1):
                wanted.setdefault(k * every, []).append(key)
            self._seen[key] = max(last, self._seen[key])
        yield from sorted(wanted.items())

    def see(self, moment: Moment, keys: Iterable[int]) -> None:
        """Record the values of some keys at an instant. Raises RunFailure where a value is undefined then."""
        for key in keys:
            value, keep, every, kept = self._kept[key]
            task = self._of[key]
            with failing_as(task.name, moment.time, value.span if isinstance(value, Value) else task.span):
                kept.append((moment.time, moment.at(value) if isinstance(value, Value) else value.at(moment)))
            while kept[0][0] < moment.time - keep - every:
                kept.popleft()

    def past(self, value: Remembered, now: float) -> list[tuple[float, Any]]:
        """(time [s], value) at the remembered instants up to ``now``, oldest first, for a value that was asked for."""
        _, keep, _, kept = self._kept[id(value)]
        return [(time, seen) for time, seen in kept if now - keep - SLACK <= time <= now]
