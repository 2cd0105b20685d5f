"""Warnings of masses that fall into a solid without a contact, and of those that would hit a ground but never fall."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any, cast

from sceneql.compiler.passes.fillings import Beginning
from sceneql.compiler.passes.overlaps import UNKNOWN, field_at
from sceneql.compiler.passes.unforced import starts_moving
from sceneql.compiler.passes.unseen import ground_level, level_of
from sceneql.compiler.values_below import values_of
from sceneql.graph import Island, Task
from sceneql.kinds import Contact, Interaction, Model, Object, Ref, Tie, Value
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.run.falling import HELP, MOST_OBJECTS, standing

Start = tuple[tuple[float, ...], tuple[float, ...], float]

INSTANTS = 64
"""Number of instants at which a mass is looked for in a solid."""
MOST = 32
"""Largest number of masses of a model that are looked at, the first ones."""
RADIUS = 0.05
"""Radius [m] of a mass that says none."""
HOLDING = ("pins", "hold", "emit", "bent")
"""Fields of a model with which its middle does not fall as a stone does."""


def warn_of_falling_through(
    tasks: Mapping[str, Task], groups: Sequence[Island], end: float, found: Diagnostics
) -> None:
    """Warn of each model that falls into a solid of the script before the ``end`` [s], without a contact."""
    start: Any = Beginning(tasks)
    stand = {name: tasks[name].kind for name in standing(tasks)}
    solids = {
        name: kind
        for name, kind in stand.items()
        if tasks[name].span is not None and all(value.constant for value in values_of(kind))
    }
    boxes: dict[str, Any] = {}
    for island in groups if 0 < len(solids) <= MOST_OBJECTS else ():
        for name in island.models:
            forces = [cast(Interaction, tasks[force].kind) for force, model in island.forces if model == name]
            pull = pull_of(forces)
            if pull is None or tasks[name].span is None:
                continue
            touched = {one: others for one, model, others in island.contacts if model == name}
            known = {other for others in touched.values() for other in others}
            known |= {ref.name for one in touched for ref in cast(Contact, tasks[one].kind).ties()} - {name}
            unknown = [tasks[one].kind for one in known - stand.keys() if one in tasks]
            if set(solids) <= known or not all(getattr(kind, "list", None) for kind in unknown):
                continue  # where it meets what is hidden, or moves, is not known; single masses do not hold it up
            starts = starts_of(cast(Model, tasks[name].kind), tasks, start)[:MOST]
            hit = _first_hit(starts, pull, end, solids, boxes, known, start)
            if hit is not None and hit[0] not in known:
                contact = next(iter(touched), None)
                of_it = "no contact acts on it" if contact is None else f"'{contact}' is not of both"
                text = f"'{name}' falls into '{hit[0]}' at {hit[1]:.2g} s, and through it: {of_it}"
                between = [ref.name for ref in cast(Contact, tasks[contact].kind).ties()] if contact else []
                help = f"name it there, `between: [{', '.join([*between, hit[0]])}]`" if contact else HELP
                found.warning("falls-through", text, tasks[name].span, help=help)


def warn_of_unpulled(tasks: Mapping[str, Task], groups: Sequence[Island], found: Diagnostics) -> None:
    """Warn of each model that no force pulls down to the ground, the only thing that stands still and that it hits."""
    ground = ground_level(tasks)
    level = 0.0 if ground is None else ground
    forces = [task for task in tasks.values() if isinstance(task.kind, Interaction) and not isinstance(task.kind, Tie)]
    start: Any = Beginning(tasks)
    for island in groups if ground is not None and not forces else ():
        for name in island.models:
            task, hit = (
                tasks[name],
                {other for _, model, others in island.contacts if model == name for other in others},
            )
            still = {other for other in hit if tasks[other].original is None}
            if not still or task.span is None or not all(getattr(tasks[one].kind, "grounds", False) for one in still):
                continue
            starts = starts_of(cast(Model, task.kind), tasks, start) if starts_moving(task.kind) else []
            if starts and all(v[1] >= 0.0 and place[1] - level > 1.5 * reach for place, v, reach in starts):
                text = f"'{name}' never comes down to '{min(still)}': no force acts on it"
                found.warning("nothing-falls", text, task.span, help="write `forces: [gravity]`")


def warn_of_unheld(tasks: Mapping[str, Task], groups: Sequence[Island], found: Diagnostics) -> None:
    """Warn of each cloth with weight, alone in its island, that is pinned nowhere and touches nothing."""
    for island in groups:
        task = tasks[island.models[0]]
        pinnable = {"pins", "facing"} <= type(task.kind).model_fields.keys()
        if len(island.models) > 1 or not pinnable or getattr(task.kind, "pins", None) or island.contacts:
            continue
        forces = [tasks[force].kind for force, _ in island.forces]
        told = any(one.code == "falls-through" and one.span == task.span for one in found.found)
        if task.span is None or told or any(isinstance(one, Tie) for one in forces):
            continue
        if any(isinstance(one, Interaction) and one.weighs for one in forces):
            text = f"nothing holds '{task.name}': it falls all the time"
            help = (
                "write `pins: [top_left, top_right]`, or let it fall onto what is there: `contacts: {touch: collision}`"
            )
            found.warning("nothing-holds", text, task.span, help=help)


def pull_of(forces: Sequence[Interaction]) -> tuple[float, ...] | None:
    """The constant acceleration [m/s^2] by weights, where nothing else acts; else None."""
    total = (0.0, 0.0, 0.0)
    for force in forces:
        whole, size, way = (getattr(force, field, None) for field in ("acceleration", "strength", "direction"))
        given = (whole,) if whole is not None else (size, way)
        if not force.weighs or not all(isinstance(one, Value) and one.constant for one in given):
            return None
        vector = cast(Value, given[-1]).number()
        length = sum(c * c for c in vector) ** 0.5 or 1.0
        scale = 1.0 if whole is not None else float(cast(Value, size).number()) / length
        total = cast(Any, tuple(a + scale * float(c) for a, c in zip(total, vector, strict=True)))
    return total if any(total) else None


def starts_of(kind: Model, tasks: Mapping[str, Task], start: Any) -> list[Start]:
    """Places [m], velocities [m/s] and reaches [m] of what falls as stones do; none where something holds it."""
    known = kind.static_masses()
    if any(getattr(kind, field, None) for field in HOLDING) or any(mass.fixed for mass in known.values()):
        return []
    return [*_started(kind, tasks, start)]


def _started(kind: Any, tasks: Mapping[str, Task], start: Any) -> Iterator[Start]:
    still = (0.0, 0.0, 0.0)
    bodies = getattr(kind, "bodies", None) or {"": kind}
    driven = {body.of.name: body for body in bodies.values() if isinstance(getattr(body, "of", None), Ref)}
    for name, body in driven.items():
        at, velocity = getattr(body, "position", None), body.velocity or getattr(kind, "velocity", None) or still
        shape = tasks[name].original or tasks[name].kind
        import numpy as np  # here, where a check needs it

        try:
            low, high = cast(Object, shape).extent(np.eye(3, 4), start)
        except UNKNOWN:
            continue
        if np.isfinite(high - low).all() and not getattr(body, "fixed", False):
            yield (at or tuple(((low + high) / 2).tolist())), velocity, float((high - low).max()) / 2
    each = getattr(kind, "list", None) or {}
    for name, mass in kind.static_masses().items() if not driven else ():
        if mass.position is not None:
            own = getattr(each.get(name), "radius", None) or getattr(kind, "radius", None)
            yield mass.position, mass.velocity or still, RADIUS if own is None else own
    for part in (kind, *(getattr(kind, field, None) for field in ("cloth", "lattice"))):
        center = getattr(part, "center", None)
        if isinstance(center, tuple) and not driven:
            yield center, kind.velocity, max(getattr(part, "size", (0.0,))) / 2


def _first_hit(
    starts: Sequence[Start],
    pull: tuple[float, ...],
    end: float,
    solids: Mapping[str, Any],
    boxes: dict[str, Any],
    touched: Collection[str],
    start: Any,
) -> tuple[str, float] | None:
    """The solid that is first on the parabolas of masses that start outside of it, and the instant [s].

    Those that they touch are met as soon as they are in reach.
    """
    times = [end * k / (INSTANTS - 1) for k in range(INSTANTS)]
    hits = []
    for place, velocity, reach in starts:
        way = [tuple(p + v * t + 0.5 * g * t * t for p, v, g in zip(place, velocity, pull, strict=True)) for t in times]
        for name, solid in solids.items():
            if name not in boxes:
                boxes[name] = _box(solid, start)
            inside = _inside(solid, boxes[name], way, reach if name in touched else 0.0, start)
            if any(inside) and (name in touched or not inside[0]):
                hits.append((times[inside.index(True)], name))
    return None if not hits else (min(hits)[1], min(hits)[0])


def _box(solid: Any, start: Any) -> Any:
    """Corners [m] of the box of a solid that stands; None where it is not known."""
    import numpy as np  # here, where a check needs it

    with np.errstate(all="ignore"):
        try:
            return solid.extent(np.eye(3, 4), start)
        except UNKNOWN:
            return None


def _inside(solid: Any, box: Any, way: Sequence[tuple[float, ...]], reach: float, start: Any) -> list[bool]:
    """Whether each of some places [m] is in a solid, or within a distance of it; nowhere where that is not known."""
    if (level := level_of(solid)) is not None:
        return [y <= level + reach for _, y, _ in way]
    import numpy as np  # here, where a check needs it

    places = np.array(way)
    near = np.ones(len(way), dtype=bool)
    if box is not None:
        near = ((places >= box[0] - reach) & (places <= box[1] + reach)).all(axis=1)
    if near.any():
        try:
            near[near] = field_at(solid, places[near], start) <= reach
        except UNKNOWN:
            near[:] = False
    return [bool(one) for one in near]
