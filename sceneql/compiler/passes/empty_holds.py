"""Check of held parts of solids: whether they can select any place in the solid's box."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from sceneql.compiler.passes.fillings import Beginning
from sceneql.compiler.passes.overlaps import UNKNOWN
from sceneql.graph import Task
from sceneql.kinds import Model, Ref
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.span import Span

ROOM = 1e-3
"""Tolerance around the box, relative to its size: positions may be rounded."""
BEYOND = re.compile(r"([xyz])\s*([<>])=?\s*[^<>=&|]+")
"""What lies on one side of a place along an axis."""


def report_empty_holds(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Report each held part that certainly selects no place."""
    start: Any = Beginning(tasks)
    for task in tasks.values():
        for part in task.kind.held_parts() if isinstance(task.kind, Model) else ():
            try:
                low, high = _box(part.inside, start) if isinstance(part.inside, Ref) else part.inside
            except UNKNOWN:
                continue  # the run reports it
            room = ROOM * max(b - a for a, b in zip(low, high, strict=True))
            if part.misses([a - room for a in low], [b + room for b in high]):
                ends = ", ".join(f"{axis} from {a:.4g} to {b:.4g}" for axis, a, b in zip("xyz", low, high, strict=True))
                help = f"its material goes in {ends} m{reached(part.span, low, high)}"
                found.error("no-mass", f"'{part.name}' holds no node", part.span or task.span, help=help)


def reached(told: Span | None, low: Sequence[float], high: Sequence[float]) -> str:
    """What to write in place of a condition ``x > 2`` that misses a box low..high (3,) [m]; empty of others."""
    axis = None if told is None else BEYOND.fullmatch(told.text.strip("\"' "))
    if axis is None:
        return ""
    at = "xyz".index(axis[1])
    room = ROOM * (high[at] - low[at])
    end = high[at] - room if axis[2] == ">" else low[at] + room
    return f": write `where: {axis[1]} {axis[2]} {end:.6g}`"


def _box(ref: Ref, start: Any) -> Any:
    import numpy as np

    return start.object(ref).extent(np.eye(3, 4), start)
