"""Warnings of doubtful settings that models, lights and objects find in their own fields."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, cast

from sceneql.graph import Task
from sceneql.kinds import Clock, Interaction, Light, Model, Object, Value
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.dimension import LENGTH, MASS, TIME

GRAVITATION: Final = LENGTH**3 / MASS / TIME**2
SAME: Final = 1e-3
"""Relative difference up to which two constants are one, written with fewer digits."""


def warn_of_doubts(tasks: Mapping[str, Task], clock: Clock, found: Diagnostics) -> None:
    """Warn of each doubt of a model, a light or an object."""
    grounded = any(isinstance(task.kind, Object) and task.kind.grounds for task in tasks.values())
    for task in tasks.values():
        kind = task.kind
        doubts = kind.doubts() if grounded and isinstance(kind, Light) else ()
        doubts = kind.doubts(clock) if isinstance(kind, Model | Object) else doubts
        for doubt in doubts:
            found.warning(doubt.code, f"'{task.name}': {doubt.text}", doubt.place or task.span, help=doubt.help)


def warn_of_constants(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of models that start by another constant of a force than the force between their masses has."""
    forces = [task for task in tasks.values() if isinstance(task.kind, Interaction) and task.kind.mutual]
    for task in tasks.values():
        own = getattr(task.kind, "constant", 0.0) if isinstance(task.kind, Model) else 0.0
        if not isinstance(own, float) or own == 0.0:
            continue
        for force in forces:
            targets, value = cast(Interaction, force.kind).targets(), getattr(force.kind, "constant", None)
            if not isinstance(value, Value) or not value.constant or task.name not in (targets or (task.name,)):
                continue
            theirs = float(value.number())
            if value.expr.type.dimension == GRAVITATION and abs(theirs - own) > SAME * abs(own):
                text = (
                    f"'{task.name}' starts by the constant {own:g}, and '{force.name}' pulls by {theirs:g} m^3/kg/s^2"
                )
                found.warning("two-constants", text, task.span, help=f"write both: `constant: {theirs:g} m^3/kg/s^2`")
