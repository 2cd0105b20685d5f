"""Contacts of skins in flows, with what stands and with one another. Imports numpy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from sceneql.contacts.barrier import objects_layout as layout
from sceneql.contacts.barrier.standing import LIMIT, must_be_apart
from sceneql.contacts.colliders import surfaces
from sceneql.skins.touch_layout import ANCHORS, FORCE

if TYPE_CHECKING:
    from sceneql.kinds import Ref, Value
    from sceneql.system import Assembly, Membrane

OBJECTS = "sceneql.skins.touch_objects_kernels"


def assemble(
    assembly: Assembly,
    skins: Sequence[tuple[str, Membrane]],
    refs: Sequence[Ref],
    friction: Value,
    gap: float | None,
) -> tuple[int, ...]:
    """Add what keeps skins off objects and each other; the offset of the gap in the floats, for what the word remembers.

    Raises ScriptError for an object that cannot be collided with, and for what starts too near.
    """
    gap = max(skin.cell for _, skin in skins) if gap is None else gap
    told, friction_at = assembly.floats([gap]), assembly.value(friction)
    rubs = not friction.constant or assembly.initial(friction) > 0.0
    for name, skin in skins if refs else ():
        _stand(assembly, name, skin, refs, friction_at, gap, rubs)
    return (told,)


def _stand(
    assembly: Assembly, name: str, skin: Membrane, refs: Sequence[Ref], friction_at: int, gap: float, rubs: bool
) -> None:
    """Add what keeps a skin off objects."""
    objects = surfaces(refs, assembly, layout.HEAD)
    points, pairs = skin.count, skin.count * len(refs)
    head = [0] * layout.HEAD
    head[layout.POSITION], head[FORCE], head[layout.NODES] = skin.position_at, skin.force_at, points
    head[layout.LIST], head[layout.OBJECTS], head[layout.ARMS] = layout.HEAD + len(objects), len(refs), -1
    head[layout.NUMBERS] = assembly.floats([skin.stiffness, gap, skin.stiffness / gap])
    head[layout.FRICTION], head[layout.AREAS] = friction_at, assembly.floats(skin.areas)
    head[ANCHORS] = assembly.floats(np.full(3 * pairs, np.nan))
    head[layout.KNOWN] = assembly.floats(np.full(layout.KNOW * pairs, -1.0))
    ints = (*head, *objects, *range(points))
    places = assembly.start()[skin.position_at :][: 3 * points].reshape(-1, 3)
    must_be_apart(name, refs, places, ints, gap, assembly)
    assembly.term("force", f"{OBJECTS}:force", ints)
    assembly.limit(LIMIT, ints)
    if rubs:
        assembly.after_step(f"{OBJECTS}:hold", ints)
