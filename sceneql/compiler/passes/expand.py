"""Default parts: an output, camera, light, floor and solver are added by name where the script has none."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any, cast

from sceneql.compiler.catalogue import Catalogue
from sceneql.compiler.passes.own_shapes import own_shapes
from sceneql.compiler.passes.stand_ins import stand_ins
from sceneql.graph import Task
from sceneql.kinds import Camera, Contact, Interaction, Kind, Light, Model, Object, Output, Picture, Solver, Value
from sceneql.quantities.dimension import LENGTH
from sceneql.quantities.expression import Link, Number, Type

LOOKS = {"material", "color", "hidden"}
ROUNDING = 1e-12
"""Part of its size by which an object that stands on the height 0 may be lower."""
"""Fields by which a script says that an object is to be seen, or not."""


def expand(
    tasks: Mapping[str, Task],
    catalogue: Catalogue,
    *,
    without: Collection[str] = (),
    implied: Collection[str] = (),
    background: bool = False,
) -> dict[str, Task]:
    """The parts, with default parts added; objects that a model drives are linked to it.

    ``without``: names of default parts that the script declines; ``implied``: names of those that it refers to without
    writing them, such as a floor, which is then put at the default height. ``background``: whether the script has a
    background of its own.
    """
    result = dict(tasks)
    for name in implied:
        at_level = result[name].kind.model_copy(update={"height": _level(result)})
        result[name] = replace(result[name], kind=at_level)

    def has(family: type[Kind]) -> bool:
        return any(isinstance(task.kind, family) for task in result.values())

    def add(name: str, family: str, word: str, **fields: Any) -> None:
        cls = catalogue.load(family, word)
        if cls is None:
            raise LookupError(f"the default {word} of {family} is missing")
        while name in result:
            name += "_"
        result[name] = Task(name, word, cls(**fields), None)

    if not has(Output):
        add("film", "outputs", "video")
    if has(Picture) and not has(Camera):
        add("camera", "cameras", "auto")
    unlit = has(Picture) and not has(Light)
    if "floor" not in without and not any(isinstance(t.kind, Object) and t.kind.grounds for t in result.values()):
        if any(isinstance(t.kind, Contact) and not t.kind.ties() for t in result.values()):
            add("floor", "objects", "plane", height=_level(result))
        elif not background and _staged(result):
            add("floor", "objects", "ground")
    if unlit:
        add("light", "lights", "studio", backdrop="dark" if not background and _in_the_dark(result) else "light")
    if any(isinstance(t.kind, Model) and not t.kind.kinematic for t in result.values()) and (
        not any(isinstance(t.kind, Solver) and t.kind.on is None for t in result.values())
    ):
        add("solver", "solvers", "auto")
    driven = _drive(own_shapes(stand_ins(result), catalogue))
    draws = any(isinstance(task.kind, Output) and task.kind.draws for task in driven.values())
    return _show(driven, catalogue) if draws else driven


def _level(tasks: Mapping[str, Task]) -> Value:
    """The height of the ground for contacts: 0, or the lowest start of a model or of an object that a model drives."""
    models = [task.kind for task in tasks.values() if isinstance(task.kind, Model)]
    lows = [model.lowest() for model in models]
    lows += [_bottom(tasks[name].kind) for model in models for name in model.drives() if name in tasks]
    return Value(Number(min([0.0, *(low for low in lows if low is not None)]), Type((), LENGTH)))


def _bottom(kind: Kind) -> float | None:
    """The least height [m] of an object by its position and its radius or sizes, where these are constant; else None.

    What is turned counts as a ball around it.
    """
    fields = {name: getattr(kind, name, None) for name in ("position", "radius", "size", "height", "rotation")}
    known = {name: value for name, value in fields.items() if isinstance(value, Value) and value.constant}
    if "position" not in known:
        return None
    deep = float(known["radius"].number()) if "radius" in known else 0.0
    if "size" in known or "height" in known:
        x, y, z = known["size"].number() if "size" in known else (2.0 * deep, known["height"].number(), 2.0 * deep)
        upright = "rotation" in known and abs(known["rotation"].number()[0]) == 1.0
        deep = 0.5 * float(y if upright else math.hypot(x, y, z))
    low = float(known["position"].number()[1]) - deep
    return low if low < -ROUNDING * deep else max(low, 0.0)


def _staged(tasks: Mapping[str, Task]) -> bool:
    """Whether pictures show a ground without contact: where something falls, or nothing is simulated."""
    kinds = [task.kind for task in tasks.values()]
    lights = [kind for kind in kinds if isinstance(kind, Light)]
    if not any(isinstance(kind, Picture) for kind in kinds) or not all(light.stages for light in lights):
        return False
    solved = any(isinstance(kind, Model) and not kind.kinematic for kind in kinds)
    return any(isinstance(kind, Interaction) and kind.weighs for kind in kinds) or not solved


def _in_the_dark(tasks: Mapping[str, Task]) -> bool:
    """Whether the picture has no ground, and something that is seen before the dark."""
    kinds = [task.kind for task in tasks.values()]
    grounded = any(isinstance(kind, Object) and kind.grounds for kind in kinds)
    return not grounded and any(kind.darkens() for kind in kinds)


def _show(tasks: dict[str, Task], catalogue: Catalogue) -> dict[str, Task]:
    """Add what draws each model of fields that no object reads; objects that would hide it are hidden.

    Of a flow and the fields in the same box that it carries one is drawn: what an object reads, else a field. Nor is a
    flow drawn that is the wind of masses, or, if it is deep, around skins.
    """
    _uncover(tasks)
    fields = {task.name: task for task in tasks.values() if isinstance(task.kind, Model) and task.kind.drawn_by("")}
    read = {need for task in tasks.values() if isinstance(task.kind, Object) for need in task.needs}
    forces = [task for task in tasks.values() if isinstance(task.kind, Interaction)]
    around = {flow.name for task in forces if (flow := cast(Interaction, task.kind).carrier()) is not None}
    for task in fields.values():
        if task.name in read:
            read.update(task.needs)
    shown = read.intersection(fields)
    read.update(name for name, task in fields.items() if shown.intersection(task.needs))
    carried = {need for task in (*fields.values(), *forces) for need in task.needs}
    for name, task in fields.items():
        kind: Any = task.kind
        deep = len(getattr(kind, "size", None) or ()) == 3
        if getattr(kind, "flows", False) and ((name in around and deep) or name in carried - around):
            read.add(name)
    for model in [task for task in fields.values() if task.name not in read]:
        word, of = cast(tuple[str, Value], cast(Model, model.kind).drawn_by(model.name))
        if (cls := catalogue.load("objects", word)) is None:
            continue
        name = f"{model.name}_{'map' if word == 'field_map' else word}"
        while name in tasks:
            name += "_"
        tasks[name] = Task(name, word, cls.model_validate({"of": of}), model.span, (model.name,))
        for ref in cast(Model, model.kind).shown_in_place_of():
            tasks[ref.name] = _hidden(tasks[ref.name])
    return tasks


def _uncover(tasks: dict[str, Task]) -> None:
    """Hide objects that would hide a map of the script that fills them, where nothing is said of their looks."""
    maps = [task for task in tasks.values() if isinstance(task.kind, Object) and task.kind.covers]
    for name in {need for task in maps for need in task.needs}.intersection(tasks):
        kind = tasks[name].kind
        for ref in kind.shown_in_place_of() if isinstance(kind, Model) and kind.drawn_by(name) else ():
            if not LOOKS & tasks[ref.name].kind.model_fields_set:
                tasks[ref.name] = _hidden(tasks[ref.name])


def _hidden(task: Task) -> Task:
    """An object that is not drawn."""
    return replace(task, kind=task.kind.model_copy(update={"hidden": True}))


def _drive(tasks: dict[str, Task]) -> dict[str, Task]:
    """Link the fields of driven objects to the outputs of the models that drive them; forces there act on these."""
    led: dict[tuple[str, str], Link] = {}
    for model in list(tasks.values()):
        if not isinstance(model.kind, Model):
            continue
        for name, outputs in model.kind.drives().items():
            target = tasks[name]
            old = {field: value for field in outputs if isinstance(value := getattr(target.kind, field, None), Value)}
            if not old:
                continue  # the model says what it cannot drive
            links = {
                field: Value(Link(model.name, outputs[field], value.expr.type), value.span)
                for field, value in old.items()
            }
            led |= {(name, field): link.expr for field, link in links.items() if isinstance(link.expr, Link)}
            needs = (*target.needs, model.name)
            driven = target.kind.model_copy(update=links)
            tasks[name] = replace(target, kind=driven, needs=needs, original=target.kind)
    for task in list(tasks.values()) if led else ():
        own: dict[str, Link] = {}
        for name, value in task.kind if isinstance(task.kind, Interaction) else ():
            at = value.expr if isinstance(value, Value) else None
            if isinstance(at, Link) and (link := led.get((at.task, at.output))) is not None:
                own[name] = replace(link, span=at.span)
        if own:
            kind = task.kind.model_copy(update={name: Value(link, link.span) for name, link in own.items()})
            needs = (*task.needs, *(link.task for link in own.values()))
            tasks[task.name] = replace(task, kind=kind, needs=needs)
    return tasks
