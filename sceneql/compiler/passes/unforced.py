"""Warnings of scenes in which nothing moves: forces without masses, masses without a force, fields that are even or lie
outside of their box."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from math import dist, isfinite, log
from typing import Any, cast

from pydantic import BaseModel

from sceneql.compiler.passes.doubts import GRAVITATION
from sceneql.compiler.values_below import values_of
from sceneql.graph import Island, Task
from sceneql.kinds import Contact, Formula, Interaction, Kind, Model, Object, Tie, Value
from sceneql.kinds.stable_step import StaticMass
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Number

Ends = list[tuple[float, float]]
UNSEEN = 0.01
"""Angle [rad] by which masses turn about each other, below which nobody sees their pull."""
MANY = 1e12
"""Seconds from which on they are told in powers of ten."""
SEEN = 0.2
"""Part of a cell that a field has to spread by for the change to be seen."""
ALIKE = 0.2
"""Relative difference of the constant of a circle from the one that is there, up to which this one was meant."""
CHANGING = ("source", "drift", "boundary", "velocity", "rate", "species")
"""Fields by which a field that is even at the start changes."""
FINE = 16
"""Number of places along each side of a box at which its start is looked at."""
STARTS = ("velocity", "spin")
"""Fields that let masses or bodies move at the start."""
FAINT = 1e-6
"""The largest value in a box, relative to the one on top of the hill, below which nothing is seen inside."""
STEP = 1.0 / 64.0
"""Distance at which the curvature of a logarithm is taken, in parts of a side of the box."""


def warn_of_unforced(tasks: Mapping[str, Task], groups: Sequence[Island], found: Diagnostics) -> None:
    """Warn of forces and contacts where no model has masses, and of models that nothing moves.

    ``groups``: the islands of the models.
    """
    solved = [task for task in tasks.values() if isinstance(task.kind, Model) and not task.kind.kinematic]
    moved = [task.name for task in tasks.values() if isinstance(task.kind, Object) and not task.kind.grounds]
    acting = [t for t in tasks.values() if isinstance(t.kind, Interaction | Contact) and not isinstance(t.kind, Tie)]
    some = [ref for task in acting if isinstance(task.kind, Interaction) for ref in task.kind.targets() or ()]
    led = any(not value.constant for task in tasks.values() if leads(task) for value in values_of(task.kind))
    for task in acting[:1] if moved and not solved and not led else ():
        text = f"'{task.name}' acts on masses, and no model has any: nothing moves"
        help = f"a model moves an object: `models: {{fall: {{particles: {{of: {moved[0]}, mass: 1 kg}}}}}}`"
        found.warning("nothing-moves", text, task.span, help=help)
    for island in groups:
        models = [tasks[name] for name in island.models]
        if len(solved) == len(models) and all(map(_held, models)):
            text = f"all masses of '{models[0].name}' are fixed: nothing moves"
            help = "leave out `fixed: yes` of those that should move"
            found.warning("nothing-moves", text, models[0].span, help=help)
        elif (
            all(isinstance(task.kind, Model) and task.kind.inert for task in models)
            and not (island.forces or (led and island.contacts))
            and not any(starts_moving(task.kind) for task in models)
        ):
            text = f"no force acts on '{models[0].name}', and it starts at rest: it stays where it is"
            help = "write `forces: [gravity]`, or give it a `velocity`"
            if some:
                help = f"name it, too, where a force is `on: [{some[0]}]`: `on: [{some[0]}, {models[0].name}]`"
            found.warning("nothing-moves", text, models[0].span, help=help)


def warn_of_even(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of fields in a box whose formula for the start is one number at all places, where nothing comes in."""
    for task, initial, ends in _fields(tasks):
        if isinstance(initial.expr, Number) or any(getattr(task.kind, field, None) for field in CHANGING):
            continue
        values = {*_sampled(initial, ends)}
        if len(values) == 1 and None not in values:
            text = f"'{task.name}' is {values.pop():g} at all places at the start, and nothing comes in: it stays so"
            help = f"in its box goes {_box(ends)}: let the formula differ there"
            found.warning("nothing-moves", text, initial.span or task.span, help=help)


def _fields(tasks: Mapping[str, Task]) -> Iterator[tuple[Task, Formula, Ends]]:
    """Models of fields in boxes that start by a formula, with this and the ends of the box along each axis [m]."""
    for task in tasks.values():
        kind: Any = task.kind
        initial, size = getattr(kind, "initial", None), getattr(kind, "size", None)
        if isinstance(kind, Model) and isinstance(initial, Formula) and size and not kind.flows:
            corner = getattr(kind, "corner", None) or (0.0,) * len(size)
            yield task, initial, [(low, low + side) for low, side in zip(corner, size, strict=True)]


def _box(ends: Ends) -> str:
    return ", ".join(f"{axis} from {low:g} to {high:g}" for axis, (low, high) in zip("xyz", ends, strict=False))


def _sampled(initial: Formula, ends: Ends) -> Iterator[float | None]:
    """A formula's values at places of a box, on a lattice; None, and then no more, where one is not known."""
    steps = [[low + (high - low) * (k + 0.5) / FINE for k in range(FINE)] for low, high in ends]
    for place in product(*steps):
        yield (value := _value(initial, place))
        if value is None:
            return


def warn_of_outside(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of each field in a box that is exp(-(x - a)^2 ...) at the start, of a place a outside of the box."""
    for task, initial, ends in _fields(tasks):
        top = _top(initial, ends)
        if top is None or all(low <= at <= high for at, (low, high) in zip(top, ends, strict=True)):
            continue
        nearest = [min(max(at, low), high) for at, (low, high) in zip(top, ends, strict=True)]
        inside, outside = _value(initial, nearest), _value(initial, top)
        if inside is None or outside is None or not 0.0 <= inside < FAINT * outside:
            continue
        text = f"'{task.name}' is at most {inside:.2g} in its box at the start, and {outside:.3g}"
        text += f" at {', '.join(f'{at:.3g}' for at in top)} outside"
        help = f"places in formulas are in meters, here {_box(ends)}: put its middle there"
        found.warning("outside-box", text, initial.span or task.span, help=help)


def _top(initial: Formula, ends: Ends) -> tuple[float, ...] | None:
    """Where the formula is largest if its logarithm is of second order along each axis; None where it is not known."""
    middle = [(low + high) / 2 for low, high in ends]
    top = list(middle)
    for k, (low, high) in enumerate(ends):
        step, logs = STEP * (high - low), []
        for m in (-1, 0, 1):
            value = _value(initial, [at + (m * step if j == k else 0.0) for j, at in enumerate(middle)])
            if value is None or value <= 0.0:
                return None
            logs.append(log(value))
        bend = logs[0] - 2 * logs[1] + logs[2]
        if bend < 0.0:
            top[k] -= step * (logs[2] - logs[0]) / (2 * bend)
    return tuple(top) if all(map(isfinite, top)) else None


def _value(initial: Formula, place: Sequence[float]) -> float | None:
    """The formula at a place; None where it reads more than the place, or is no number."""
    known = {"x": 0.0, "y": 0.0, "z": 0.0, "t": 0.0, **dict(zip("xyz", place, strict=False))}

    def look_up(node: Any) -> float:
        return known[node.name]

    try:
        return float(evaluate(initial.expr, look_up))
    except (AttributeError, KeyError, TypeError, ValueError, ArithmeticError):
        return None


def warn_of_weak(tasks: Mapping[str, Task], groups: Sequence[Island], end: float, found: Diagnostics) -> None:
    """Warn of masses that nothing but their pull on each other moves, too weakly to be seen until the ``end`` [s]."""
    for island in groups:
        forces = [tasks[name] for name, _ in island.forces]
        if not forces or not all(isinstance(one.kind, Interaction) and one.kind.mutual for one in forces):
            continue
        on = {name: cast(Model, tasks[name].kind).static_masses() for name in island.models}
        each = [[one.frequency for one in cast(Interaction, force.kind).fastest(force.name, on)] for force in forces]
        if not all(rates and max(rates) * end < UNSEEN for rates in each):
            continue  # one of them moves the masses, or may: the others may well be weak beside it
        for force in forces:
            own = getattr(force.kind, "constant", None)
            text = f"'{force.name}' is too weak to be seen: until {end:g} s it bends no way by as much as a part in"
            help = "write a stronger one, or a longer clock"
            if isinstance(own, Value) and own.expr.type.dimension == GRAVITATION:
                constant, why = _circling([mass for of in on.values() for mass in of.items()])
                help = f"masses of kg are pulled in seconds by `{force.word}: {{constant: {constant} m^3/kg/s^2}}`"
                help += f"{why}, or write larger masses, or a longer clock"
                if own.constant and abs(float(constant) - own.number()) < ALIKE * own.number():
                    help = f"write a longer clock, `clock: {{end: 1 year, speed: 1e6}}`: its constant is right{why}"
            found.warning("nothing-moves", f"{text} {1 / UNSEEN**2:.0g}", force.span, help=help)


def warn_of_slow(tasks: Mapping[str, Task], end: float, found: Diagnostics) -> None:
    """Warn of fields that spread by less than a cell until the ``end`` [s], and that nothing else changes."""
    for task in tasks.values():
        kind = task.kind
        spread, cell = getattr(kind, "coefficient", None), getattr(kind, "cell", None)
        if not isinstance(kind, Model) or not isinstance(spread, Formula) or not isinstance(cell, float):
            continue
        cell = min(cell, *(getattr(kind, "size", None) or (cell,)))
        still = getattr(kind, "drift", None) is None and getattr(kind, "source", None) is None
        if still and isinstance(spread.expr, Number) and isinstance(spread.expr.value, float | int):
            way = (2.0 * max(float(spread.expr.value), 0.0) * end) ** 0.5
            if 0.0 < way < SEEN * cell:
                text = f"'{task.name}' spreads by {way:.1g} m until {end:g} s, far less than a cell: nothing moves"
                needed = end * (cell / way) * (cell / way)
                longer = f"`clock: {{end: {needed:{'.0f' if needed < MANY else '.3g'}} s, speed: ...}}`"
                help = f"for a cell take {longer}, or smaller cells, or a larger `coefficient`"
                found.warning("nothing-moves", text, task.span, help=help)


def _circling(masses: Sequence[tuple[str, StaticMass]]) -> tuple[str, str]:
    """The constant by which a mass circles the heaviest at its speed, v^2 r/M in SI, and which one that is; else 1."""
    placed = sorted((one for one in masses if one[1].position is not None), key=lambda one: -one[1].mass)
    for name, mass in placed[1:]:
        (center, heavy), away = placed[0], dist(mass.position or (), placed[0][1].position or ())
        speed = dist(mass.velocity or (0.0,) * 3, heavy.velocity or (0.0,) * 3)
        if speed * away > 0.0 and heavy.mass > 0.0 and name and center:
            return f"{speed * speed * away / heavy.mass:.2g}", f", with which '{name}' circles '{center}'"
    return "1", ""


def leads(task: Task) -> bool:
    """Whether a part may carry or push masses: an object that no model moves, or a kinematic model."""
    if isinstance(task.kind, Model):
        return task.kind.kinematic
    return isinstance(task.kind, Object) and task.original is None


def _held(task: Task) -> bool:
    """Whether a model has masses by name, all of which are fixed."""
    named = [one for name in ("list", "masses", "bodies") for one in (getattr(task.kind, name, None) or {}).values()]
    return bool(named) and all(getattr(one, "fixed", False) for one in named)


def starts_moving(part: Any) -> bool:
    """Whether a velocity or spin at the start, in a kind or a record at any depth, is not zero."""
    return any(_nonzero(value) for value in _velocities(part))


def _velocities(part: Any) -> Iterator[Any]:
    if isinstance(part, Kind | BaseModel):
        for name, value in part:
            if name in STARTS:
                yield value
            else:
                yield from _velocities(value)
    elif isinstance(part, dict):
        for value in part.values():
            yield from _velocities(value)


def _nonzero(value: Any) -> bool:
    if isinstance(value, Value):
        return not value.constant or any(value.number())
    return isinstance(value, tuple | list) and any(value)
