"""The stages of a picture, each over bands of rows on the thread pool."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing import edges_kernels, filter_kernels, gather_kernels, refine_kernels
from renderers.tracing.pack import pack, scratch
from renderers.tracing.record_kernels import COLUMNS
from renderers.tracing.sampling_kernels import subpixels
from renderers.tracing.scene_kernels import LIGHT_COUNT
from renderers.tracing.visibility_kernels import FIRST_LIGHT
from sceneql.kernels import over_tiles

if TYPE_CHECKING:
    from numpy import float32
    from numpy.typing import NDArray

    from sceneql.frame import Frame

BAND = 8
"""Rows that a thread takes at a time."""


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """What a renderer makes of a frame."""

    linear: NDArray[float32]
    """(h, w, 3): scene-referred linear RGB, or data."""
    undecided: int = 0
    """Pixels in whose rays root isolation met a place that it could not decide."""


def over_rows(height: int, work: Callable[[int, int], object]) -> None:
    """Call ``work(start, stop)`` for bands of rows."""
    over_tiles(-(-height // BAND), lambda band: work(band * BAND, min(band * BAND + BAND, height)))


def draw(frame: Frame, samples: int = 8) -> Picture:
    """Ray-trace a frame; ``samples``, a power of two from 1 to 64: rays in a pixel in which things meet.

    Roots of implicit surfaces are certified (sceneql.field); shadows and the sky's light are sampled once a pixel by a
    net and averaged over the surface around it, so that the picture has no grain and repeats to the bit.
    """
    scene, rows = pack(frame)
    width, height = frame.view.size
    count = width * height
    records = np.zeros((2, count, COLUMNS), dtype=np.float32)
    columns = FIRST_LIGHT + 2 * int(scene.ints[LIGHT_COUNT])
    visibility = np.zeros((2, count, columns), dtype=np.float32)
    radiance = np.empty((count, 3), dtype=np.float32)
    undecided: list[int] = []
    over_rows(
        height,
        lambda start, stop: undecided.append(
            gather_kernels.gather_rows(
                scene, scratch(rows), start, stop, records, radiance, visibility, np.empty(COLUMNS, np.float32)
            )
        ),
    )
    fine = np.zeros_like(visibility)
    sums = np.zeros((count, columns + 1), dtype=np.float32)
    means = np.zeros_like(sums)
    for layer in range(2):
        own, seen = records[layer], visibility[layer]
        over_rows(height, lambda start, stop: filter_kernels.widen(start, stop, width, own, seen, sums))
        over_rows(height, lambda start, stop: filter_kernels.deepen(start, stop, width, height, own, sums, means))
        over_rows(
            height,
            lambda start, stop: refine_kernels.refine_rows(
                scene, scratch(rows), start, stop, own, seen, means, fine[layer]
            ),
        )
    over_rows(
        height, lambda start, stop: refine_kernels.shade_rows(scene, start, stop, records, fine, visibility, radiance)
    )
    points = subpixels(samples)
    linear = np.empty((count, 3), dtype=np.float32)
    over_rows(
        height,
        lambda start, stop: edges_kernels.smooth_rows(
            scene,
            scratch(rows),
            start,
            stop,
            points,
            records,
            radiance,
            visibility,
            np.empty((3, COLUMNS), np.float32),
            np.empty(columns, np.float32),
            linear,
        ),
    )
    return Picture(linear.reshape(height, width, 3), int(sum(undecided)))
