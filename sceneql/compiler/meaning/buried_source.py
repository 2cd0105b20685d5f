"""Warnings of particles that are born under the ground."""

from __future__ import annotations

from typing import Any

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.compiler.passes.unseen import ground_level
from sceneql.kinds import Model
from sceneql.quantities.diagnostic import Diagnostics


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each source of particles that stands still under a level ground."""
    level = ground_level(facts.tasks)
    for task in facts.of(Model) if level is not None else ():
        emit: Any = getattr(task.kind, "emit", None)
        place = constant(emit.from_) if emit is not None and emit.within is None else None
        if place is not None and level is not None and place[1] < level:
            x, y, z = place
            meant = (x, z, -y) if level < z < -y else (x, level + 0.1, z)
            text = f"'{task.name}' is born under the ground, which hides it"
            help = f"y is up: write `from: {' '.join(f'{0.0 + c:g}' for c in meant)} m`"
            found.warning("never-seen", text, emit.from_.span or task.span, help=help)
