"""Warnings of masses that come down through a level ground, for no contact names both, though more than weight acts."""

from __future__ import annotations

from math import exp, hypot
from typing import Any, cast

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.compiler.passes.fall_through import pull_of, starts_of
from sceneql.compiler.passes.fillings import Beginning
from sceneql.compiler.passes.unseen import level_of
from sceneql.graph import Island, Task
from sceneql.kinds import Contact, Interaction, Model
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.run.falling import HELP, standing

NO_DELAY = 1e-6
"""Rate of drag times the end of the clock below which drag takes nothing off a fall."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each model that certainly is below a ground, with all of it, before the clock ends."""
    grounds = {name: level_of(facts.objects[name]) for name in standing(facts.tasks) if facts.written(name)}
    told = [one.span for one in found.found if one.code == "falls-through"]
    start: Any = Beginning(facts.tasks)
    for island in facts.groups:
        if facts.ties(island) or _touches(facts, island):
            continue
        for name in island.models:
            task = facts.tasks[name]
            if task.span is None or task.span in told:
                continue
            depth = _depth(facts, island, task, start)
            for ground, level in grounds.items():
                if depth is None or level is None or not depth[1] < level < depth[0]:
                    continue
                contact = next((one.name for one in facts.of(Contact) if one.span is not None), None)
                named = _named(facts.tasks[contact]) if contact else []
                of_it = f"'{contact}' is not of both" if named else "no contact acts on it"
                body = name if name in named else next(iter(_driven(task)), name)
                both = list(dict.fromkeys([*named, body, ground]))
                help = f"name both there, `between: [{', '.join(both)}]`" if named else HELP
                text = f"'{name}' comes down through '{ground}': {of_it}"
                found.warning("falls-through", text, task.span, help=help)
                break


def _named(contact: Task) -> list[str]:
    return [ref.name for ref in cast(Contact, contact.kind).ties()]


def _driven(task: Task) -> list[str]:
    """The object that a model of one body moves."""
    of = getattr(task.kind, "of", None)
    return [of.name] if of is not None and hasattr(of, "name") else []


def _touches(facts: Facts, island: Island) -> bool:
    """Whether what is in the island touches anything that it does not itself move."""
    moved = {name for one in island.models for name in (one, *_driven(facts.tasks[one]))}
    return any(other not in moved for _, _, others in island.contacts for other in others)


def _depth(facts: Facts, island: Island, task: Task, start: Any) -> tuple[float, float] | None:
    """The lowest point of a model at the start, and a bound of its highest one at the end [m]; None if unknown."""
    own = [cast(Interaction, facts.tasks[force].kind) for force, model in island.forces if model == task.name]
    weights = [one for one in own if one.weighs]
    pull = pull_of(weights)
    masses = [mass.mass for mass in cast(Model, task.kind).static_masses().values()]
    if pull is None or pull[1] >= 0.0 or not masses or min(masses) <= 0.0:
        return None
    end, rate, blow = facts.clock.end, 0.0, 0.0
    for one in own:
        linear, quadratic, value = (constant(getattr(one, field, None)) for field in ("linear", "quadratic", "value"))
        if one.weighs:
            continue
        if getattr(one, "needs_speed", False) and linear is not None and quadratic is not None:
            rate += (float(linear) + float(quadratic) * hypot(*pull) * end) / min(masses)
        elif {"on", "at", "value"} <= type(one).model_fields.keys() and value is not None:
            blow += hypot(*value) / min(masses)
        else:
            return None
    starts = starts_of(cast(Model, task.kind), facts.tasks, start)
    if not starts:
        return None
    way = end * end / 2.0 if rate * end < NO_DELAY else (end - (1.0 - exp(-rate * end)) / rate) / rate
    lows = [place[1] - reach for place, _, reach in starts]
    highs = [place[1] + reach + (max(v[1], 0.0) + blow) * end + pull[1] * way for place, v, reach in starts]
    return min(lows), max(highs)
