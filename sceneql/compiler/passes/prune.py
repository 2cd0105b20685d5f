"""Pruning and scheduling in one walk: from the outputs to what they need, in the order in which it must run."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.graph import Island, LeftOut, Task
from sceneql.kinds import Light, Model, Object, Output, Overlay


def prune(
    tasks: Mapping[str, Task],
    islands: tuple[Island, ...],
    drawn: Mapping[str, tuple[str, ...]],
    cameras: Mapping[str, str],
) -> tuple[dict[str, Task], dict[str, tuple[str, ...]], tuple[LeftOut, ...]]:
    """The needed tasks, each after its needs; by task the outputs that need it; the other tasks with reasons."""
    seen_by_all = [t.name for t in tasks.values() if isinstance(t.kind, Light | Overlay)]
    island_of = {name: island for island in islands for name in island.models}
    order: dict[str, Task] = {}
    needed_by: dict[str, list[str]] = {}

    def visit(name: str, output: str, open_: tuple[str, ...]) -> None:
        if name in open_ or output in needed_by.setdefault(name, []):
            return
        needed_by[name].append(output)
        task = tasks[name]
        needs = list(task.needs)
        if name in island_of:
            island = island_of[name]
            needs += [force for force, _ in island.forces]
            needs += [part for contact, _, others in island.contacts for part in (contact, *others)]
            needs += [*island.models, island.solver]
        for other in needs:
            visit(other, output, (*open_, name))
        order.setdefault(name, task)

    for output in [t for t in tasks.values() if isinstance(t.kind, Output)]:
        seen = (*seen_by_all, cameras[output.name]) if output.name in cameras else ()
        for name in (*drawn.get(output.name, ()), *seen):
            visit(name, output.name, ())
        visit(output.name, output.name, ())

    left = tuple(LeftOut(t.name, t.word, _reason(t, tasks)) for t in tasks.values() if t.name not in order)
    return order, {name: tuple(outputs) for name, outputs in needed_by.items() if outputs}, left


def _reason(task: Task, tasks: Mapping[str, Task]) -> str:
    if isinstance(task.kind, Object) and task.kind.hidden:
        return "hidden, and nothing uses it"
    users = [t.name for t in tasks.values() if task.name in t.needs]
    if users:
        return f"only {', '.join(users)} uses it, which no output needs"
    if isinstance(task.kind, Model):
        return "no output draws or measures it"
    return "no output needs it"
