"""Depths and normals of a frame, by any method for implicit surfaces, for comparison by `bench`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from renderers.tracing import layout
from renderers.tracing.camera_kernels import TILE
from renderers.tracing.certified import TOLERANCE
from renderers.tracing.pack import pack
from renderers.tracing.picture import over_rows
from renderers.tracing.probe_kernels import probe_rows
from renderers.tracing.scratch import begun, scratch_beside
from renderers.tracing.solids.packet_choice import lender, packets_for

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from renderers.tracing.scene_kernels import Scene
    from renderers.tracing.solids.bundles import Packets
    from sceneql.frame import Floats, SeenFrame


@dataclass(frozen=True, slots=True, eq=False)
class Probe:
    """First hits of the rays through the pixels' centers."""

    depth: Floats
    """(h, w) [m]: distance along the ray; infinite for a miss."""
    normals: Floats
    """(h, w, 3): outward unit normals; zero for a miss."""
    undecided: NDArray[np.bool_]
    """(h, w): whether a root on the ray is undecided."""


class Lines:
    """Working memory of a thread for the rays of bands of pixels."""

    def __init__(self, scene: Scene, packets: Packets | None, rows: int) -> None:
        """``packets``: intersect solids in packets, if not None; ``rows``: number of scratch rows."""
        self.scene, self.packets = scene, packets
        pixels = (int(scene.reals[layout.WIDTH]) + TILE) * TILE
        self.asked = np.zeros((1, layout.ANSWERS)) if packets is None else packets.asked(pixels)
        self.scratch = scratch_beside(self.asked, scene, rows)

    def look(self, start: int, stop: int, *out: Any) -> None:
        """Run probe_kernels.probe_rows: once, or with packets twice, first to collect rays, then to use the answers."""
        begun(self.scratch)
        if self.packets is not None:
            self.asked[0, [layout.MODE, layout.NEXT]] = layout.ASKING, 1
            probe_rows(self.scene, self.scratch, self.asked, start, stop, *out)
            self.packets.meet(self.asked)
            self.asked[0, [layout.MODE, layout.NEXT]] = layout.TELLING, 1
        probe_rows(self.scene, self.scratch, self.asked, start, stop, *out)


def probe(frame: SeenFrame, tolerance: float = TOLERANCE, *, march: int = 0, certain: bool = False) -> Probe:
    """Probe of the rays through all pixels' centers.

    Roots are found as in `trace`, by ``march`` samples if not 0, or if ``certain`` by certified intervals alone.
    """
    scene, rows = pack(frame, tolerance, march, certain)
    width, height = frame.view.size
    out = np.empty((height, width)), np.empty((height, width, 3)), np.empty((height, width), dtype=np.bool_)
    together = None if march or certain else packets_for(frame, tolerance)
    with_lines = lender(lambda: Lines(scene, together and together(), rows))
    over_rows(height, lambda start, stop: with_lines(lambda lines: lines.look(start, stop, *out)))
    return Probe(*out)
