"""Check of models that fill an object, by the object's box at the start: too many particles, or too coarse."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from typing import Any

from sceneql.failure import RunFailure
from sceneql.graph import Task
from sceneql.kinds import Exceeds, Model, Object, Ref, TooCoarse, Value
from sceneql.quantities.diagnostic import Diagnostics, ScriptError
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Link, Symbol


class Beginning:
    """The part of kinds.Moment that an object's extent needs, at the start and from the script alone."""

    time = 0.0

    def __init__(self, tasks: Mapping[str, Task]) -> None:
        self._tasks = tasks
        self._known: dict[Link, Any] = {}
        self._kept: dict[tuple[str, Hashable], Any] = {}

    def at(self, value: Value) -> Any:
        """A value at the start. Raises TypeError where it depends on the state of a run."""
        return evaluate(value.expr, self._look_up, arrays=True)

    def object(self, ref: Ref) -> Object:
        """The kind of an object."""
        kind = self._tasks[ref.name].kind
        assert isinstance(kind, Object)
        return kind

    def kept(self, name: str, key: Hashable, make: Callable[[], Any]) -> Any:
        """The result of ``make`` for a part and key, made once."""
        if (name, key) not in self._kept:
            self._kept[name, key] = make()
        return self._kept[name, key]

    def _look_up(self, node: Symbol | Link) -> Any:
        if isinstance(node, Symbol):
            return self.time
        source = self._tasks[node.task].kind
        if not isinstance(source, Model) or not source.kinematic:
            raise TypeError("only a run knows it")
        if node not in self._known:
            self._known[node] = evaluate(source.formula(node.output), self._look_up, arrays=True)
        return self._known[node]


def check_fillings(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Report fillings that exceed memory or are empty; boxes that only a run knows are left to the run."""
    start: Any = Beginning(tasks)
    for task in tasks.values():
        for ref, bounds in task.kind.fillings() if isinstance(task.kind, Model) else ():
            box = box_of(ref, start)
            if box is None:
                continue  # the run reports it
            try:
                bounds(*box)
            except Exceeds as error:
                found.error("limit-refused", f"{task.name}: at least {error}", ref.span, help="use a larger spacing")
            except TooCoarse as error:
                found.error("not-filled", f"'{ref.name}' cannot be filled: {error}", ref.span)


def box_of(ref: Ref, start: Any) -> tuple[Any, Any] | None:
    """The low and high corners (3,) [m] of an object's box at the start (Beginning); None where only a run knows it."""
    try:
        low, high = start.object(ref).extent(_place(), start)
    except (TypeError, ValueError, RunFailure, ScriptError, Exceeds):
        return None
    return (low, high) if _finite(low, high) else None


def _finite(low: Any, high: Any) -> bool:
    """Whether a box has finite sides."""
    import numpy as np

    with np.errstate(over="ignore", invalid="ignore"):
        return bool(np.isfinite(high - low).all())


def _place() -> Any:
    import numpy as np

    return np.eye(3, 4)
