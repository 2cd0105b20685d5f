"""Absorbing volumes over a finished picture, each as far as what stands in it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing.mist_kernels import depths
from renderers.tracing.picture import over_rows
from renderers.tracing.record_kernels import OWNER, PLACE

if TYPE_CHECKING:
    from numpy import float32
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Mist, View


def dim(shape: Mist, view: View, records: NDArray[float32], linear: NDArray[float32]) -> None:
    """Draw a mist over ``linear`` (pixels, 3); ``records``: what the camera sees in each pixel.

    What is behind is dimmed by exp(-depth) (Beer, Lambert), and as much of the mist's own color is added.
    """
    width, height = view.size
    turn, shift = np.asarray(shape.to_cells)[:, :3], np.asarray(shape.to_cells)[:, 3]
    field = np.ascontiguousarray(shape.absorption, dtype=np.float64)
    low, high = np.array(shape.low, dtype=np.float64), np.array(shape.high, dtype=np.float64)

    def work(start: int, stop: int) -> None:
        rows = slice(start * width, stop * width)
        origins, ways = rays(view, start, stop)
        seen = records[rows].astype(np.float64)
        far = ((seen[:, PLACE : PLACE + 3] - origins) * ways).sum(axis=1)
        ends = np.where(seen[:, OWNER] == 0.0, np.inf, far)
        depth = np.empty(len(ways))
        depths(origins @ turn.T + shift, ways @ turn.T, ends, field, low, high, depth)
        kept = np.exp(-depth)[:, None]
        linear[rows] = kept * linear[rows] + (1.0 - kept) * np.array(shape.surface.color)

    over_rows(height, work)


def rays(view: View, start: int, stop: int) -> tuple[Floats, Floats]:
    """Origins and unit directions (n, 3) of the rays through the middles of some rows' pixels."""
    width, height = view.size
    columns, rows = np.meshgrid(np.arange(width) + 0.5, np.arange(start, stop) + 0.5)
    across = (2.0 * columns.ravel()[:, None] - width) / height * view.half_height * view.axes[0]
    across += (1.0 - 2.0 * rows.ravel()[:, None] / height) * view.half_height * view.axes[1]
    if view.orthographic:
        # What stands before the window's plane is seen as well.
        back = 1e4 * max(1.0, view.half_height)
        return np.array(view.origin) + across + back * view.axes[2], np.broadcast_to(-view.axes[2], across.shape)
    ways = across - view.axes[2]
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    return np.broadcast_to(np.array(view.origin, dtype=float), ways.shape), ways
