"""Barrier contacts of elastic solids and cloth, and of rigid bodies with them. Imports numpy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.compiled.compile_beside import compile_beside
from sceneql.contacts.barrier import standing
from sceneql.contacts.barrier.refused import beside_solids
from sceneql.contacts.barrier.skin_pairs import KERNELS, LIMIT, add_pairs
from sceneql.contacts.barrier.standing import add_objects, add_objects_to_body
from sceneql.contacts.barrier.surfaces_of import FIXED, rigid_surfaces, soft_skin, soft_surfaces
from sceneql.kinds import Ref
from sceneql.quantities.diagnostic import ScriptError

if TYPE_CHECKING:
    from sceneql.kinds import Value
    from sceneql.system import Assembly, Bodies

GAP = 0.05
"""Default gap, relative to the mean side of the skins' triangles."""
SLIP = 1e-4
"""Slip speed below which friction is smooth, relative to the size of all solids per second [1/s]."""
COARSER = 3.0
"""Longest edge of triangles on rigid bodies, relative to the mean side of the skins' triangles."""
PAIRS = ("sceneql.contacts.barrier.pairs_kernels", *(one.partition(":")[0] for one in (KERNELS, LIMIT)))
"""Modules that a second process compiles first: what finds pairs, their forces, their limits."""


def assemble(
    assembly: Assembly, everyone: Sequence[Bodies], refs: Sequence[Ref], friction: Value, gap: float | None
) -> tuple[int, ...]:
    """Add the barriers of all elastic solids, nets of springs that have faces, and rigid bodies.

    Returns the integers that `collision` remembers: -3, then the offset of gap and slip in the floats.
    Raises ScriptError for masses without surfaces, and for surfaces that touch or cross at the start.
    """
    compile_beside((*PAIRS, standing.LIMIT.partition(":")[0]) if refs else PAIRS)  # while those of objects compile here
    for bodies in everyone:
        if soft_skin(bodies) is None and bodies.turning is None:
            model: Any = assembly.object(Ref(bodies.model))
            raise ScriptError([beside_solids(bodies.model, model.faceless(), assembly.line())])
    soft = [bodies for bodies in everyone if soft_skin(bodies) is not None]
    surfaces = soft_surfaces(soft, assembly)
    corners = [one.at[one.triangles] for one in surfaces]
    sides = [np.linalg.norm(each - each[:, [1, 2, 0]], axis=2).ravel() for each in corners]
    side = float(np.concatenate(sides).mean())
    gap = GAP * side if gap is None else gap
    slip = SLIP * float(np.linalg.norm(np.ptp(np.concatenate(corners).reshape(-1, 3), axis=0)))
    rubs = not friction.constant or assembly.initial(friction) > 0.0
    told, friction_at = assembly.floats([gap, slip]), assembly.value(friction)
    rigid = rigid_surfaces([one for one in everyone if one.turning is not None], COARSER * side, assembly)
    stiffest = max(one.stiffness for one in surfaces)
    for bodies, surface in zip(soft, surfaces, strict=True) if refs else ():
        add_objects(assembly, bodies, refs, friction_at, (surface.stiffness, gap, slip), rubs)
    for one in rigid if refs else ():
        if one.number != FIXED:
            add_objects_to_body(assembly, one, refs, friction_at, (stiffest, gap, slip), rubs)
    add_pairs(assembly, [*surfaces, *rigid], friction_at, gap, slip, side, rubs)
    return -3, told
