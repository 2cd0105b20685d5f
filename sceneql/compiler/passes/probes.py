"""Check of probes: each must lie inside the object in which a field spreads or which a solid fills.

The objects at the start are tested as far as the script determines them, by polygons, formulas or boxes. What only a
run knows, as points within a cell of the boundary, is left to the run.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any

from sceneql.compiler.passes.fillings import Beginning
from sceneql.failure import LimitRefused, RunFailure
from sceneql.graph import Task
from sceneql.kinds import Model
from sceneql.kinds.probed import Probed
from sceneql.language.script import Script
from sceneql.quantities.diagnostic import Diagnostics, ScriptError

SIDE = 5
"""Number of sample points along each axis across the tolerance around a probe."""


def report_probes(script: Script, tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Report each probe that certainly lies outside."""
    start: Any = Beginning(tasks)
    for task in tasks.values():
        for one in task.kind.probed() if isinstance(task.kind, Model) else ():
            try:
                outside = _outside(one, start)
            except (TypeError, ValueError, ArithmeticError, RunFailure, LimitRefused, ScriptError):
                continue  # the run reports it
            if outside:
                entry = script.sections.get(task.family, {}).get(task.name)
                span = task.span if entry is None else entry.place(one.path)
                text = f"the probe '{one.path[-1]}' stands outside of '{one.inside.name}'"
                found.error("probe-outside", text, span, help=outside)


def _outside(probe: Probed, start: Any) -> str:
    """A text that says where the object is, for a probe farther outside than tolerated; else empty."""
    import numpy as np

    from sceneql.field.tape.builder import TapeBuilder

    kind = start.object(probe.inside)
    flat = kind.domain()
    low, high = (np.zeros(3), np.zeros(3)) if flat is None else flat.bounds
    if flat is None:
        low, high = kind.extent(np.eye(3, 4), start)
    axes = 2 if flat is not None else 3
    place = np.array([*probe.place, 0.0][:3])
    room = float((high - low).max()) / 10.0 if probe.room is None else probe.room
    if not np.isfinite(room):
        return ""
    where = " to ".join(", ".join(f"{x:.4g}" for x in corner[:axes]) for corner in (low, high))
    told = f"its box goes from {where} m"
    if ((place < low - room) | (place > high + room))[:axes].any():
        return told
    steps = np.linspace(-room, room, SIDE)
    around = [place + np.array([*step, 0.0][:3]) for step in product(steps, repeat=axes)]
    if flat is not None:
        return "" if flat.holds(np.array(around)).any() else told
    for point in around:
        build = TapeBuilder()
        at = (build.constant(x) for x in point)
        value = build.number(kind.implicit(build, *at, start))
        if value is None or not value > 0.0:
            return ""
    return told
