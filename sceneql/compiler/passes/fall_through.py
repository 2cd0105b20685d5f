"""Warnings of masses that fall into a solid without a contact, and of those that would hit a ground but never fall."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
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
FINE = 8
"""Steps between two instants where there is drag."""
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
            fall = _fall_of(forces, cast(Model, tasks[name].kind))
            if fall is None or tasks[name].span is None:
                continue
            touched = {one: others for one, model, others in island.contacts if model == name}
            known = {other for others in touched.values() for other in others}
            known |= {ref.name for one in touched for ref in cast(Contact, tasks[one].kind).ties()} - {name}
            unknown = [one for one in known - stand.keys() if one in tasks]
            if set(solids) <= known or not (
                all(getattr(tasks[one].kind, "list", None) for one in unknown)
                or (not known & stand.keys() and _all_fall(unknown, tasks, island))
            ):
                continue  # where it meets what is hidden, or moves, is not known; what falls too does not hold it up
            starts = starts_of(cast(Model, tasks[name].kind), tasks, start)[:MOST]
            hit = _first_hit(starts, fall, end, solids, boxes, known, start)
            if hit is not None and hit[0] not in known:
                contact = next(iter(touched), None) or _of(hit[0], tasks)
                of_it = "no contact acts on it" if contact is None else f"'{contact}' is not of both"
                text = f"'{name}' falls into '{hit[0]}' at {hit[1]:.2g} s, and through it: {of_it}"
                between = [ref.name for ref in cast(Contact, tasks[contact].kind).ties()] if contact else []
                more = [one for one in (name, hit[0]) if one not in between]
                help = f"name it there, `between: [{', '.join([*between, *more])}]`" if contact else HELP
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


@dataclass(frozen=True)
class Fall:
    """What moves a mass that falls."""

    pull: tuple[float, ...]
    """Acceleration (3,) [m/s^2]."""
    linear: float = 0.0
    """Drag for a speed, over the mass [1/s]."""
    quadratic: float = 0.0
    """Drag for a squared speed, over the mass [1/m]."""
    blows: tuple[tuple[float, tuple[float, ...]], ...] = ()
    """Instants [s] and changes of the velocity (3,) [m/s]."""

    def way(self, place: Sequence[float], velocity: Sequence[float], times: Sequence[float]) -> list[tuple[float, ...]]:
        """Places (3,) [m] at some times [s], the first of them 0: parabolas where there is nothing but a pull."""
        if not (self.linear or self.quadratic or self.blows):
            return [
                tuple(p + v * t + 0.5 * g * t * t for p, v, g in zip(place, velocity, self.pull, strict=True))
                for t in times
            ]
        x, v, found = [*place], [*velocity], [tuple(place)]
        for before, now in pairwise(times):
            for one in range(FINE):
                at, h = before + (now - before) * one / FINE, (now - before) / FINE
                rate = self.linear + self.quadratic * sum(c * c for c in v) ** 0.5
                for k in range(3):
                    blown = sum(change[k] for instant, change in self.blows if at < instant <= at + h)
                    after = (v[k] + blown + h * self.pull[k]) / (1.0 + h * rate)
                    x[k] += 0.5 * h * (v[k] + after)
                    v[k] = after
            found.append(tuple(x))
        return found


def _fall_of(forces: Sequence[Interaction], kind: Model) -> Fall | None:
    """How masses of a model fall by weights, drags of resting air and blows, all constant; None for other forces."""
    weights = [one for one in forces if one.weighs]
    others = [one for one in forces if not one.weighs]
    if (pull := pull_of(weights)) is None:
        return None
    if not others:
        return Fall(pull)
    bodies = getattr(kind, "bodies", None) or {"": kind}
    masses: set[Any] = {mass.mass for mass in kind.static_masses().values()}
    masses = masses or {getattr(one, "mass", None) for one in bodies.values()}
    mass = masses.pop() if len(masses) == 1 else None
    linear = quadratic = 0.0
    blows = []
    for one in others:
        slow, fast = getattr(one, "linear", None), getattr(one, "quadratic", None)
        value, at = getattr(one, "value", None), getattr(one, "at", None)
        if isinstance(value, Value) and value.constant and isinstance(at, float) and isinstance(mass, float):
            blows.append((at, tuple(float(c) / mass for c in value.number())))
        elif (
            isinstance(slow, Value)
            and isinstance(fast, Value)
            and slow.constant
            and fast.constant
            and not {"velocity", "circulation", "size"} & type(one).model_fields.keys()
            and isinstance(mass, float)
        ):
            linear += float(slow.number()) / mass
            quadratic += float(fast.number()) / mass
        else:
            return None
    return Fall(pull, linear, quadratic, tuple(blows))


def _of(solid: str, tasks: Mapping[str, Task]) -> str | None:
    """The first contact that names a solid, or is of all things."""
    contacts = {name: task.kind for name, task in tasks.items() if isinstance(task.kind, Contact)}
    return next((name for name, kind in contacts.items() if solid in {ref.name for ref in kind.ties()}), None)


def _all_fall(names: Sequence[str], tasks: Mapping[str, Task], island: Island) -> bool:
    """Whether some parts are models of an island, or objects that these move, with a weight and with nothing held."""
    weighed = {model for force, model in island.forces if cast(Interaction, tasks[force].kind).weighs}
    movers = {need for name in names for need in (name, *tasks[name].needs) if isinstance(tasks[need].kind, Model)}
    tied = {model for force, model in island.forces if isinstance(tasks[force].kind, Tie)}
    kinds = [tasks[one].kind for one in movers]
    bodies = [body for kind in kinds for body in (getattr(kind, "bodies", None) or {"": kind}).values()]
    held = any(getattr(kind, field, None) for kind in kinds for field in HOLDING)
    fixed = held or any(getattr(body, "fixed", False) for body in bodies)
    return (
        bool(movers)
        and movers <= weighed - tied
        and not fixed
        and all(name in movers or movers & {*tasks[name].needs} for name in names)
    )


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
    fall: Fall,
    end: float,
    solids: Mapping[str, Any],
    boxes: dict[str, Any],
    touched: Collection[str],
    start: Any,
) -> tuple[str, float] | None:
    """The solid that is first on the ways of masses that start outside of it, and the instant [s].

    Those that they touch are met as soon as they are in reach.
    """
    times = [end * k / (INSTANTS - 1) for k in range(INSTANTS)]
    hits = []
    for place, velocity, reach in starts:
        way = fall.way(place, velocity, times)
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
