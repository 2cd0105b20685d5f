"""Contacts of skins in flows with objects, with masses and rigid bodies, and with one another. Imports numpy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.contacts import layout as contacts
from sceneql.contacts.barrier import objects_layout as layout
from sceneql.contacts.barrier.standing import LIMIT, must_be_apart
from sceneql.contacts.colliders import must_be_free, surface_of, surfaces
from sceneql.kinds import Ref
from sceneql.skins.touch import touch_layout as own
from sceneql.skins.touch.touching_skins import add_pairs

if TYPE_CHECKING:
    from sceneql.kinds import Value
    from sceneql.skins.deep import Sheet
    from sceneql.skins.flat import Line
    from sceneql.system import Assembly, Bodies, Membrane

OBJECTS = "sceneql.skins.touch.touch_objects_kernels"
BODIES = "sceneql.skins.touch.touch_bodies_kernels"


@dataclass(frozen=True, slots=True)
class Touch:
    """Numbers of a script's contacts: offset of the friction's value, whether there is friction, and the gap [m]."""

    friction_at: int
    rubs: bool
    gap: float


@dataclass(frozen=True, slots=True)
class Solid:
    """Mass or rigid body that skins may touch, and its surface."""

    ref: Ref
    head: tuple[int, ...]
    """Integers of an object by contacts/layout.py, without the last."""
    data: tuple[int, ...]
    place: tuple[int, ...]
    """BODY integers of touch_layout."""


def assemble(
    assembly: Assembly,
    skins: Sequence[tuple[str, Line | Sheet]],
    carried: Sequence[Bodies],
    everyone: Sequence[Bodies],
    refs: Sequence[Ref],
    friction: Value,
    gap: float | None,
) -> tuple[int, ...]:
    """Add contacts of skins and carried masses with objects, bodies and each other; the offset of the gap.

    Carried masses get no contacts with each other or with skins of their flow: one flow moves both, and keeps them
    apart. Raises ScriptError for objects without a surface to touch, and for skins that start too near one.
    """
    them = [(name, made.membrane) for name, made in skins]
    them += [(bodies.model, bodies.immersed.points) for bodies in carried if bodies.immersed is not None]
    gap = max(skin.cell for _, skin in them) if gap is None else gap
    rubs = not friction.constant or assembly.initial(friction) > 0.0
    told, touch = assembly.floats([gap]), Touch(assembly.value(friction), rubs, gap)
    solids = [solid for bodies in everyone for solid in _solids(bodies, assembly)]
    for name, skin in them:
        if refs:
            objects = surfaces(refs, assembly, layout.HEAD)
            ints = _ints(assembly, skin, len(refs), objects, touch)
            _add(assembly, name, skin, refs, ints, touch, OBJECTS, LIMIT)
        if solids:
            at = layout.HEAD + contacts.OBJECT * len(solids)
            heads: list[int] = []
            data: list[int] = []
            for solid in solids:
                heads += [*solid.head, at + len(data)]
                data += solid.data
            places = [one for solid in solids for one in solid.place]
            numbered = list(_ints(assembly, skin, len(solids), (*heads, *data, *places), touch))
            numbered[own.BODIES] = at + len(data)
            _add(assembly, name, skin, [one.ref for one in solids], numbered, touch, BODIES, f"{BODIES}:limit")
    if skins:
        add_pairs(assembly, skins, touch.friction_at, rubs, gap)
    return (told,)


def _ints(assembly: Assembly, skin: Membrane, count: int, objects: Sequence[int], touch: Touch) -> tuple[int, ...]:
    """Integers of the contact kernels of a skin with ``count`` objects, whose integers are ``objects``."""
    pairs = skin.count * count
    head = [0] * layout.HEAD
    head[layout.POSITION], head[own.FORCE], head[layout.NODES] = skin.position_at, skin.force_at, skin.count
    head[layout.LIST], head[layout.OBJECTS], head[layout.ARMS] = layout.HEAD + len(objects), count, -1
    head[layout.NUMBERS] = assembly.floats([skin.stiffness, touch.gap, own.STEEPER])
    head[layout.FRICTION], head[layout.AREAS] = touch.friction_at, assembly.floats(skin.areas)
    head[own.ANCHORS] = assembly.floats(np.full(3 * pairs, np.nan))
    head[layout.KNOWN] = assembly.floats(np.full(layout.KNOW * pairs, -1.0))
    return (*head, *objects, *range(skin.count))


def _add(
    assembly: Assembly,
    name: str,
    skin: Membrane,
    refs: Sequence[Ref],
    ints: Sequence[int],
    touch: Touch,
    kernels: str,
    limit: str,
) -> None:
    """Add the contact terms of a skin with objects ``refs``. Raises ScriptError for a skin that starts inside one."""
    places = assembly.start()[skin.position_at :][: 3 * skin.count].reshape(-1, 3)
    d = must_be_apart(name, refs, places, ints, touch.gap, assembly)
    if not assembly.went_on:
        steep = min(own.STEEPER, 0.5 * d / touch.gap)
        assembly.write(ints[layout.NUMBERS] + own.STEEP, np.array([steep]))
    assembly.term("force", f"{kernels}:force", ints)
    assembly.limit(limit, ints)
    if touch.rubs:
        assembly.after_step(f"{kernels}:hold", ints)


def _solids(bodies: Bodies, assembly: Assembly) -> list[Solid]:
    """Surfaces of a model's masses, which are spheres, or rigid bodies. Raises ScriptError for unfit models."""
    from sceneql.system import Place

    must_be_free(bodies.model, assembly)
    start, turning = assembly.start(), bodies.turning
    if turning is None:
        return [_mass(bodies, k, assembly) for k in range(bodies.count)]
    found = []
    model: Any = assembly.object(Ref(bodies.model))
    for k, (ref, center) in enumerate(model.solids()):
        place = np.concatenate([start[bodies.position_at + 3 * k :][:3], start[turning.rotation_at + 4 * k :][:4]])
        head, data, relative = surface_of(ref, center, place, assembly)
        ints = (*Place(bodies, k).ints, assembly.floats(relative))
        found.append(Solid(ref, _moved(head), data, ints))
    return found


def _mass(bodies: Bodies, number: int, assembly: Assembly) -> Solid:
    """Mass ``number`` as a sphere with its radius."""
    from sceneql.contacts.colliders import shape_kernels
    from sceneql.kinds import Collider
    from sceneql.system import Place

    start, radius = assembly.start(), bodies.radius_at + number
    position = assembly.floats(start[bodies.position_at + 3 * number :][:3])
    rotation = assembly.floats([1.0, 0.0, 0.0, 0.0])
    here = Collider("sceneql.contacts.shapes.sphere_kernels", position, rotation, radius, radius)
    head = (*shape_kernels(here), position, rotation, radius, radius, 0, *(position, rotation) * 2, 0)
    return Solid(Ref(bodies.model), _moved(head), (), (*Place(bodies, number).ints, -1))


def _moved(head: Sequence[int]) -> tuple[int, ...]:
    """Integers of a surface that moves, with no distances kept from one step to the next."""
    found = list(head)
    found[contacts.MOVING], found[contacts.FLAT] = found[contacts.PLACE], 0
    return tuple(found)
