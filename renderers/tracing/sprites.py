"""Soft discs facing the camera, drawn over a finished picture with depth tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing.picture import over_rows
from sceneql.frame import Points

if TYPE_CHECKING:
    from numpy import float32
    from numpy.typing import NDArray

    from sceneql.frame import Floats, SeenFrame, View

SMALLEST = 1.25
"""Radius [pixels] below which a disc is drawn larger and correspondingly fainter, so that none is missed."""


def over(frame: SeenFrame, records: NDArray[float32], linear: NDArray[float32]) -> None:
    """Draw the frame's soft discs over ``linear`` (pixels, 3), shapes in their order.

    ``records``: records of the pixels' centers. Covering discs of one shape are drawn from the farthest to the nearest.
    """
    for shape in frame.shapes:
        if isinstance(shape, Points) and shape.soft is not None and len(shape.centers):
            _draw(shape, frame.view, records, linear)


def _draw(shape: Points, view: View, records: NDArray[float32], linear: NDArray[float32]) -> None:
    from renderers.tracing.sprites_kernels import cover_rows

    width, height = view.size
    discs = _discs(shape, view)
    if shape.soft == "covers":
        discs = discs[np.argsort(-discs[:, 2], kind="stable")]
    camera = np.array([*view.origin, *view.axes[2]], dtype=np.float64)
    covers = shape.soft == "covers"
    over_rows(height, lambda start, stop: cover_rows(start, stop, width, camera, discs, covers, records, linear))


def _discs(shape: Points, view: View) -> Floats:
    """Discs (n, 9) in front of the camera: x, y [pixels], depth [m], radius [pixels], radius [m], color, opacity."""
    height = view.size[1]
    away = (shape.centers - np.array(view.origin)) @ view.axes.T
    depth = -away[:, 2]
    seen = np.isfinite(depth) & (shape.radii > 0)
    if not view.orthographic:
        seen &= depth > 0
    away, depth, radii = away[seen], depth[seen], shape.radii[seen]
    scale = 0.5 * height / view.half_height / (1.0 if view.orthographic else depth)
    surface = shape.surface
    color = surface.emission if any(surface.emission) else surface.color
    discs = np.empty((len(depth), 9))
    discs[:, 0] = 0.5 * view.size[0] + scale * away[:, 0]
    discs[:, 1] = 0.5 * height - scale * away[:, 1]
    discs[:, 2] = depth
    discs[:, 3] = np.maximum(scale * radii, SMALLEST)
    discs[:, 4] = radii
    discs[:, 5:8] = color if shape.colors is None else shape.colors[seen]
    discs[:, 8] = shape.opacity * np.minimum(scale * radii / SMALLEST, 1.0) ** 2
    return discs
