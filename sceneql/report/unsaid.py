"""The default parts that a script leaves unsaid, as entries to paste behind its own, and then to change."""

from __future__ import annotations

from typing import Any

from sceneql.graph import SimulationGraph, Task
from sceneql.kinds import Kind, Value
from sceneql.kinds.word import written_name


def unsaid(graph: SimulationGraph) -> str:
    """The default parts as YAML by family; empty where the script leaves none unsaid.

    A family that the script already has stands in comments, to be put into its own: a key cannot be given twice.
    """
    families: dict[str, list[str]] = {}
    for task in _settled(graph).tasks.values():
        if task.span is None:
            families.setdefault(task.family, []).append(f"  {task.name}: {{{task.word}: {{{_fields(task)}}}}}")
    own = {task.family for task in graph.tasks.values() if task.span is not None}
    lines = [
        ("# " if family in own else "") + line
        for family, entries in families.items()
        for line in (f"{family}:", *entries)
    ]
    return "\n".join(lines)


def _settled(graph: SimulationGraph) -> SimulationGraph:
    """The graph as its run has it: with the floor lowered under the objects."""
    from sceneql.run.grounded import grounded
    from sceneql.run.run import Run

    return grounded(graph, lambda: Run(graph, marching=False).at(0.0))


def _fields(task: Task) -> str:
    """The fields of a part's own word that have a value."""
    own = [name for name in type(task.kind).model_fields if not _is_of_family(task.kind, name)]
    given = [(written_name(name), _written(task.kind, name)) for name in own]
    return ", ".join(f"{name}: {value}" for name, value in given if value is not None)


def _is_of_family(kind: Kind, name: str) -> bool:
    """Whether all words of the family have the field."""
    bases = (base for base in type(kind).__mro__[1:] if issubclass(base, Kind) and "family" in base.__dict__)
    return any(name in base.model_fields for base in bases)


def _written(kind: Kind, name: str) -> str | None:
    """A field's value as a script writes it: its default, or the number that the scene gave it."""
    extra: Any = type(kind).model_fields[name].json_schema_extra
    default, value = extra["default"], getattr(kind, name)
    if default in (None, "", (), {}) or isinstance(default, bool) or not isinstance(default, str):
        return None
    if isinstance(value, Value) and value != type(kind).model_validate({}).__dict__.get(name) and value.constant:
        return f"{float(value.number())!r} m"
    return value if isinstance(value, str) else default
