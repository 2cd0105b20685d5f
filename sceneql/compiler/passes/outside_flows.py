"""Check of skins and solids in flows: none may start wholly outside, or be cut to another shape than is meant."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sceneql.compiler.passes.fillings import Beginning
from sceneql.compiler.passes.overlaps import UNKNOWN
from sceneql.graph import Task
from sceneql.grids.domain.cells import periodic_axes
from sceneql.kinds import Force, Model, Object
from sceneql.quantities.diagnostic import Diagnostics

FLAT = 2
"""Number of sides of a flat box."""


def report_outside_flows(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Report each skin whose object is certainly outside of its flow's box; partial overlaps are left to the run."""
    start: Any = Beginning(tasks)
    for force in [task.kind for task in tasks.values() if isinstance(task.kind, Force)]:
        carrier = force.carrier()
        flow: Any = None if carrier is None else tasks[carrier.name].kind
        size: Any = getattr(flow, "size", None)
        for name in force.targets() or () if size is not None else ():
            kind = tasks[name].kind
            for ref in kind.insides() if isinstance(kind, Model) else ():
                try:
                    side = _beyond(start.object(ref), flow, start)
                except UNKNOWN:
                    continue  # the run reports it
                if side:
                    text = f"'{ref.name}' stands outside its flow, which ends at {side}"
                    found.error("invalid", text, ref.span, help="move it inside, or take a larger `size`")


def _beyond(shape: Any, flow: Any, start: Any) -> str:
    """The side of a flow's box beyond which a shape lies, periodic ones excepted, as text; empty for none."""
    import numpy as np

    low, high = shape.extent(np.eye(3, 4), start)
    corner, endless = flow.corner or (0.0,) * len(flow.size), periodic_axes(flow.boundary)
    for axis, (first, length) in enumerate(zip(corner, flow.size, strict=True)):
        if axis in endless:
            continue
        if high[axis] <= first or low[axis] >= first + length:
            return f"{'xyz'[axis]} = {first if high[axis] <= first else first + length:g} m"
    return ""


def warn_of_sections(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of solids in flat flows whose section at z = 0 is most likely another than meant."""
    for task in tasks.values():
        size = getattr(task.kind, "size", None)
        flat = getattr(task.kind, "flat", False) or (isinstance(size, tuple) and len(size) == FLAT)
        for ref in getattr(task.kind, "around", None) or () if flat and isinstance(task.kind, Model) else ():
            kind = tasks[ref.name].kind
            section, _, help = kind.odd_section().partition(": ") if isinstance(kind, Object) else ("", "", "")
            if section:
                text = f"'{task.name}' flows round the section of '{ref.name}' at z = 0, {section}"
                found.warning("odd-section", text, ref.span, help=help)
