"""Check of boundary names: a field's conditions must name parts of the boundary of the object in which it spreads."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sceneql.graph import Task
from sceneql.kinds import Model, Object
from sceneql.language.script import Script
from sceneql.language.tree import Mapping as MappingNode
from sceneql.language.tree import Node
from sceneql.quantities.diagnostic import Diagnostics, ScriptError

HELP = "a part of it says where it is: `near: 0 0.3 m` with `within: 6 cm`, or `where`"
SIDES = ("left", "right", "bottom", "top", "back", "front")


def report_boundary_names(script: Script, tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Report each unknown name; those of a box are reported by their models."""
    for task in tasks.values():
        kind: Any = task.kind
        domain = getattr(kind, "domain", None)
        if not isinstance(kind, Model) or domain is None or not hasattr(kind, "boundaries"):
            continue
        known = [domain.name, "rest"]
        said = {name: part for boundary in kind.boundaries() for name, part in boundary.items()}
        tried = [name for name, part in said.items() if name not in known and not part.chosen]
        shape: Any = tasks[domain.name].kind
        if tried and type(shape).domain is not Object.domain:
            try:
                known = [*shape.domain().names, "rest"]
            except (TypeError, ValueError, ScriptError):
                continue  # the run reports it
        entry = script.sections.get(task.family, {}).get(task.name)
        for name in [name for name in tried if name not in known]:
            place = None if entry is None or entry.fields is None else _key(entry.fields, name)
            text = f"the boundary has no part '{name}'"
            help = f"it has {', '.join(known)}; {HELP}"
            if name in SIDES and (own := shape.own_box()):
                help = f"sides have names in a box that is the model's own: in place of `domain` write {own}"
            found.error("unknown-boundary", text, place or task.span, help=help)


def _key(fields: Node, name: str) -> Any:
    """The span of a name below a key `boundary`; None where there is none."""
    if not isinstance(fields, MappingNode):
        return None
    inside = fields.entries.get("boundary")
    if isinstance(inside, MappingNode) and name in inside.keys:
        return inside.keys[name].span
    return next((place for node in fields.entries.values() if (place := _key(node, name)) is not None), None)
