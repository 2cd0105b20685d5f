"""Warnings of springs whose damping is so far above the critical that they creep for longer than the clock."""

from __future__ import annotations

from typing import Any

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.graph import Task
from sceneql.kinds import Interaction, Model
from sceneql.quantities.diagnostic import Diagnostics

OVER = 50.0
"""Damping over the critical one, from which on nothing of a spring is seen but its damping."""
LONG = 1.0
"""Time in which a spring creeps back over that of the clock."""
USUAL = 0.1
"""Damping over the critical one that is proposed."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such spring between masses that are known, and of each such net."""
    for task in facts.of(Interaction) if facts.whole else ():
        kind: Any = task.kind
        if "rest" in type(kind).model_fields and hasattr(kind, "targets"):
            _one(facts, task, [name for name in kind.targets() or () if name in facts.models], found)
    for task in facts.of(Model) if facts.whole else ():
        if {"springs", "masses", "stiffness"} <= type(task.kind).model_fields.keys():
            _one(facts, task, [task.name], found)


def _one(facts: Facts, task: Task, models: list[str], found: Diagnostics) -> None:
    kind: Any = task.kind
    stiffness, damping = constant(kind.stiffness), constant(kind.damping)
    masses = [one.mass for name in models for one in facts.models[name].static_masses().values() if not one.fixed]
    masses = masses or [mass for name in models if isinstance(mass := getattr(facts.models[name], "mass", None), float)]
    if not isinstance(stiffness, float) or not isinstance(damping, float) or not masses or stiffness <= 0.0:
        return
    critical = 2.0 * (stiffness * max(masses)) ** 0.5
    if damping > OVER * critical and damping > LONG * stiffness * facts.clock.end:
        over = float(f"{damping / critical:.2g}")
        text = f"the damping of '{task.name}' is {over:g} times the critical: it creeps back in "
        text += f"{damping / stiffness:.3g} s, and the clock ends at {facts.clock.end:g} s"
        help = f"write `damping: {float(f'{USUAL * critical:.2g}'):g} N*s/m`, a tenth of the critical"
        found.warning("nothing-moves", text, kind.damping.span or task.span, help=help)
