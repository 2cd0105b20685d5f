"""The stages of a ray-traced picture, each over bands of rows on the thread pool."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing import layout
from renderers.tracing.camera_kernels import TILE
from renderers.tracing.certified import TOLERANCE
from renderers.tracing.filter.filter_kernels import deepen, widen
from renderers.tracing.filter.planes_kernels import KEYS, LANES, WIDE, lay_out
from renderers.tracing.filter.refine_kernels import shade_rows
from renderers.tracing.filter.spread_kernels import ROOM, spread_sky
from renderers.tracing.light.sampling_kernels import subpixels
from renderers.tracing.light.visibility_kernels import FIRST_LIGHT
from renderers.tracing.pack import pack
from renderers.tracing.picture import Picture, over_rows
from renderers.tracing.record_kernels import COLUMNS
from renderers.tracing.solids.packet_choice import lender, packets_for
from renderers.tracing.sprites import over
from renderers.tracing.tiles_kernels import choose, reach
from renderers.tracing.waves import Waves
from renderers.tracing.waves_kernels import layers_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from sceneql.frame import Floats, SeenFrame


class Buffers:
    """Working memory of a picture. Layer 0: what the camera sees; layer 1: what is mirrored or refracted in that."""

    def __init__(self, width: int, height: int, columns: int, layers: int) -> None:
        self.shape, count = (width, height, columns, layers), width * height
        self.records = np.zeros((layers, count, COLUMNS), dtype=np.float32)
        self.radiance = np.empty((count, 3), dtype=np.float32)
        self.visibility = np.zeros((layers, count, columns), dtype=np.float32)
        self.fine = np.zeros((layers, count, columns), dtype=np.float32)
        chunks = -(-width // LANES)
        self.planes = np.zeros((height, chunks * (KEYS + columns * WIDE)), dtype=np.float32)
        self.sums = np.zeros((height, chunks * (1 + columns) * LANES), dtype=np.float32)
        self.means = np.zeros((height, chunks * (1 + columns) * WIDE), dtype=np.float32)
        bands = -(-height // TILE)
        self.reached = np.zeros((bands, -(-width // TILE)), dtype=np.int8)
        self.busy = np.ones_like(self.reached)
        self.laid, self.chunks = np.ones((2, bands, chunks), dtype=np.int8)


_kept: list[Buffers] = []
"""The last picture's buffers: fresh memory costs the system a tenth of a frame's time."""

DOUBTED = 0.01
"""Share of pixels with undecided roots up to which these are looked at by more rays: each of them takes long."""


def _buffers(*shape: int) -> Buffers:
    kept = _kept.pop() if _kept else None
    return kept if kept is not None and kept.shape == shape else Buffers(*shape)


def draw(frame: SeenFrame, samples: int = 8, tolerance: float = TOLERANCE, march: int = 0) -> Picture:
    """Ray-trace a frame; ``samples``, a power of two from 1 to 64: rays in a pixel at an edge between surfaces.

    ``tolerance`` is that of roots of implicit surfaces; with ``march`` they are sampled at so many places of a ray. At
    the usual tolerance rays are tested against solids in packets, at others one by one.

    Roots of implicit surfaces are certified (sceneql.field); shadows and the sky's light are sampled once a pixel by a
    net and averaged over the surface around it, so that the picture has no grain and repeats to the bit.
    """
    scene, rows = pack(frame, tolerance, march)
    width, height = frame.view.size
    columns = FIRST_LIGHT + (2 if scene.mist == 0 else 3) * int(scene.ints[layout.LIGHT_COUNT])
    if scene.mist != 0:
        from renderers.tracing.mist import light_up

        light_up(scene, rows)
    layers = layers_of(scene)
    buffers = _buffers(width, height, columns, layers)
    reach(scene, buffers.reached)
    counts: list[tuple[int, int]] = []
    together = None if march else packets_for(frame, tolerance)
    with_waves = lender(lambda: Waves(scene, together and together(), rows, columns, layers))

    def gather(start: int, stop: int) -> None:
        out = buffers.reached, buffers.busy, buffers.records, buffers.radiance, buffers.visibility
        counts.append(with_waves(lambda w: w.gather(start, stop, *out)))

    def refine(start: int, stop: int, *of_layer: Floats) -> None:
        records, visibility, fine = of_layer
        with_waves(lambda w: w.refine(start, stop, buffers.busy, records, visibility, buffers.means, fine))

    over_rows(height, gather)
    undecided, seconds = map(sum, zip(*counts, strict=True))
    choose(buffers.busy, buffers.laid, buffers.chunks)
    for layer in (1, 0) if seconds else (0,):
        _filter(refine, buffers, layer)  # layer 0 last: the edges need its planes

    def shade(start: int, stop: int) -> None:
        shade_rows(
            scene, start, stop, buffers.busy, buffers.records, buffers.fine, buffers.visibility, buffers.radiance
        )

    over_rows(height, shade)
    points = subpixels(samples)
    doubted = undecided if undecided <= DOUBTED * width * height else 0
    linear = np.empty((width * height, 3), dtype=np.float32)

    def smooth(start: int, stop: int) -> None:
        light = buffers.records, buffers.radiance, buffers.visibility
        with_waves(lambda w: w.smooth(start, stop, points, doubted, buffers.busy, buffers.planes, *light, linear))

    over_rows(height, smooth)
    over(frame, buffers.records[0], linear)
    _kept[:] = [buffers]
    return Picture(linear.reshape(height, width, 3), undecided)


def _filter(refine_rows: Callable[..., None], buffers: Buffers, layer: int) -> None:
    """Filter the visibility of a layer's records into buffers.fine."""
    width, height, columns, _ = buffers.shape
    records, visibility, fine = buffers.records[layer], buffers.visibility[layer], buffers.fine[layer]
    marks, planes, sums, means = buffers.chunks, buffers.planes, buffers.sums, buffers.means

    def along(start: int, stop: int) -> None:
        lay_out(start, stop, width, marks, records, visibility, planes)
        widen(start, stop, columns, marks, planes, sums, np.empty(LANES, dtype=np.float32))

    def down(start: int, stop: int) -> None:
        deepen(start, stop, columns, marks, planes, sums, means, np.empty(LANES, dtype=np.float32))

    def at_last(start: int, stop: int) -> None:
        spread_sky(start, stop, width, columns, buffers.busy, planes, means, fine, np.empty(ROOM, dtype=np.float32))
        refine_rows(start * width, stop * width, records, visibility, fine)

    for stage in (along, down, at_last):
        over_rows(height, stage)
