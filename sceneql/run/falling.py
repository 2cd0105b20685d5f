"""Monitor of masses that fall into objects without a contact between them: a contact that was forgotten."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

from sceneql.failure import RunFailure
from sceneql.kinds import Interaction, Model, Object
from sceneql.quantities.diagnostic import Diagnostic

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.graph import Task
    from sceneql.run.instant import Instant
    from sceneql.run.run import IslandRun

MOST_MASSES, MOST_OBJECTS = 64, 16
"""Largest number of masses of a model, evenly chosen, and of objects that are monitored."""
HELP = "write `contacts: [collision]`, or in one list `forces: [gravity, collision]`"


@dataclass
class Falling:
    """A model with weight and without contact, and the objects that it may fall into."""

    model: str
    island: IslandRun
    others: list[str]
    outside: dict[tuple[int, str], bool] = field(default_factory=dict)
    """Whether a mass, by number, started outside of an object, by name."""
    found: Diagnostic | None = None

    def look(self, moment: Instant) -> None:
        """Record the first mass that is inside an object and started outside."""
        from sceneql.bodies.bodies import positions

        bodies = self.island.bodies[self.model]
        if self.found is not None or bodies is None:
            return
        places = positions(bodies, moment.state(self.model))[:: -(-bodies.count // MOST_MASSES) or 1]
        for name in [*self.others]:
            try:
                heights = _heights(name, places, moment)
            except (TypeError, ValueError, RunFailure):  # a part of it has no inside
                self.others.remove(name)
                continue
            for k, height in enumerate(heights):
                began_outside = self.outside.setdefault((k, name), height > 0.0)
                if began_outside and height <= 0.0:
                    text = f"'{self.model}' has fallen into '{name}' by {moment.now:.3g} s: no contact acts on it"
                    span = self.island.graph.tasks[self.model].span
                    self.found = Diagnostic("falls-through", text, span, HELP, severity="warning")
                    return


def _heights(name: str, places: Floats, moment: Instant) -> list[float]:
    """The implicit field of an object at points (n, 3), negative inside.

    1 outside of its box, and where it is undefined.
    """
    import numpy as np

    from sceneql.field.tape.builder import TapeBuilder

    kind = cast(Object, moment.run.graph.tasks[name].kind)
    low, high = kind.extent(np.eye(3, 4), moment)
    found = []
    for place in places:
        value = None
        if bool(((place >= low) & (place <= high)).all()):
            build = TapeBuilder()
            x, y, z = (build.constant(float(c)) for c in place)
            value = build.number(kind.implicit(build, x, y, z, moment))
        found.append(1.0 if value is None else value)
    return found


def falling(island: IslandRun) -> list[Falling]:
    """The models of an island with weight and without contact, where there are objects to fall into."""
    tasks = island.graph.tasks
    weighed = [model for force, model in island.island.forces if cast(Interaction, tasks[force].kind).weighs]
    hit = {model for _, model, _ in island.island.contacts}
    told = [one.span for one in island.graph.warnings if one.code == "falls-through"]
    alone = [model for model in dict.fromkeys(weighed) if model not in hit and island.bodies.get(model) is not None]
    alone = [model for model in alone if tasks[model].span not in told]
    others = standing(tasks) if alone else []
    return [Falling(model, island, [*others]) for model in alone] if 0 < len(others) <= MOST_OBJECTS else []


def standing(tasks: Mapping[str, Task]) -> list[str]:
    """The visible objects with an inside that are no parts of others and that no model moves or is made of."""
    objects = {name: task.kind for name, task in tasks.items() if isinstance(task.kind, Object)}
    aside = {ref.name for kind in objects.values() for ref in kind.members()}
    aside |= {need for task in tasks.values() if isinstance(task.kind, Model) for need in task.needs}
    solid = [name for name, kind in objects.items() if type(kind).implicit is not Object.implicit and not kind.hidden]
    led = {name for name in solid for need in tasks[name].needs if isinstance(tasks[need].kind, Model)}
    return [name for name in solid if name not in aside | led]
