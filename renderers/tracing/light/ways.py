"""How the light paths of a wave are followed to their ends: by one call where packets know one solid at most."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from renderers.tracing import layout
from sceneql.compiled.kernels import address

if TYPE_CHECKING:
    from collections.abc import Callable

    from renderers.tracing.waves import Waves

FEW = 4
"""Number of light paths below which each is followed singly, because a wave costs more than it saves. This does not
apply if packets intersect the whole scene: a single ray then costs as much as a wave."""


def few_of(waves: Waves) -> int:
    """FEW, where that applies."""
    return 1 if waves.lanes is None and waves.asked[0, layout.ALONE] else FEW


def _nothing(kind: Any) -> Any:
    """What stands for an array, or a number, of a numba type where there are no packets."""
    return np.empty((0,) * kind.ndim, dtype=str(kind.dtype)) if hasattr(kind, "ndim") else 0


def ways_follower(waves: Waves) -> Callable[[int], None] | None:
    """``ways_kernels.follow_ways`` from a way on; None where there are no waves of them, or several solids."""
    packets = waves.packets
    if len(waves.ways) == 1 or (packets is not None and len(packets.solids) != 1):
        return None
    from renderers.tracing.light import ways_kernels as kernels
    from renderers.tracing.solids.bundles_kernels import SOLID, meet_asked
    from renderers.tracing.solids.skins_kernels import MEMORY, skin_hits

    meet = skin = plain = 0
    if packets is None:
        solid, memory = (tuple(_nothing(kind) for kind in kinds) for kinds in (SOLID, MEMORY))
    else:
        solid, memory = packets.of_rays(waves.asked)[0], packets.of_skins
        meet, skin = address(meet_asked, kernels.MEET), address(skin_hits, kernels.SKIN)
    lanes = np.empty(0) if waves.lanes is None else waves.lanes
    if waves.lanes is not None:
        plain = address(waves.meet_plain, kernels.PLAIN)
    own = waves.live, waves.ways_hit, waves.ways_met, waves.ways_skins, lanes
    return lambda first: kernels.follow_ways(
        waves.scene,
        waves.scratch,
        waves.asked,
        waves.ways,
        first,
        few_of(waves),
        *own,
        plain,
        skin,
        meet,
        memory,
        solid,
    )
