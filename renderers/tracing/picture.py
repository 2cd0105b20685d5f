"""The result of a renderer, and the bands of rows by which it is made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sceneql.compiled.kernels import over_tiles

if TYPE_CHECKING:
    from numpy import float32
    from numpy.typing import NDArray

BAND = 16
"""Rows of pixels that a thread takes at a time."""


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """What a renderer makes of a frame."""

    linear: NDArray[float32]
    """(h, w, 3): scene-referred linear RGB, or data."""
    undecided: int = 0
    """Pixels with a ray on which root isolation left a place undecided."""


def over_rows(height: int, work: Callable[[int, int], object]) -> None:
    """Call ``work(start, stop)`` for bands of rows, on the thread pool."""
    over_tiles(-(-height // BAND), lambda band: work(band * BAND, min(band * BAND + BAND, height)))
