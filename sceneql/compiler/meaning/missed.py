"""Warnings of contacts that nothing comes to, and of masses that pass through one another for want of one."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, pairwise
from math import ceil, dist, hypot, sqrt
from typing import Any, cast

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.compiler.passes.fall_through import pull_of, starts_of
from sceneql.compiler.passes.fillings import Beginning
from sceneql.compiler.passes.overlaps import UNKNOWN
from sceneql.compiler.passes.unseen import level_of
from sceneql.compiler.values_below import values_of
from sceneql.graph import Island, Task
from sceneql.kinds import Contact, Interaction, Model
from sceneql.quantities.diagnostic import Diagnostics

Start = tuple[tuple[float, ...], tuple[float, ...], float]

INSTANTS = 48
"""Number of instants at which a mass is looked for beside a solid."""
MOST = 24
"""Largest number of masses that are looked at."""
SHORTEST = 1.0
"""[s] A film that is shorter is most likely a piece of one."""
FALL = 4.0
"""Way of a fall over the height at the start, and a meter, from which on a body has come down."""
CLOSE = 0.5
"""Part of the sum of two radii below which two masses certainly meet."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each contact of masses whose ways are known."""
    start: Any = Beginning(facts.tasks)
    for island in facts.groups:
        if not island.contacts or facts.ties(island) or _many(facts, island):
            continue
        forces = [cast(Interaction, one.kind) for one in facts.forces(island)]
        pull = pull_of(forces) if forces else (0.0, 0.0, 0.0)
        if pull is None or _lands(facts, island, pull):
            continue
        starts = {name: starts_of(facts.models[name], facts.tasks, start) for name in island.models}
        if not all(starts.values()) or sum(map(len, starts.values())) > MOST:
            continue
        _missed(facts, island, starts, pull, start, found)
    _through(facts, start, found)


def _lands(facts: Facts, island: Island, pull: tuple[float, ...]) -> bool:
    """Whether all bodies certainly fall much farther than they start high, as most do: no more is asked then."""
    fall = -0.5 * pull[1] * facts.clock.end**2
    driven = [facts.objects.get(name) for model in island.models for name in facts.models[model].drives()]
    places = [constant(getattr(kind, "position", None)) for kind in driven]
    return bool(places) and all(at is not None and fall > FALL * (1.0 + abs(at[1])) for at in places)


def _many(facts: Facts, island: Island) -> bool:
    """Whether an island has more masses than are looked at."""
    return sum(max(len(facts.models[m].drives()), len(facts.models[m].static_masses())) for m in island.models) > MOST


def _missed(
    facts: Facts,
    island: Island,
    starts: dict[str, list[Start]],
    pull: tuple[float, ...],
    start: Any,
    found: Diagnostics,
) -> None:
    """Contacts that no mass of the island comes to until the clock ends."""
    end = facts.clock.end
    others = {other for _, _, some in island.contacts for other in some}
    kinds = {other: facts.tasks[other] for other in others}
    every = [one for some in starts.values() for one in some]
    if end < SHORTEST or not others or any(task.original is not None for task in kinds.values()):
        return
    if not all(value.constant for task in kinds.values() for value in values_of(task.kind)):
        return
    told = [one.span for one in found.found if one.code == "nothing-falls"]
    if any(facts.tasks[name].span is None for name, _, _ in island.contacts):
        return
    if any(facts.tasks[name].span in told for name in island.models):
        return
    together = [_nearest(a, b, end) < 1.5 * (a[2] + b[2]) for a, b in combinations(every, 2)]
    grounds = sorted(others, key=lambda name: level_of(facts.tasks[name].kind) is None)  # these first, without arrays
    if any(together) or any(_comes(facts.tasks[other], one, pull, end, start) for other in grounds for one in every):
        return
    contact = facts.tasks[island.contacts[0][0]]
    first = next(iter(starts))
    for other in sorted(others, key=lambda name: not facts.written(name)):
        level = level_of(facts.tasks[other].kind)
        times = [] if level is None else [_landing(one, pull, level) for one in starts[first]]
        if times and all(time is not None for time in times):
            when = min(time for time in times if time is not None)
            text = f"'{first}' comes down to '{other}' at {when:.3g} s, and the clock ends at {end:g} s"
            help = f"write `clock: {{end: {ceil(1.5 * when):g} s}}`, or let it start lower"
            found.warning("never-touches", text, facts.tasks[first].span, help=help)
            return
    other = min(others)
    if any(facts.tasks[one].span is None for one in others) or not any(any(one[1]) for one in every):
        return
    text = f"'{first}' never touches '{other}': it moves past or away from it"
    help = f"turn its velocity, or let '{contact.name}' be between others"
    found.warning("never-touches", text, facts.tasks[first].span, help=help)


def _comes(task: Task, one: Start, pull: tuple[float, ...], end: float, start: Any) -> bool:
    """Whether a mass may come to an object that stands."""
    place, velocity, reach = one
    times = [end * k / INSTANTS for k in range(INSTANTS + 1)]
    way = [tuple(p + v * t + 0.5 * g * t * t for p, v, g in zip(place, velocity, pull, strict=True)) for t in times]
    margin = reach + max(dist(a, b) for a, b in pairwise(way))
    if (level := level_of(task.kind)) is not None:
        return min(at[1] for at in way) - level <= margin
    import numpy as np  # here, where a mass is near an object

    try:
        with np.errstate(all="ignore"):
            low, high = cast(Any, task.kind).extent(np.eye(3, 4), start)
    except UNKNOWN:
        return True
    gaps = [hypot(*(max(a - c, c - b, 0.0) for a, b, c in zip(low, high, at, strict=True))) for at in way]
    return not min(gaps) > margin


def _landing(one: Start, pull: tuple[float, ...], level: float) -> float | None:
    """When a mass comes down to a level ground [s]; None where it does not."""
    (_, y, _), (_, v, _), reach = one
    height, g = y - reach - level, -pull[1]
    if height <= 0.0:
        return None
    if g <= 0.0:
        return height / -v if v < 0.0 else None
    return (v + sqrt(v * v + 2.0 * g * height)) / g


def _nearest(one: Start, other: Start, end: float) -> float:
    """Least distance [m] of two masses that the same weight pulls."""
    away = [a - b for a, b in zip(one[0], other[0], strict=True)]
    speed = [a - b for a, b in zip(one[1], other[1], strict=True)]
    square = sum(v * v for v in speed)
    when = 0.0 if square == 0.0 else min(max(-sum(x * v for x, v in zip(away, speed, strict=True)) / square, 0.0), end)
    return hypot(*(x + v * when for x, v in zip(away, speed, strict=True)))


def _through(facts: Facts, start: Any, found: Diagnostics) -> None:
    """Masses of contacts with objects that meet one another, where no contact is of masses."""
    contacts = list(facts.of(Contact))
    if not contacts or any(task.kind.mutual for task in contacts):  # type: ignore[attr-defined]
        return
    if any(constant(getattr(task.kind, "friction", None)) != 0.0 for task in contacts):
        return
    known: list[tuple[str, Start]] = []
    pulls = []
    for island in facts.groups:
        forces = [cast(Interaction, one.kind) for one in facts.forces(island)]
        pull = pull_of(forces) if forces else (0.0, 0.0, 0.0)
        models = [facts.tasks[name] for name in island.models]
        plain = all(isinstance(t.kind, Model) and t.kind.inert and not t.kind.turns for t in models)
        if not island.contacts or pull is None or not plain or facts.ties(island) or _many(facts, island):
            continue
        pulls.append(pull)
        for task in models:
            known += [(task.name, one) for one in starts_of(cast(Model, task.kind), facts.tasks, start)]
    if len(known) > MOST or len(set(pulls)) > 1:
        return
    pair = _meeting(known, facts.clock.end)
    if pair is not None:
        one, other = pair
        which = f"'{one}' and '{other}'" if one != other else f"masses of '{one}'"
        text = f"{which} meet, and pass through one another: '{contacts[0].name}' is of masses with objects"
        help = "write beside it `contacts: {hit: {mutual_collision: {restitution: 1}}}`"
        found.warning("never-touches", text, contacts[0].span, help=help)


def _meeting(known: Sequence[tuple[str, Start]], end: float) -> tuple[str, str] | None:
    for (a, one), (b, other) in combinations(known, 2):
        both = one[2] + other[2]
        if dist(one[0], other[0]) > both and _nearest(one, other, end) < CLOSE * both:
            return a, b
    return None
