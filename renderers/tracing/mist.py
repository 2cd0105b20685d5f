"""Absorbing volumes over a finished picture, each as far as the surface that stands in it."""

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

STEP = 0.01
"""Difference of transmittance between neighboring pixels from which on there is an edge."""
FAINT = 1e-3
"""Difference of two colors below which their shares in a pixel do not matter."""


def dim(
    shape: Mist, view: View, records: NDArray[float32], radiance: NDArray[float32], linear: NDArray[float32]
) -> None:
    """Draw a mist over ``linear`` (pixels, 3); ``records``, ``radiance``: of the center of each pixel.

    Both pictures are changed. The background is dimmed by the transmittance exp(-depth) (Beer, Lambert), and the rest
    is the mist's own color.
    """
    width, height = view.size
    turn, shift = np.asarray(shape.to_cells)[:, :3], np.asarray(shape.to_cells)[:, 3]
    field = np.ascontiguousarray(shape.absorption, dtype=np.float64)
    low, high = np.array(shape.low, dtype=np.float64), np.array(shape.high, dtype=np.float64)
    depth = np.empty(len(records))

    def work(start: int, stop: int) -> None:
        rows = slice(start * width, stop * width)
        origins, ways = rays(view, start, stop)
        seen = records[rows].astype(np.float64)
        far = ((seen[:, PLACE : PLACE + 3] - origins) * ways).sum(axis=1)
        ends = np.where(seen[:, OWNER] == 0.0, np.inf, far)
        depths(origins @ turn.T + shift, ways @ turn.T, ends, field, low, high, depth[rows])

    over_rows(height, work)
    color = np.array(shape.surface.color)
    kept = np.exp(-depth)
    edges, other = _steps(kept.reshape(height, width))
    own, beside = radiance[edges].astype(np.float64), radiance[other].astype(np.float64)
    away = own - beside
    square = (away * away).sum(axis=1)
    apart = square > FAINT**2
    share = np.clip(((linear[edges] - beside) * away).sum(axis=1) / np.where(apart, square, 1.0), 0.0, 1.0)[:, None]
    mixed = kept[edges, None] + (1.0 - share) * (kept[other] - kept[edges])[:, None]
    parts = share * kept[edges, None] * own + (1.0 - share) * kept[other, None] * beside
    smooth = (parts + (1.0 - mixed) * color)[apart]
    for picture in (linear, radiance):  # the next mist lies over this one
        picture[:] = kept[:, None] * picture + (1.0 - kept[:, None]) * color
    linear[edges[apart]] = smooth


def _steps(kept: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Edges in a transmittance (h, w): pixels (k,), and for each its most different neighbor of four.

    At an edge a pixel's color is a mean of two surfaces, each with a depth of its own.
    """
    number = np.arange(kept.size).reshape(kept.shape)
    best, other = np.full(kept.shape, STEP), number.copy()
    for axis in range(2):
        for way in (1, -1):
            beside = np.roll(number, way, axis)
            at_rim = [slice(None)] * 2
            at_rim[axis] = slice(0, 1) if way == 1 else slice(-1, None)
            beside[tuple(at_rim)] = number[tuple(at_rim)]
            step = abs(kept.ravel()[beside] - kept)
            other = np.where(step > best, beside, other)
            best = np.maximum(best, step)
    edges = np.flatnonzero(best.ravel() > STEP)
    return edges, other.ravel()[edges]


def rays(view: View, start: int, stop: int) -> tuple[Floats, Floats]:
    """Origins and unit directions (n, 3) of the rays through the centers of some rows' pixels."""
    width, height = view.size
    columns, rows = np.meshgrid(np.arange(width) + 0.5, np.arange(start, stop) + 0.5)
    across = (2.0 * columns.ravel()[:, None] - width) / height * view.half_height * view.axes[0]
    across += (1.0 - 2.0 * rows.ravel()[:, None] / height) * view.half_height * view.axes[1]
    if view.orthographic:
        # Objects before the window's plane are seen as well.
        back = 1e4 * max(1.0, view.half_height)
        return np.array(view.origin) + across + back * view.axes[2], np.broadcast_to(-view.axes[2], across.shape)
    ways = across - view.axes[2]
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    return np.broadcast_to(np.array(view.origin, dtype=float), ways.shape), ways
