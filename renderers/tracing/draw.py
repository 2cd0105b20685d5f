"""Stages of a ray-traced picture, each over bands of rows on the thread pool."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from renderers.tracing import layout
from renderers.tracing.buffers import Buffers, put_back, take
from renderers.tracing.camera_kernels import TILE
from renderers.tracing.certified import BOUNCES, TOLERANCE
from renderers.tracing.filter.filter_kernels import deepen, widen
from renderers.tracing.filter.hard_kernels import is_hard, list_cuts
from renderers.tracing.filter.planes_kernels import LANES, lay_out
from renderers.tracing.filter.refine_kernels import shade_rows
from renderers.tracing.filter.spread_kernels import ROOM, spread_sky
from renderers.tracing.light.sampling_kernels import subpixels
from renderers.tracing.light.visibility_kernels import FIRST_LIGHT
from renderers.tracing.pack import pack
from renderers.tracing.picture import BROAD, Picture, over_rows
from renderers.tracing.solids.packet_choice import lender, packets_for
from renderers.tracing.sprites import over
from renderers.tracing.tiles_kernels import choose, reach
from renderers.tracing.waves import Waves
from renderers.tracing.waves_kernels import layers_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from sceneql.frame import SeenFrame


DOUBTED = 0.01
"""Largest fraction of pixels with undecided roots for which these get more rays; each such ray takes long."""


def draw(
    frame: SeenFrame, samples: int = 8, tolerance: float = TOLERANCE, march: int = 0, bounces: int = BOUNCES
) -> Picture:
    """Ray-trace a frame.

    ``samples``: rays in a pixel at an edge between surfaces, a power of two from 1 to 64. ``tolerance``: that of roots
    of implicit surfaces; only at TOLERANCE are rays tested against solids in packets. ``march``: if not 0, number of
    samples on a ray that replace certified roots. ``bounces``: largest number of reflections onto matte surfaces.

    Roots of implicit surfaces are certified (sceneql.field). Shadows and the sky's light are sampled once per pixel on
    a net of directions and averaged over the surface around it, so that the picture has no grain and is reproducible
    to the bit.
    """
    scene, rows = pack(frame, tolerance, march, bounces=bounces)
    width, height = frame.view.size
    columns = FIRST_LIGHT + (2 if scene.mist == 0 else 3) * int(scene.ints[layout.LIGHT_COUNT])
    if scene.mist != 0:
        from renderers.tracing.mist import light_up

        light_up(scene, rows)
    layers = layers_of(scene)
    hard = bool(is_hard(scene))
    buffers = take(width, height, columns, layers, hard)
    reach(scene, buffers.reached)
    counts: list[tuple[int, int, int]] = []
    together = None if march else packets_for(frame, tolerance)
    with_waves = lender(lambda: Waves(scene, together and together(), rows, columns, layers))

    def gather(start: int, stop: int) -> None:
        out = (
            buffers.reached,
            buffers.busy,
            buffers.mirrored,
            buffers.records,
            buffers.visibility,
            hard,
            buffers.radiance,
        )
        counts.append(with_waves(lambda w: w.gather(start, stop, *out)))

    def refine(start: int, stop: int, *of_layer: Any) -> None:
        busy, records, visibility, fine = of_layer
        with_waves(lambda w: w.refine(start, stop, busy, records, visibility, buffers.means, fine))

    over_rows(height, gather, "tracing rays", most=BROAD)
    undecided, seconds, unsearched = map(sum, zip(*counts, strict=True))
    layers_seen = (1, 0) if seconds else (0,)  # layer 0 comes last: the stage of edges reads its planes
    if hard:
        _soften(with_waves, buffers, layers_seen)
    if samples > 1 or not hard:
        choose(buffers.busy, buffers.laid, buffers.chunks)
    for layer in () if hard else layers_seen:
        _filter(refine, buffers, layer)

    def shade(start: int, stop: int) -> None:
        seen = layers if buffers.mirrored[start // TILE : -(-stop // TILE)].any() else 1
        light = buffers.records[:seen], buffers.fine[:seen], buffers.visibility[:seen]
        shade_rows(scene, start, stop, buffers.busy, *light, buffers.radiance)

    def lay_keys(start: int, stop: int) -> None:
        none = np.empty((len(buffers.radiance), 0), dtype=np.float32)
        lay_out(start, stop, width, buffers.chunks, buffers.records[0], none, buffers.planes)

    if not hard:
        over_rows(height, shade)
    elif samples > 1:
        over_rows(height, lay_keys)
    doubted = undecided if undecided <= DOUBTED * width * height else 0
    linear = buffers.linear() if samples > 1 else buffers.radiance_as_linear()
    points = subpixels(samples)

    def smooth(start: int, stop: int) -> None:
        light = buffers.records, buffers.radiance, buffers.visibility
        with_waves(lambda w: w.smooth(start, stop, points, doubted, buffers.busy, buffers.planes, *light, linear))

    if samples > 1:
        over_rows(height, smooth, "tracing rays at edges")
    over(frame, buffers.records[0], linear, scene, rows)
    put_back(buffers)
    return Picture(linear.reshape(height, width, 3), undecided, unsearched)


def _soften(with_waves: Callable[..., None], buffers: Buffers, layers: Sequence[int]) -> None:
    """Sample the edges of hard shadows in ``layers`` of records."""
    width, height, columns = buffers.shape[:3]
    found: dict[tuple[int, int], NDArray[np.int64]] = {}

    def look(start: int, stop: int) -> None:
        for layer in layers:
            own = buffers.cuts[layer, start * width * columns :]
            light = buffers.records[layer], buffers.visibility[layer]
            found[layer, start] = own[: list_cuts(start, stop, width, buffers.busy, *light, own)]

    def sample(start: int, _: int) -> None:
        for layer in layers:
            own = found[layer, start], buffers.records[layer], buffers.visibility[layer], buffers.radiance
            with_waves(lambda w, own=own: w.soften(*own))

    for stage in (look, sample):
        over_rows(height, stage, most=BROAD)


def _filter(refine_rows: Callable[..., None], buffers: Buffers, layer: int) -> None:
    """Filter the visibility of a layer's records into buffers.fine."""
    width, height, columns = buffers.shape[:3]
    records, visibility, fine = buffers.records[layer], buffers.visibility[layer], buffers.fine[layer]
    planes, sums, means = buffers.planes, buffers.sums, buffers.means
    busy, marks = buffers.busy, buffers.chunks
    if layer > 0:  # what was in other chunks before is read by no pixel that has a record
        busy, marks = np.where(buffers.mirrored != 0, busy, np.int8(0)), np.empty_like(marks)
        choose(busy, np.zeros_like(marks), marks)

    def where_laid(stage: Callable[[int, int], None], start: int, stop: int) -> None:
        if marks[start // TILE].any():  # elsewhere, in most rows of a second layer, all chunks are BLANK
            stage(start, stop)

    def along(start: int, stop: int) -> None:
        lay_out(start, stop, width, marks, records, visibility, planes)
        widen(start, stop, columns, marks, planes, sums, np.empty(LANES, dtype=np.float32))

    def down(start: int, stop: int) -> None:
        deepen(start, stop, columns, marks, planes, sums, means, np.empty(LANES, dtype=np.float32))

    def at_last(start: int, stop: int) -> None:
        spread_sky(start, stop, width, columns, busy, planes, means, fine, np.empty(ROOM, dtype=np.float32))
        refine_rows(start * width, stop * width, busy, records, visibility, fine)

    for stage in (along, down, at_last):
        over_rows(height, partial(where_laid, stage))
