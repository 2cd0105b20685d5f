"""How the light paths of a wave are followed to their ends: by one call where packets know one solid at most."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from renderers.tracing import layout
from sceneql.compiled.kernels import address

if TYPE_CHECKING:
    from collections.abc import Callable

    from renderers.tracing.scene_kernels import Scene
    from renderers.tracing.solids.bundles import Packets
    from sceneql.frame import Floats

FEW = 4
"""Number of light paths below which each is followed singly, because a wave costs more than it saves. This does not
apply if packets intersect the whole scene: a single ray then costs as much as a wave."""


def few_of(lanes: Floats | None, asked: Floats) -> int:
    """FEW, where that applies."""
    return 1 if lanes is None and asked[0, layout.ALONE] else FEW


def ways_follower(
    scene: Scene, packets: Packets | None, lanes: Floats | None, scratch: Floats, asked: Floats, *own: Any
) -> Callable[[int], None] | None:
    """``follow_ways`` or ``follow_plain`` from a way on; None where there are no waves of them, or several solids.

    ``own``: the ways and their working memory, as that takes them.
    """
    ways, *memory, skins = own
    few = few_of(lanes, asked)
    if len(ways) == 1 or (packets is not None and len(packets.solids) != 1):
        return None
    if packets is None:
        from renderers.tracing.light.plain_ways_kernels import follow_plain

        return lambda first: follow_plain(scene, scratch, asked, ways, first, few, *memory, lanes)
    from renderers.tracing.light.ways_kernels import MEET, PLAIN, SKIN, follow_ways
    from renderers.tracing.solids.bundles_kernels import meet_asked
    from renderers.tracing.solids.skins_kernels import skin_hits

    plain = 0
    if lanes is not None:
        from renderers.tracing.solids.plain_lanes_kernels import meet_plain

        plain = address(meet_plain, PLAIN)
    addresses = plain, address(skin_hits, SKIN), address(meet_asked, MEET)
    more = *memory, skins, np.empty(0) if lanes is None else lanes, *addresses
    of_packets = packets.of_skins, packets.of_rays(asked)[0]
    return lambda first: follow_ways(scene, scratch, asked, ways, first, few, *more, *of_packets)
