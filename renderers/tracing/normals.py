"""Pictures of normals and of undecided roots, from the tracer's intersections without light."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing.certified import TOLERANCE
from renderers.tracing.light.sampling_kernels import subpixels
from renderers.tracing.normals_kernels import normal_rows, undecided_rows
from renderers.tracing.pack import pack
from renderers.tracing.picture import Picture, over_rows
from renderers.tracing.scratch import patient, scratch

if TYPE_CHECKING:
    from sceneql.frame import SeenFrame


def draw_normals(frame: SeenFrame, samples: int = 1) -> Picture:
    """Picture of (n + 1)/2 for world normals n, 0 for rays without a surface; ``samples`` rays in a pixel."""
    scene, rows = pack(frame)
    width, height = frame.view.size
    points = subpixels(samples)
    picture = np.empty((height, width, 3), dtype=np.float32)
    undecided: list[int] = []

    def band(start: int, stop: int) -> None:
        undecided.append(normal_rows(scene, scratch(rows), start, stop, points, picture))

    over_rows(height, band)
    return Picture(picture, sum(undecided))


def draw_undecided(frame: SeenFrame, tolerance: float = TOLERANCE) -> Picture:
    """Picture with orange for a root undecided at the ``tolerance``, gray for surfaces, black for none."""
    scene, rows = pack(frame, tolerance)
    width, height = frame.view.size
    picture = np.empty((height, width, 3), dtype=np.float32)
    undecided: list[int] = []

    def band(start: int, stop: int) -> None:
        undecided.append(undecided_rows(scene, patient(scratch(rows)), start, stop, picture))

    over_rows(height, band)
    return Picture(picture, sum(undecided))
