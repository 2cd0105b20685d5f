"""Warnings of solids made of others that do not meet, of skeletons that are apart or empty, and of turns never seen."""

from __future__ import annotations

from itertools import combinations
from math import hypot
from typing import Any

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.compiler.meaning.places import Ball, ball, distance, text
from sceneql.graph import Task
from sceneql.kinds import Camera, Object
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.expression import Link

MOST = 64
"""Largest number of parts that are compared with one another."""
MEANT = (1000.0, 10.0, 100.0)
"""Factors by which a length is off that is in another unit: mm for m, mm for cm, cm for m."""
FEWEST, WIDEST = 0.7, 4.0
"""Reach of a part over the distance to its neighbors, between which it is most likely meant."""
APART = 0.25
"""The same, below which not even single beads are meant."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such object of the script."""
    used = {need for task in facts.tasks.values() for need in task.needs}
    for task in facts.of(Object):
        kind: Any = task.original or task.kind
        if task.span is None:
            continue
        joins = [ref.name for ref in kind.joins()] if "of" in type(kind).model_fields else []
        held = {name: ball(facts, name) for name in joins}
        if len(joins) > 1 and "blend" in type(kind).model_fields and None not in held.values():
            _solids(facts, task, {name: one for name, one in held.items() if one is not None}, used, found)
        if "threshold" in type(kind).model_fields and "skeleton" in type(kind).model_fields:
            _skeleton(facts, task, kind, found)
        _unchanged(facts, task, kind, used, found)
        _placed_twice(facts, task, kind, found)


def _solids(facts: Facts, task: Task, held: dict[str, Ball], used: set[str], found: Diagnostics) -> None:
    """Members too far away to be cut, kept or blended; holes that are larger than the whole, or wholly inside."""
    kind: Any = task.kind
    word = task.word
    first, *others = held
    gaps = {pair: distance(held[pair[0]].center, held[pair[1]].center) for pair in combinations(held, 2)}
    apart = {pair: gap - held[pair[0]].reach - held[pair[1]].reach for pair, gap in gaps.items()}
    if word == "difference":
        for name in others:
            gap, cut, whole = gaps[first, name], held[name], held[first]
            if apart[first, name] > 0.0:
                told = f"'{name}' cuts nothing from '{first}': it lies beside it"
                help = f"members stand in the coordinates of '{task.name}': '{first}' is at {text(whole.center)}"
                found.warning("cuts-nothing", told, facts.tasks[name].span or task.span, help=help)
            elif cut.inner > gap + whole.reach:
                told = f"nothing is left of '{task.name}': '{first}' lies inside of '{name}', which is cut from it"
                help = f"the first is what is cut: write `of: [{name}, {first}]`, or a smaller '{name}'"
                found.warning("cuts-nothing", told, task.span, help=help)
            elif facts.whole and whole.inner > gap + cut.reach and _shown(facts, task, whole, used) and not others[1:]:
                told = f"'{name}' cuts a hollow inside of '{first}', which is never seen"
                help = f"let it reach through the surface, or write `material: glass` in '{task.name}'"
                found.warning("cuts-nothing", told, facts.tasks[name].span or task.span, help=help)
    elif word == "intersection":
        pair = next((pair for pair, gap in apart.items() if gap > 0.0), None)
        if pair is not None:
            told = f"nothing is in all members of '{task.name}': '{pair[0]}' and '{pair[1]}' lie beside one another"
            help = "move one of them until they overlap, or write a `union`"
            found.warning("cuts-nothing", told, task.span, help=help)
    elif (blend := constant(kind.blend)) and min(apart.values()) > blend:
        told = f"nothing is blended in '{task.name}': its members are {min(apart.values()):.3g} m apart or more"
        help = f"move them nearer, or write a larger one, as `blend: {1.5 * min(apart.values()):.2g} m`"
        found.warning("cuts-nothing", told, kind.blend.span or task.span, help=help)


def _shown(facts: Facts, task: Task, whole: Ball, used: set[str]) -> bool:
    """Whether an object is shown alone and opaque, from outside: no model weighs it, no other object is made of it."""
    eyes = [constant(getattr(one.kind, "position", None)) for one in facts.of(Camera) if one.span is not None]
    place = constant(getattr(task.kind, "position", None)) or (0.0, 0.0, 0.0)
    if any(eye is None or distance(eye, place) < whole.reach + hypot(*whole.center) for eye in eyes):
        return False
    alone = task.name in facts.seen and task.name not in facts.members and task.name not in used
    return alone and task.original is None and not facts.clear(task.kind)


def _skeleton(facts: Facts, task: Task, kind: Any, found: Diagnostics) -> None:
    """Points that are too far from one another to be joined, or too light to be seen."""
    known = {"point", "points", "radius", "weight", "color"}
    if kind.segments or any(part.model_fields_set - known for part in kind.skeleton or ()):
        return
    if not kind.skeleton and kind.points is not None and not kind.points.constant:
        _on_net(facts, task, kind, found)
        return
    parts: list[tuple[tuple[float, ...], float, float]] = []
    for part in (kind, *(kind.skeleton or ())):
        radius, weight = constant(part.radius), constant(part.weight)
        if part is kind and kind.points is None:
            continue
        if not isinstance(radius, float) or not isinstance(weight, float):
            return
        for field in ("point", "points"):
            given = getattr(part, field, None)
            if given is not None:
                places = constant(given)
                if places is None:
                    return
                parts += [(place, radius, weight) for place in (places if field == "points" else [places])]
    if not parts or len(parts) > MOST:
        return
    apart = [distance(a, b) - r - s for (a, r, _), (b, s, _) in combinations(parts, 2)]
    alone = not apart or min(apart) > 0.0
    heaviest = max(weight for _, _, weight in parts)
    total = sum(max(weight, 0.0) for _, _, weight in parts)
    if (heaviest if alone else total) <= kind.threshold:
        told = f"'{task.name}' is empty: its density is nowhere above the threshold of {kind.threshold:g}"
        help = "write a larger `weight`, 1 by default, or a smaller `threshold`"
        found.warning("empty-surface", told, task.span, help=help)
        return
    for place, radius, weight in parts:
        reached = sum(distance(place, other) < radius + size for other, size, _ in parts)  # by itself, too
        if reached == 1 and 0.0 < weight <= kind.threshold:
            told = (
                f"the part of '{task.name}' at {text(place)} is never seen: its weight, {weight:g}, is not above the "
            )
            told += f"threshold of {kind.threshold:g}, and no other part reaches it"
            help = f"write a larger one, as `weight: {min(1.0, 2.0 * kind.threshold):.2g}`, or bring it nearer"
            found.warning("empty-surface", told, task.span, help=help)
            return
    if facts.whole and alone and len(parts) > 1:
        told = f"the parts of '{task.name}' do not touch: the nearest two are {min(apart):.3g} m out of reach"
        far = min(distance(a, b) for (a, _, _), (b, _, _) in combinations(parts, 2))
        found.warning("not-joined", told, task.span, help=f"write a larger `radius`, as `radius: {far:.2g} m`")


def _on_net(facts: Facts, task: Task, kind: Any, found: Diagnostics) -> None:
    """Points at the masses of a net whose neighbors are too far apart to be joined, all at one radius."""
    expr, radius = kind.points.expr, constant(kind.radius)
    model: Any = facts.models.get(expr.task) if isinstance(expr, Link) and expr.output == "positions" else None
    net = model.static_net() if hasattr(model, "static_net") else None
    if net is None or not isinstance(radius, float) or not net[1] or radius >= APART * net[0]:
        return
    far = net[0]
    told = f"the parts of '{task.name}' do not touch: they reach {radius:.3g} m far, and neighbors in '{expr.task}' "
    told += f"are {far:.3g} m apart"
    meant = next((radius * by for by in MEANT if FEWEST * far <= radius * by <= WIDEST * far), far)
    found.warning("not-joined", told, kind.radius.span or task.span, help=f"write `radius: {meant:.3g} m`")


def _unchanged(facts: Facts, task: Task, kind: Any, used: set[str], found: Diagnostics) -> None:
    """Deformations by nothing, turns of a ball, and cells larger than what is cut into them."""
    for field, none in (("angle", 0.0), ("factor", 1.0)):
        number = constant(getattr(kind, field, None))
        if number == none and "of" in type(kind).model_fields and getattr(kind, field).span is not None:
            told = f"a {task.word} by `{field}: {getattr(kind, field).span.text}` changes nothing"
            help = "write another number, or leave it out"
            found.warning("changes-nothing", told, getattr(kind, field).span, help=help)
    rotation = getattr(kind, "rotation", None)
    sizes = [name for name in ("radius", "size", "height", "tube") if name in type(kind).model_fields]
    turns = rotation is not None and not rotation.constant and not rotation.links
    if sizes == ["radius"] and turns and rotation and task.original is None and task.name not in used:
        told = f"'{task.name}' is a ball of one color: nobody sees that it turns"
        help = "give it a mark, by a `group` with a small part beside it that turns with it"
        found.warning("changes-nothing", told, rotation.span or task.span, help=help)
    cell, of = getattr(kind, "cell", None), getattr(getattr(kind, "of", None), "name", "")
    held = ball(facts, of) if isinstance(cell, float) and of in facts.objects else None
    if held is not None and isinstance(cell, float) and cell > held.reach:
        told = f"a cell of '{task.name}' is {cell:g} m, and '{of}' is {2.0 * held.reach:.2g} m large"
        found.warning("few-cells", told, task.span, help=f"write `cell: {0.1 * held.reach:.2g} m`")


def _placed_twice(facts: Facts, task: Task, kind: Any, found: Diagnostics) -> None:
    """A group whose child stands where the group does, and so twice as far."""
    center = constant(getattr(kind, "position", None))
    if "children" not in type(kind).model_fields or center is None or not (center[0] or center[2]):
        return
    for ref in kind.members():
        place = constant(getattr(facts.objects.get(ref.name), "position", None))
        if place is not None and distance(place, center) < 1e-9:
            told = f"'{ref.name}' stands at {text(place)} of '{task.name}', which is at {text(center)} itself"
            told += f": it is at {text([2.0 * c for c in center])}"
            help = f"places of children are told from the group's: leave out the `position` of '{task.name}'"
            found.warning("placed-twice", told, facts.tasks[ref.name].span or task.span, help=help)
            return
