"""The stages of a picture, each over bands of rows on the thread pool."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing.edges_kernels import smooth_rows
from renderers.tracing.filter_kernels import deepen, widen
from renderers.tracing.gather_kernels import gather_rows
from renderers.tracing.pack import TOLERANCE, pack, scratch
from renderers.tracing.picture import Picture, over_rows
from renderers.tracing.record_kernels import COLUMNS
from renderers.tracing.refine_kernels import refine_rows, shade_rows
from renderers.tracing.sampling_kernels import subpixels
from renderers.tracing.scene_kernels import LIGHT_COUNT, Scene
from renderers.tracing.sprites import over
from renderers.tracing.visibility_kernels import FIRST_LIGHT
from sceneql.frame import Implicit

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Frame, Shape, View


class Buffers:
    """Working memory of a picture: layer 0 is of what the camera sees, layer 1 of what is seen in that."""

    def __init__(self, count: int, columns: int) -> None:
        self.shape = count, columns
        self.records = np.zeros((2, count, COLUMNS), dtype=np.float32)
        self.radiance = np.empty((count, 3), dtype=np.float32)
        self.visibility = np.zeros((2, count, columns), dtype=np.float32)
        self.fine = np.zeros((2, count, columns), dtype=np.float32)
        self.sums = np.zeros((count, columns + 1), dtype=np.float32)
        self.means = np.zeros((count, columns + 1), dtype=np.float32)


_kept: list[Buffers] = []
"""The last picture's: fresh memory costs the system a tenth of a frame's time."""


def _buffers(count: int, columns: int) -> Buffers:
    kept = _kept.pop() if _kept else None
    return kept if kept is not None and kept.shape == (count, columns) else Buffers(count, columns)


def draw(
    frame: Frame, samples: int = 8, tolerance: float = TOLERANCE, march: int = 0, packets: bool = False
) -> Picture:
    """Ray-trace a frame; ``samples``, a power of two from 1 to 64: rays in a pixel in which things meet.

    ``tolerance`` is that of roots of implicit surfaces; with ``march`` they are looked for at so many places of a ray.
    ``packets``: the camera's rays look for them in bundles, at the usual tolerance alone.

    Roots of implicit surfaces are certified (sceneql.field); shadows and the sky's light are sampled once a pixel by a
    net and averaged over the surface around it, so that the picture has no grain and repeats to the bit.
    """
    scene, rows = pack(frame, tolerance, march)
    width, height = frame.view.size
    columns = FIRST_LIGHT + 2 * int(scene.ints[LIGHT_COUNT])
    buffers = _buffers(width * height, columns)
    undecided: list[int] = []
    bundled = packets and not march and tolerance == TOLERANCE

    def gather(start: int, stop: int) -> None:
        b, spare = buffers, np.empty(COLUMNS, np.float32)
        told = _told(frame.shapes if bundled else (), frame.view, scene, start, stop)
        undecided.append(
            gather_rows(scene, scratch(rows), start, stop, b.records, b.radiance, b.visibility, spare, *told)
        )

    over_rows(height, gather)
    for layer in range(2):
        _filter(scene, rows, buffers, layer, width, height)

    def shade(start: int, stop: int) -> None:
        shade_rows(scene, start, stop, buffers.records, buffers.fine, buffers.visibility, buffers.radiance)

    over_rows(height, shade)
    points = subpixels(samples)
    linear = np.empty((width * height, 3), dtype=np.float32)

    def smooth(start: int, stop: int) -> None:
        own, found = np.empty((3, COLUMNS), np.float32), np.empty(columns, np.float32)
        b = buffers
        smooth_rows(scene, scratch(rows), start, stop, points, b.records, b.radiance, b.visibility, own, found, linear)

    over_rows(height, smooth)
    over(frame, buffers.records[0], buffers.radiance, linear)
    _kept[:] = [buffers]
    return Picture(linear.reshape(height, width, 3), sum(undecided))


def _told(shapes: tuple[Shape, ...], view: View, scene: Scene, start: int, stop: int) -> tuple[NDArray[int64], Floats]:
    """What gathering need not look for: see bundles.camera_roots. Its kernels are for frames with implicit shapes."""
    if not any(isinstance(shape, Implicit) for shape in shapes):
        return np.zeros(0, dtype=np.int64), np.zeros((0, 0))
    from renderers.tracing.bundles import camera_roots

    return camera_roots(shapes, view, scene, start, stop)


def _filter(scene: Scene, rows: int, buffers: Buffers, layer: int, width: int, height: int) -> None:
    """The filtered visibility of a layer's records, in buffers.fine."""
    records, visibility, fine = buffers.records[layer], buffers.visibility[layer], buffers.fine[layer]
    sums, means = buffers.sums, buffers.means
    over_rows(height, lambda start, stop: widen(start, stop, width, records, visibility, sums))
    over_rows(height, lambda start, stop: deepen(start, stop, width, height, records, sums, means))
    over_rows(
        height,
        lambda start, stop: refine_rows(scene, scratch(rows), start, stop, records, visibility, means, fine),
    )
