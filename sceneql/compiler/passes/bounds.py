"""A warning about unbounded objects whose bounds the script does not give."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.graph import Task
from sceneql.kinds import Force, Model, Object
from sceneql.quantities.diagnostic import Diagnostics

FLAT = 2
"""Number of sides of a flat flow."""


def warn_of_bounds(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of each object that its own default bounds cut."""
    sections = _sections(tasks)
    for task in tasks.values():
        where, bounds = task.kind.cut_by_default(task.name in sections) if isinstance(task.kind, Object) else ("", "")
        if where:
            help = "give it `bounds`, as large as it is: `bounds: {ball: 2}`, or `{box: [-2 -2 -2, 2 2 2]}`"
            help = f"write `{bounds}`" if bounds else help
            message = f"'{task.name}' is cut by {where}, where it goes on: nothing says how far"
            found.warning("unset-bounds", message, task.span, help=help)


def _sections(tasks: Mapping[str, Task]) -> set[str]:
    """Names of the objects whose sections at z = 0 are skins in flat flows."""
    found = set()
    for force in [task.kind for task in tasks.values() if isinstance(task.kind, Force)]:
        carrier = force.carrier()
        size = None if carrier is None else getattr(tasks[carrier.name].kind, "size", None)
        for name in force.targets() or () if isinstance(size, tuple) and len(size) == FLAT else ():
            kind = tasks[name].kind
            found |= {ref.name for ref in kind.insides()} if isinstance(kind, Model) else set()
    return found
