"""Warnings of cameras, lamps and objects inside of a solid, and of objects under the ground."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.compiler.meaning.places import Ball, depth, distance, opaque, text
from sceneql.compiler.passes.unseen import ground_level
from sceneql.kinds import Camera, Light, Model
from sceneql.quantities.diagnostic import Diagnostics

MOST = 200
"""Largest number of objects that are compared with one another."""
SKY = 0.5
"""Part of the other objects from which on what holds them is meant as a sky."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such part that stands still, in a solid that stands still and that one does not see through."""
    solids = opaque(facts)
    if not solids:
        return
    eyes = [place for task in facts.of(Camera) if (place := constant(getattr(task.kind, "position", None))) is not None]
    _cameras(facts, solids, found)
    _lamps(facts, solids, found)
    if len(solids) <= MOST:
        _objects(facts, solids, found)
    _buried(facts, solids, eyes, found)


def _cameras(facts: Facts, solids: Mapping[str, Ball], found: Diagnostics) -> None:
    for name in dict.fromkeys(facts.cameras.values()):
        eye = constant(getattr(facts.tasks[name].kind, "position", None)) if name else None
        if eye is None or getattr(facts.tasks[name].kind, "follow", None) is not None:
            continue
        for solid, held in solids.items():
            if distance(eye, held.center) < held.reach and depth(facts, solid, eye) > 0.0:
                told = f"'{name}' stands inside '{solid}': it sees nothing else"
                inside = [o for o, b in solids.items() if o != solid and distance(b.center, held.center) < held.inner]
                help = f"move it out, farther than {held.reach:.3g} m from the middle at {text(held.center)}"
                if len(inside) > SKY * (len(solids) - 1) or held.inner > 10.0:
                    help = f"a sky is a color, `background: skyblue`, or a light, `sky`: leave '{solid}' out"
                found.warning("camera-inside", told, facts.tasks[name].span, help=help)
                break


def _lamps(facts: Facts, solids: Mapping[str, Ball], found: Diagnostics) -> None:
    for task in facts.of(Light):
        at, size = (constant(getattr(task.kind, field, None)) for field in ("position", "radius"))
        for solid, held in solids.items() if at is not None and size is not None else ():
            material = facts.material(facts.tasks[solid].kind)
            glows = material is not None and "strength" in type(material).model_fields
            if glows or distance(at, held.center) >= held.reach or depth(facts, solid, at) <= size:
                continue
            told = f"'{task.name}' stands inside '{solid}', which lets none of its light out"
            above = (held.center[0], held.center[1] + 2.0 * held.reach + 1.0, held.center[2])
            help = f"move it out, `position: {text(above)}`; what shines itself is of the material `glow`"
            found.warning("buried-light", told, task.span, help=help)
            break


def _objects(facts: Facts, solids: Mapping[str, Ball], found: Diagnostics) -> None:
    """Objects that nothing else uses, wholly inside of others."""
    used = {need for task in facts.tasks.values() for need in task.needs}
    eyes = [task.kind for task in facts.of(Camera)]
    for name, small in solids.items():
        if name in used or not facts.written(name):
            continue
        for other, large in solids.items():
            if other == name or large.inner <= small.reach or distance(small.center, large.center) >= large.reach:
                continue
            if depth(facts, other, small.center) > small.reach and not any(_in(eye, large) for eye in eyes):
                told = f"'{name}' is inside of '{other}', and never seen"
                help = f"move it out, or let one see through '{other}': `material: glass`"
                found.warning("never-seen", told, facts.tasks[name].span, help=help)
                break


def _in(camera: object, held: Ball) -> bool:
    eye = constant(getattr(camera, "position", None))
    return eye is not None and distance(eye, held.center) < held.reach


def _buried(facts: Facts, solids: Mapping[str, Ball], eyes: list[tuple[float, ...]], found: Diagnostics) -> None:
    """Objects wholly under a ground that one does not see through, unless a camera looks there."""
    level = ground_level(facts.tasks)
    aims = [constant(getattr(task.kind, "look_at", None)) for task in facts.of(Camera)]
    if level is None or any(place[1] < level for place in (*eyes, *(aim for aim in aims if aim is not None))):
        return
    used = {need for task in facts.tasks.values() if isinstance(task.kind, Model) for need in task.needs}
    for name, held in solids.items():
        if facts.written(name) and name not in used and held.center[1] + held.reach < level:
            x, _, z = held.center
            told = f"'{name}' lies under the ground, which hides it"
            help = f"y is up, and the ground is at {level:g} m: write `position: {text((x, level + held.inner, z))}`"
            found.warning("never-seen", told, facts.tasks[name].span, help=help)
