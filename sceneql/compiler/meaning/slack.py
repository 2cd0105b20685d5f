"""Warnings of nets whose springs do not fit: starts far from their rest, masses on no spring, springs too soft."""

from __future__ import annotations

from math import dist, hypot
from typing import Any, cast

from sceneql.compiler.meaning.facts import Facts
from sceneql.compiler.passes.fall_through import pull_of
from sceneql.compiler.passes.unforced import starts_moving
from sceneql.graph import Island, Task
from sceneql.kinds import Interaction, Model
from sceneql.quantities.diagnostic import Diagnostics

SHORT, LONG = 5.0, 20.0
"""Ratio of a spring's rest length to that at the start, and the other way round, from which on it is most likely wrong.
"""
SAG = 20.0
"""Extents of a net by which a spring is lengthened by its weight, from which on it is too soft."""
SHORTEST = 0.5
"""[s] A film that is shorter is most likely a piece of one."""
SEEN = 0.02
"""Strain of a curtain by its weight below which nothing is seen to move."""
STRETCH = 2.0
"""The same of a cloth, as a strain."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of the springs of named masses, and of cloth that hangs."""
    for island in facts.groups:
        forces = [cast(Interaction, one.kind) for one in facts.forces(island)]
        pull = pull_of(forces) if forces else None
        _unheld(facts, island, pull, found)
        for name in island.models:
            task = facts.tasks[name]
            kind: Any = task.kind
            if getattr(kind, "masses", None) and hasattr(kind, "springs"):
                _net(facts, task, island, pull, found)
            elif pull is not None and {"pins", "facing", "stretch"} <= type(kind).model_fields.keys() and kind.pins:
                _hangs(facts, island, task, pull, found)
                strain = kind.mass * hypot(*pull) * kind.size[1] / kind.stretch
                if strain > STRETCH and not kind.tear:
                    text = (
                        f"'{name}' is too soft for its weight: it is stretched to {1.0 + strain:.2g} times its length"
                    )
                    help = f"write `stretch: {_two(20.0 * kind.stretch * strain)} N/m`, or a smaller `mass`"
                    found.warning("too-soft", text, task.span, help=help)


def _hangs(facts: Facts, island: Island, task: Task, pull: tuple[float, ...], found: Diagnostics) -> None:
    """A curtain that hangs by its whole upper side already, at rest: it only stretches a little."""
    kind: Any = task.kind
    down = kind.facing[0] * pull[0] + kind.facing[1] * pull[1] + kind.facing[2] * pull[2]
    strain = kind.mass * hypot(*pull) * kind.size[1] / kind.stretch
    plain = kind.pins == ("top",) and kind.rotation is None and kind.tear is None and pull[0] == pull[2] == 0.0
    if not plain or down or pull[1] >= 0.0 or strain > SEEN or island.contacts or starts_moving(kind):
        return
    if len(island.models) == 1 and facts.whole:
        text = (
            f"'{task.name}' hangs straight down at rest: it stretches by {100.0 * strain:.2g} %, and nothing else moves"
        )
        help = "write `pins: [top_left, top_right]`, a `wind`, or let it start level, `facing: 0 1 0`"
        found.warning("nothing-moves", text, task.span, help=help)


def _unheld(facts: Facts, island: Island, pull: tuple[float, ...] | None, found: Diagnostics) -> None:
    """A net or a solid of elements with weight, alone in its island, that is held nowhere and touches nothing."""
    short = facts.clock.end < SHORTEST
    if pull is None or island.contacts or facts.ties(island) or len(island.models) > 1 or short or not facts.whole:
        return
    task = facts.tasks[island.models[0]]
    kind: Any = task.kind
    told = any(one.span == task.span and one.code in ("falls-through", "nothing-holds") for one in found.found)
    if told or starts_moving(kind) or not {"pins", "hold"} & type(kind).model_fields.keys():
        return
    if (
        getattr(kind, "pins", None)
        or getattr(kind, "hold", None)
        or any(m.fixed for m in kind.static_masses().values())
    ):
        return
    text = f"nothing holds '{task.name}': it falls all the time"
    hold = "`hold: {wall: {where: x < 0.1}}`" if hasattr(kind, "hold") else "`fixed: yes` in a mass, or `pins`"
    help = f"write {hold}, or let it fall onto what is there: `contacts: {{touch: collision}}`"
    found.warning("nothing-holds", text, task.span, help=help)


def _net(facts: Facts, task: Task, island: Island, pull: tuple[float, ...] | None, found: Diagnostics) -> None:
    kind: Any = task.kind
    places = {name: mass.position for name, mass in kind.masses.items()}
    static = cast(Model, kind).static_masses()
    whole = (
        max((dist(a, b) for a in places.values() for b in places.values()), default=0.0) if len(places) < 64 else 0.0
    )
    stiffness = kind.stiffness.number() if kind.stiffness.constant else None
    soft: dict[str, float] = {}
    for spring in kind.springs:
        a, b = spring.between
        if a not in places or b not in places:
            return
        length = dist(places[a], places[b])
        own = spring.stiffness if spring.stiffness is not None else stiffness
        for end in (a, b):
            soft[end] = soft.get(end, 0.0) + (float("inf") if own is None else float(own))
        which = f"the spring of '{a}' and '{b}'"
        rest = spring.rest
        if length == 0.0 and rest:
            text = f"'{a}' and '{b}' start at one place: their spring has no direction"
            found.warning("far-from-rest", text, task.span, help=f"write another `position` of '{b}'")
        if rest is None or rest == 0.0 or length == 0.0:
            continue
        if rest > SHORT * length or length > LONG * rest:
            text = f"{which} is {length:.3g} m long at the start, and {rest:.3g} m without force: it "
            text += f"{'throws them apart' if rest > length else 'pulls them together'}"
            help = f"write `rest: {length:.3g} m`, or leave it out: by default it is the length at the start"
            found.warning("far-from-rest", text, task.span, help=help)
    if pull is None or island.contacts or facts.ties(island) or len(island.models) > 1:
        return
    held = [name for name, mass in static.items() if mass.fixed]
    alone = [name for name, mass in static.items() if name not in soft and not mass.fixed]
    if held and kind.springs:
        for name in alone:
            text = f"'{name}' hangs on no spring: it falls all the time"
            help = f"write a spring, `{{between: [{held[0]}, {name}]}}`"
            found.warning("nothing-holds", text, task.span, help=help)
    for name, mass in static.items():
        if mass.fixed or name in alone or not held or not whole:
            continue
        sag = mass.mass * hypot(*pull) / soft[name]
        if sag > SAG * whole:
            text = f"the springs of '{name}' are too soft for its weight: it hangs {sag:.3g} m lower"
            help = f"write `stiffness: {_two(10.0 * mass.mass * hypot(*pull) / whole)} N/m`, or a smaller mass"
            found.warning("too-soft", text, task.span, help=help)
            break


def _two(number: float) -> str:
    return f"{float(f'{number:.2g}'):g}"
