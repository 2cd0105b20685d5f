"""Warnings of masses that move too little to be seen until the clock ends: a force too small, a drag too large."""

from __future__ import annotations

from math import hypot, inf
from typing import Any, cast

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.compiler.passes.fall_through import starts_of
from sceneql.compiler.passes.fillings import Beginning
from sceneql.graph import Island, Task
from sceneql.kinds import Formula, Model
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.evaluate import evaluate

SEEN = 0.01
"""Part of a mass's own reach by which it has to move to be seen."""
FAR = 1.0
"""[m] Way that is seen of whatever is told in meters."""
SHORTEST = 0.5
"""[s] A film that is shorter is most likely a piece of one."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each island of free masses or bodies whose way is bounded."""
    start: Any = Beginning(facts.tasks)
    told = [one.span for one in found.found if one.code == "nothing-moves"]
    for island in facts.groups if facts.whole and facts.clock.end >= SHORTEST else ():
        models = [facts.tasks[name] for name in island.models]
        plain = all(cast(Any, task.kind).inert and getattr(task.kind, "emit", None) is None for task in models)
        if not plain or facts.ties(island) or any(task.span in told for task in models) or not facts.forces(island):
            continue
        _island(facts, island, start, found)


def _island(facts: Facts, island: Island, start: Any, found: Diagnostics) -> None:
    end = facts.clock.end
    for name in island.models:
        model: Any = facts.models[name]
        masses = [one.mass for one in model.static_masses().values()]
        mass = min(masses, default=0.0)
        if hasattr(model, "density") and not masses:
            mass = _of_density(facts, model, start)
        pulls = [_pull(task, mass) for task in facts.forces(island)]
        if mass <= 0.0 or None in pulls:
            return
        rate = sum(one[0] for one in pulls if one is not None)
        drag = sum(one[1] for one in pulls if one is not None) / mass
        if drag == 0.0 and rate * end * end > FAR:
            return
        places = starts_of(cast(Model, model), facts.tasks, start)
        if not places:
            return
        way = 0.0
        for _, velocity, reach in places:
            speed = hypot(*velocity)
            way = speed * min(end, 1.0 / drag if drag else inf) + rate * end * min(
                0.5 * end, 1.0 / drag if drag else inf
            )
            if reach <= 0.0 or way > SEEN * reach:
                return
        forces = facts.forces(island)
        strong = max(forces, key=lambda task: (_pull(task, mass) or (0.0, 0.0))[1 if drag * end > 1.0 else 0])
        text = f"'{name}' moves by at most {way:.1g} m until {end:g} s: "
        text += f"'{strong.name}' holds it back" if drag * end > 1.0 else f"'{strong.name}' is too weak"
        times = 5.0 * places[0][2] / max(way, 1e-300)
        help = f"write one {times:.1g} times as {'small' if drag * end > 1.0 else 'large'}"
        help += "" if drag * end > 1.0 else ", a smaller mass, or a longer clock"
        found.warning("nothing-moves", text, strong.span or facts.tasks[name].span, help=help)


def _of_density(facts: Facts, model: Any, start: Any) -> float:
    """The mass [kg] of the body that a model is, by its object; 0 where it is not known."""
    from sceneql.bodies.rigid.mass_properties import properties  # here, where a force is to be compared with it
    from sceneql.compiler.passes.overlaps import UNKNOWN

    if getattr(model, "of", None) is None or getattr(model, "bodies", None):
        return 0.0
    try:
        return float((model.density or 1000.0) * properties(facts.objects[model.of.name], start).volume)
    except UNKNOWN:
        return 0.0


def _pull(task: Task, mass: float) -> tuple[float, float] | None:
    """The largest acceleration [m/s^2], and the linear drag [kg/s], of a force; None where they are not known."""
    kind: Any = task.kind
    if kind.weighs:
        given = constant(kind.acceleration) if kind.acceleration is not None else constant(kind.strength)
        return None if given is None else (hypot(*given) if isinstance(given, tuple) else abs(float(given)), 0.0)
    components = getattr(kind, "components", None)
    if isinstance(components, Formula) and "at" in type(kind).model_fields and kind.at is None:
        try:
            return hypot(*evaluate(components.expr, {})) / mass if mass else inf, 0.0
        except (KeyError, TypeError, ValueError):
            return None
    if getattr(kind, "needs_speed", False) and "linear" in type(kind).model_fields:
        linear = constant(kind.linear)
        return None if linear is None else (0.0, float(linear))
    return None
