"""Warnings of values without derivatives, which implicit solvers need."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, cast

from sceneql.compiler.values_below import values_of
from sceneql.graph import Island, Task
from sceneql.kinds import Model, Solver, Value
from sceneql.kinds.values import MOST_READ
from sceneql.quantities.derivative import components
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.expression import Link, Symbol, each_once


def warn_of_values(tasks: Mapping[str, Task], groups: Iterable[Island], found: Diagnostics) -> None:
    """Warn of values without derivatives: they read more than MOST_READ entries of the state, or a tally."""
    for island in groups:
        parts = dict.fromkeys((*island.models, *(force for force, _ in island.forces)))
        solver = tasks[island.solver]
        for value in (value for part in parts for value in values_of(tasks[part].kind)):
            solved = [link for link in value.links if link.task in island.models]
            lists = [link for link in solved if None in link.type.shape]
            tallies = [link for link in solved if cast(Model, tasks[link.task].kind).sums_up(link.output)]
            if not (lists or tallies) or not cast(Solver, solver.kind).stepper().needs.jacobian:
                continue
            if tallies:
                text = f"this value reads '{tallies[0].output}', which sums up the run so far"
                help = f"of such a sum a value gives no slopes, without which {solver.word} takes small scenes alone: "
                help += "let auto march it"
                found.warning("no-slopes", text, tallies[0].span or value.span, help=help)
                continue
            read = _read(value, tasks, island.models)
            if read is None or read > MOST_READ:
                text = f"this value reads {'a list' if read is None else read} of the state's numbers"
                help = f"by more than {MOST_READ} numbers a value gives no slopes, without which {solver.word} takes "
                help += "small scenes alone: link to single masses, or let auto march it"
                found.warning("no-slopes", text, lists[0].span or value.span, help=help)


def _read(value: Value, tasks: Mapping[str, Task], solved: Iterable[str]) -> int | None:
    """Number of entries of the state that a value reads; None where a model's fields do not determine it."""

    def symbols(name: str, shape: tuple[int, ...]) -> Any:
        return [symbols(f"{name}.{k}", shape[1:]) for k in range(shape[0])] if shape else Symbol(name)

    def meaning(link: Link) -> Any:
        if link.task not in solved:
            return None
        shape = [cast(Model, tasks[link.task].kind).items(link.output) if n is None else n for n in link.type.shape]
        if None in shape:
            raise TypeError("the length of a list is not told")
        return symbols(f"{link.task}.{link.output}", tuple(n or 0 for n in shape))

    try:
        parts = components(value.expr, meaning)
    except TypeError:
        return None
    return len({node.name for node in each_once(*parts) if isinstance(node, Symbol) and "." in node.name})
