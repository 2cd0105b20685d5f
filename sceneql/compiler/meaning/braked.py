"""Warnings of drags in a medium at rest that take the speed of what starts with one before a film shows it."""

from __future__ import annotations

from math import hypot
from typing import Any

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.graph import Task
from sceneql.kinds import Interaction
from sceneql.quantities.diagnostic import Diagnostics

UNSEEN = 0.5
"""Part of the time between two frames in which a speed has gone unseen."""
USUAL = 1.0 / 3.0
"""Part of a lifetime, or of the clock, in which a drag that is seen takes the speed."""
UNITS = ((1.0, "N*s/m"), (1e-3, "g/s"), (1e-6, "mg/s"))


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such drag on what has not been told of, by the slowest to stop."""
    told = [one.span for one in found.found if one.code == "nothing-moves"]
    for island in facts.groups if facts.whole else ():
        braked = [one for one in island.forces if _drag(facts.tasks[one[0]])]
        for force in dict.fromkeys(name for name, _ in braked):
            task = facts.tasks[force]
            models = [facts.tasks[name] for one, name in braked if one == force]
            starts = [start for model in models if (start := _start(model)) is not None]
            if not starts or any(one.span in told for one in (task, *models)):
                continue
            mass, speed, life, name = max(starts)
            linear = _drag(task)
            time = mass / linear
            if time >= UNSEEN * facts.frame:
                continue
            last = min(life, facts.clock.end)
            text = f"'{task.name}' takes the speed of '{name}' within {_short(time, 's')}: at {mass:.3g} kg, and "
            text += f"{speed:.3g} m/s at the start, they come {_short(time * speed, 'm')} far"
            whole = "the clock" if life > last else "their lifetime"
            help = f"for a drag that takes it in {USUAL * last:.2g} s, a third of {whole}, "
            help += f"write `linear: {_linear(mass / (USUAL * last))}`"
            kind: Any = task.kind
            found.warning("stops-at-once", text, kind.linear.span or task.span, help=help)


def _drag(task: Task) -> float:
    """The force for a speed [N*s/m] of a constant drag in a medium at rest; 0 of other forces."""
    kind: Any = task.kind
    fields = type(kind).model_fields
    at_rest = isinstance(kind, Interaction) and getattr(kind, "needs_speed", False) and "velocity" not in fields
    return float(constant(kind.linear) or 0.0) if at_rest and "linear" in fields else 0.0


def _start(task: Task) -> tuple[float, float, float, str] | None:
    """Mass [kg], speed [m/s], lifetime [s] and name of the heaviest that starts with a speed that is told."""
    kind: Any = task.kind
    emit = getattr(kind, "emit", None)
    masses = [one for one in kind.static_masses().values() if not one.fixed and one.mass > 0.0]
    if emit is not None:
        thrown = constant(emit.velocity) if "velocity" in emit.model_fields_set else None
        speed = hypot(*thrown) if thrown is not None else 0.0
        return (masses[0].mass, speed, emit.lifetime, task.name) if speed and masses else None
    given = [(one.mass, hypot(*one.velocity), float("inf"), task.name) for one in masses if any(one.velocity or ())]
    return max(given, default=None)


def _short(number: float, unit: str) -> str:
    """A time or a way, in thousandths where it is small."""
    return f"{number:.2g} {unit}" if number >= 0.1 else f"{1000.0 * number:.2g} m{unit}"


def _linear(number: float) -> str:
    """A coefficient [N*s/m] with a unit in which it is a number of usual size."""
    size, unit = next((one for one in UNITS if number >= 0.1 * one[0]), UNITS[-1])
    return f"{number / size:.2g} {unit}"
