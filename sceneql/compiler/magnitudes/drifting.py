"""Warnings of what no force acts on, and that hardly leaves its place at the speed it starts with."""

from __future__ import annotations

from math import hypot
from typing import Any

from sceneql.compiler.meaning.facts import Facts
from sceneql.compiler.passes.fall_through import starts_of
from sceneql.compiler.passes.fillings import Beginning
from sceneql.quantities.diagnostic import Diagnostics

SEEN = 0.03
"""Part of its own reach by which something has to move to be seen."""
SHORTEST = 0.5
"""[s] A film that is shorter is most likely a piece of one."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such model, all of whose masses start with a speed that is too small."""
    start: Any = Beginning(facts.tasks)
    for island in facts.groups if facts.whole and facts.clock.end >= SHORTEST else ():
        if facts.forces(island) or facts.ties(island) or island.contacts:
            continue
        for name in island.models:
            task = facts.tasks[name]
            kind: Any = task.kind
            parts = [kind, *(getattr(kind, "bodies", None) or {}).values()]
            if not kind.inert or task.span is None or any(any(getattr(one, "spin", None) or ()) for one in parts):
                continue
            ways = [
                (hypot(*velocity) * facts.clock.end, reach)
                for _, velocity, reach in starts_of(kind, facts.tasks, start)
            ]
            if not ways or max(way for way, _ in ways) == 0.0 or any(way > SEEN * reach for way, reach in ways):
                continue
            way, reach = max(ways)
            text = f"'{name}' moves by {way:.2g} m until {facts.clock.end:g} s, and is {2.0 * reach:.2g} m large: "
            text += "it seems to stand"
            help = f"write a larger `velocity`, a thousand times this one for {1000.0 * way:.2g} m, or a longer clock"
            found.warning("nothing-moves", text, task.span, help=help)
