"""Warnings of models that start at rest, and that no force moves: none is there, or those that are need a motion."""

from __future__ import annotations

from typing import Any

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.compiler.passes.unforced import leads, starts_moving
from sceneql.graph import Task
from sceneql.kinds import Model
from sceneql.quantities.diagnostic import Diagnostics

FACTORS = ("charge", "strength", "field_", "components")
"""Fields of forces that are 0 where the force is."""
JOINT = ("between", "at", "axis", "rest", "restitution")
"""Fields of a joint that move nothing by themselves."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such island that has not been told of."""
    led = any(not value.constant for task in facts.tasks.values() if leads(task) for value in _values(task))
    told = [one.span for one in found.found if one.code == "nothing-moves"]
    for island in facts.groups if facts.whole else ():
        models = [facts.tasks[name] for name in island.models]
        if any(task.span in told for task in models) or (led and island.contacts):
            continue
        if not all(_rests(task.kind) and not starts_moving(task.kind) for task in models):
            continue
        forces = facts.forces(island)
        ties = facts.ties(island)
        if ties and (led or forces or not all(_joins(one.kind) for one in ties) or not all(map(_inert, models))):
            continue
        why = [_idle(force) for force in forces]
        if not all(why) or (not forces and not ties and all(_inert(task) for task in models)):
            continue  # those without any force are told by themselves
        name = models[0].name
        if forces:
            text = f"'{forces[0].name}' does not move '{name}', which starts at rest: {why[0]}"
            help = f"give '{name}' a `velocity`" if "speed" in why[0] else "write another value, or another force"
        elif ties:
            text = f"no force acts on '{name}', and it starts at rest, in joints: it stays so"
            help = "write `forces: [gravity]`, or give it a `velocity` or a `spin`"
        else:
            text = f"no force acts on '{name}', and it starts at rest, as long as its springs are: it stays so"
            help = "write `forces: [gravity]`, or give it a `velocity`"
        found.warning("nothing-moves", text, (forces[0] if forces else models[0]).span, help=help)


def _inert(task: Task) -> bool:
    return isinstance(task.kind, Model) and task.kind.inert


def _joins(kind: Any) -> bool:
    """Whether a tie only joins its bodies at a place: all else that it may say is as by default."""
    more = [value for field, value in kind if field not in JOINT]
    return getattr(kind, "at", None) is not None and all(value is None for value in more)


def _values(task: Task) -> Any:
    from sceneql.compiler.values_below import values_of

    return values_of(task.kind)


def _rests(kind: Any) -> bool:
    """Whether a model stays as it starts where no force acts and nothing moves it."""
    if kind.inert:
        emit = getattr(kind, "emit", None)
        return emit is None or getattr(kind, "aging", None) is None
    if hasattr(kind, "pins"):
        springs = getattr(kind, "springs", None) or ()
        shifts = [pin.shift for pin in kind.pins.values()] if isinstance(kind.pins, dict) else []
        held = bool(kind.pins) or any(mass.fixed for mass in kind.static_masses().values())  # so that it may hang
        whole = getattr(kind, "solid", None) is None and getattr(kind, "lattice", None) is None
        still = all(constant(shift) == (0.0, 0.0, 0.0) for shift in shifts)
        return still and held and whole and all(spring.rest is None for spring in springs)
    return False


def _idle(force: Task) -> str:
    """Why a force moves nothing that is at rest; empty where it may."""
    kind: Any = force.kind
    if getattr(kind, "needs_speed", False):
        return "it acts with the speed alone"
    for name in FACTORS:
        number = constant(getattr(kind, name, None))
        if number is not None and not any(_flat(number)):
            return f"its `{name.strip('_')}` is 0"
    wind, inside = constant(getattr(kind, "velocity", None)), getattr(kind, "in_", None)
    if wind is not None and inside is None and not any(wind) and hasattr(kind, "gusts"):
        return "its `velocity` is 0"
    return ""


def _flat(number: Any) -> list[float]:
    return [c for one in number for c in _flat(one)] if isinstance(number, tuple | list) else [float(number)]
