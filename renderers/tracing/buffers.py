"""Working memory for all pixels of a picture."""

from __future__ import annotations

from sys import getrefcount
from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing.camera_kernels import TILE
from renderers.tracing.filter.planes_kernels import KEYS, LANES, WIDE
from renderers.tracing.record_kernels import COLUMNS

if TYPE_CHECKING:
    from numpy import float32
    from numpy.typing import NDArray


class Buffers:
    """Arrays of all pixels. Layer 0: surfaces seen directly; layer 1: surfaces mirrored or refracted in those."""

    def __init__(self, width: int, height: int, columns: int, layers: int, hard: bool) -> None:
        """``columns``: number of visibilities; ``hard``: whether light is hard, so that visibility is not filtered."""
        self.shape, count = (width, height, columns, layers, hard), width * height
        self.records = np.zeros((layers, count, COLUMNS), dtype=np.float32)
        self.radiance, self._linear = (np.empty((count, 3), dtype=np.float32) for _ in range(2))
        self.visibility = np.zeros((layers, count, columns), dtype=np.float32)
        chunks, filtered = -(-width // LANES), 0 if hard else height
        self.planes = np.zeros((height, chunks * (KEYS + (0 if hard else columns) * WIDE)), dtype=np.float32)
        self.fine = np.zeros((layers, filtered * width, columns), dtype=np.float32)
        self.sums = np.zeros((filtered, chunks * (1 + columns) * LANES), dtype=np.float32)
        self.means = np.zeros((filtered, chunks * (1 + columns) * WIDE), dtype=np.float32)
        self.cuts = np.empty((layers, count * columns if hard else 0), dtype=np.int64)
        """Edges from ``hard_kernels.list_cuts``; those of a band of rows begin at its first visibility's index."""
        bands = -(-height // TILE)
        self.reached = np.zeros((bands, -(-width // TILE)), dtype=np.int8)
        self.busy = np.ones_like(self.reached)
        self.mirrored = np.zeros_like(self.reached)
        self.laid, self.chunks = np.ones((2, bands, chunks), dtype=np.int8)

    def linear(self) -> NDArray[float32]:
        """Memory (h w, 3) for the picture: that of the last one, unless it is still referenced elsewhere."""
        if getrefcount(self._linear) > ALONE:
            self._linear = np.empty_like(self._linear)
        return self._linear

    def radiance_as_linear(self) -> NDArray[float32]:
        """The radiance (h w, 3) as the picture, without a copy: the next picture's goes elsewhere."""
        self.radiance, self._linear = self.linear(), self.radiance
        return self._linear


ALONE = 2
"""Reference count of an array held by one attribute: the attribute and getrefcount's argument. Views add to it."""
_kept: list[Buffers] = []
"""Buffers of the last picture: allocating fresh memory takes a tenth of a frame's time."""


def take(width: int, height: int, columns: int, layers: int, hard: bool) -> Buffers:
    """Buffers with the arguments of Buffers: those ``put_back`` last, if they have the same shape."""
    shape = width, height, columns, layers, hard
    kept = _kept.pop() if _kept else None
    return kept if kept is not None and kept.shape == shape else Buffers(*shape)


def put_back(buffers: Buffers) -> None:
    """Keep buffers for the next picture."""
    _kept[:] = [buffers]
