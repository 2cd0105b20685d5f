"""Warnings of flows that nothing drives, inflows that let nothing in, and solids that a flow does not go around."""

from __future__ import annotations

from typing import Any

from sceneql.compiler.meaning.box_values import box, flat, nothing, over
from sceneql.compiler.meaning.facts import Facts
from sceneql.compiler.meaning.places import ball, opaque
from sceneql.compiler.values_below import values_of
from sceneql.graph import Task
from sceneql.kinds import Model
from sceneql.quantities.diagnostic import Diagnostics

LOW, HIGH = ("left", "bottom", "back"), ("right", "top", "front")
INWARD = {name: (k, sign) for names, sign in ((LOW, 1.0), (HIGH, -1.0)) for k, name in enumerate(names)}
"""By side of a box its axis, and the sign of what comes in along it."""
FLAT = 2
"""Number of sides of a flat box."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such flow in a box."""
    for task in facts.of(Model) if facts.whole else ():
        ends = box(task.kind)
        if not getattr(task.kind, "flows", False) or ends is None or task.span is None:
            continue
        if not _driven(facts, task, ends):
            text = f"nothing drives '{task.name}': it stays at rest"
            side = next((side for side in task.kind.boundary.values() if side.inflow is not None), None)  # type: ignore
            help = 'let it in, `boundary: {left: {inflow: {velocity: "[1, 0]"}}, right: {outflow: {}}}`, or move a wall'
            if side is not None:
                text = f"this inflow is 0, and nothing else drives '{task.name}': it stays at rest"
                help = "write a velocity that points into the box"
            place = side.inflow.velocity.span if side is not None else None
            found.warning("nothing-moves", text, place or task.span, help=help)
            continue
        _inflows(task, ends, facts.clock.end, found)
        _solids(facts, task, ends, found)


def _driven(facts: Facts, task: Task, ends: Any) -> bool:
    """Whether something may move a flow."""
    kind: Any = task.kind
    group = next((group for group in facts.groups if task.name in group.models), None)
    others = [facts.tasks[name].kind for name in group.models if name != task.name] if group is not None else []
    if kind.initial is not None or kind.buoyancy is not None or any(getattr(one, "has_bodies", True) for one in others):
        return True
    if any(getattr(one, "carried", False) for one in others) or not nothing(kind.force, facts.clock.end):
        return True
    for side in kind.boundary.values():
        moving = side.inflow.velocity if side.inflow is not None else getattr(side.wall, "velocity", None)
        if not nothing(moving, facts.clock.end) or (side.outflow is not None and side.outflow.pressure):
            return True
    solids = [facts.tasks[ref.name] for ref in kind.around]
    return any(one.original is not None or not all(v.constant for v in values_of(one.kind)) for one in solids)


def _inflows(task: Task, ends: Any, end: float, found: Diagnostics) -> None:
    """Inflows that point out of the box, or along its side."""
    kind: Any = task.kind
    sides = {name: side for name, side in kind.boundary.items() if side.inflow is not None}
    along: dict[str, list[float]] = {}
    for name, side in sides.items():
        if name not in INWARD or INWARD[name][0] >= len(ends):
            return
        axis, sign = INWARD[name]
        along[name] = []
        for one in over(side.inflow.velocity, ends, (0.0, 0.41 * end)):
            if one is None or len(flat(one)) != len(ends):
                return
            along[name].append(sign * flat(one)[axis])
            if along[name][-1] > 0.0:
                break  # something comes in
    for name, inward in along.items():
        if max(inward) <= 0.0 and (min(inward) < 0.0 or len(along) == 1):
            axis, sign = INWARD[name]
            if min(inward) < 0.0 and any(max(others) > 0.0 for others in along.values()):
                continue  # what comes in elsewhere is taken out here
            way = "points out of the box" if min(inward) < 0.0 else "runs along that side, so that nothing comes in"
            text = f"the inflow at `{name}` {way}"
            one = ["0"] * len(ends)
            one[axis] = f"{sign * (max(map(abs, inward)) or 1.0):g}"
            velocity = sides[name].inflow.velocity
            found.warning("no-inflow", text, velocity.span or task.span, help=f'write `velocity: "[{", ".join(one)}]"`')


def _solids(facts: Facts, task: Task, ends: Any, found: Diagnostics) -> None:
    """Solids that are outside of the box or smaller than a cell, and those in the box that are not named."""
    kind: Any = task.kind
    named = [ref.name for ref in kind.around]
    for ref in kind.around:
        held = ball(facts, ref.name)
        if held is None:
            continue
        gaps = [max(low - c, c - high) for (low, high), c in zip(ends, held.center, strict=False)]
        if max(gaps) > held.reach:
            text = f"'{ref.name}' stands outside of '{task.name}', which flows past nothing"
            middle = " ".join(f"{0.5 * (low + high):g}" for low, high in ends)
            help = f"the middle of its box is {middle} m: write a `position` in it"
            found.warning("outside-box", text, ref.span or task.span, help=help)
        elif 2.0 * held.reach < kind.cell:
            text = f"'{ref.name}' is {2.0 * held.reach:.2g} m large, and a cell of '{task.name}' {kind.cell:g} m"
            help = f"write `cell: {held.reach / 4.0:.2g} m` for 8 cells across it, or a larger object"
            found.warning("few-cells", text, ref.span or task.span, help=help)
    used = {need for one in facts.tasks.values() for need in one.needs}
    inflow = any(side.inflow is not None for side in kind.boundary.values())
    for name, held in opaque(facts).items() if inflow and not kind.around else ():
        if name in used or name in named or not facts.written(name) or held.inner < kind.cell:
            continue
        deep = len(ends) > FLAT or abs(held.center[2]) < held.inner
        if deep and all(low < c < high for (low, high), c in zip(ends, held.center, strict=False)):
            text = f"'{task.name}' flows through '{name}', as if it were not there"
            found.warning("flows-through", text, facts.tasks[name].span, help=f"write `around: [{name}]` in the flow")
