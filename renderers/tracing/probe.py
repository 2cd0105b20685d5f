"""Depths and normals of a frame, by any of the ways to find implicit surfaces: what `bench` compares."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing import TOLERANCE
from renderers.tracing.pack import pack, scratch
from renderers.tracing.picture import over_rows
from renderers.tracing.probe_kernels import probe_rows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Frame


@dataclass(frozen=True, slots=True, eq=False)
class Probe:
    """What the rays through the pixels' centers meet first."""

    depth: Floats
    """(h, w) [m] along the ray; infinite where nothing is met."""
    normals: Floats
    """(h, w, 3) outward unit normals; zero where nothing is met."""
    undecided: NDArray[np.bool_]
    """(h, w)."""


def probe(frame: Frame, tolerance: float = TOLERANCE, *, march: int = 0, certain: bool = False) -> Probe:
    """Look through every pixel's center: as `trace` does, by ``march`` samples, or by certified intervals alone."""
    scene, rows = pack(frame, tolerance, march, certain)
    width, height = frame.view.size
    depth, normals = np.empty((height, width)), np.empty((height, width, 3))
    undecided = np.empty((height, width), dtype=np.bool_)
    over_rows(height, lambda start, stop: probe_rows(scene, scratch(rows), start, stop, depth, normals, undecided))
    return Probe(depth, normals, undecided)
