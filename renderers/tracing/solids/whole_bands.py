"""How bands of a picture are gathered in scenes of one matte solid under lamps: some of them by one call."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from renderers.tracing import layout
from renderers.tracing.camera_kernels import TILE
from sceneql.compiled.kernels import address

if TYPE_CHECKING:
    from collections.abc import Callable

    from renderers.tracing.scene_kernels import Scene
    from renderers.tracing.solids.bundles import Packets
    from sceneql.frame import Floats


def in_one_call(scene: Scene, packets: Packets | None, layers: int) -> bool:
    """Whether ``gather_bands`` draws a scene.

    Not where paths or ways of light may begin, nor where packets do not know all solids or know several.
    """
    if packets is None or len(packets.solids) != 1 or layers > 1 or scene.reals[layout.HAS_LIGHT] != 0.0:
        return False
    return not scene.ints[layout.HAS_THIN]


def bands_gatherer(
    scene: Scene, packets: Packets | None, lanes: Floats | None, scratch: Floats, asked: Floats, *own: Any
) -> Callable[..., tuple[int, int]]:
    """``gather_bands`` for the arguments of ``Waves.gather``, for a scene that it draws.

    ``own``: the working memory that it takes, from the places of pixels on.
    """
    assert packets is not None
    from renderers.tracing.light.ways_kernels import MEET, PLAIN, SKIN
    from renderers.tracing.solids.bundles_kernels import meet_asked
    from renderers.tracing.solids.skins_kernels import skin_hits
    from renderers.tracing.solids.whole_bands_kernels import gather_bands

    plain = 0
    if lanes is not None:
        from renderers.tracing.solids.plain_lanes_kernels import meet_plain

        plain = address(meet_plain, PLAIN)
    tiles = np.empty(len(own[0]) // (TILE * TILE), dtype=np.int64)
    addresses = plain, address(skin_hits, SKIN), address(meet_asked, MEET)
    of_packets = packets.of_skins, packets.of_rays(asked)[0]
    more = tiles, *own, np.empty(0) if lanes is None else lanes, *addresses, *of_packets
    return lambda *band: gather_bands(scene, scratch, asked, *band, *more)
