"""The contacts of elastic solids, whose skins nothing passes. Imports numpy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from sceneql.contacts.barrier.skin_pairs import add_pairs
from sceneql.contacts.barrier.standing import add_objects
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from sceneql.kinds import Ref, Value
    from sceneql.system import Assembly, Bodies

GAP = 0.05
"""The gap, where the script tells none: part of the mean side of the triangles of the skins."""
SLIP = 1e-4
"""Speed of slip below which friction is smooth: part of the size of the solids, a second."""


def assemble(
    assembly: Assembly, everyone: Sequence[Bodies], refs: Sequence[Ref], friction: Value, gap: float | None
) -> tuple[int, ...]:
    """Add the barriers of all skins; what the word remembers: -3, offset of gap and slip in the floats.

    Raises ScriptError for masses without skins, and for what starts too near.
    """
    for bodies in everyone:
        if bodies.skin is None:
            message = f"'{bodies.model}' does not collide together with elastic solids yet"
            help = "name under `between` what may touch, without it"
            raise ScriptError([Diagnostic("no-collider", message, assembly.line(), help)])
    sides, places = [], []
    for bodies in everyone:
        assert bodies.skin is not None
        own = assembly.start()[bodies.position_at :][: 3 * bodies.count].reshape(-1, 3)
        corners = own[bodies.skin.triangles]
        sides.append(np.linalg.norm(corners - corners[:, [1, 2, 0]], axis=2).ravel())
        places.append(corners.reshape(-1, 3))
    side = float(np.concatenate(sides).mean())
    gap = GAP * side if gap is None else gap
    slip = SLIP * float(np.linalg.norm(np.ptp(np.concatenate(places), axis=0)))
    rubs = not friction.constant or assembly.initial(friction) > 0.0
    told, friction_at = assembly.floats([gap, slip]), assembly.value(friction)
    for bodies in everyone:
        assert bodies.skin is not None
        if refs:
            add_objects(assembly, bodies, refs, friction_at, (bodies.skin.stiffness, gap, slip), rubs)
    add_pairs(assembly, everyone, friction_at, gap, slip, side, rubs)
    return -3, told
