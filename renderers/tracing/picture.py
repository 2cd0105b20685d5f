"""Result of a renderer, and work over bands of rows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sceneql.compiled.kernels import over_tiles

if TYPE_CHECKING:
    from numpy import float32
    from numpy.typing import NDArray

BAND = 16
"""Number of pixel rows that a thread takes at a time."""


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """Picture of a frame as a renderer returns it."""

    linear: NDArray[float32]
    """(h, w, 3): scene-referred linear RGB, or data."""
    undecided: int = 0
    """Number of pixels with a ray on which root isolation left an interval undecided."""
    unsearched: int = 0
    """Number of rays that were not searched, since the search of others at the same object had led nowhere."""


def over_rows(height: int, work: Callable[[int, int], object]) -> None:
    """Call ``work(start, stop)`` for bands of rows, on the thread pool."""
    over_tiles(-(-height // BAND), lambda band: work(band * BAND, min(band * BAND + BAND, height)))
