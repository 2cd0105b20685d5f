"""Result of a renderer, and work over bands of rows."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sceneql.compiled.kernels import over_tiles
from sceneql.doing import doing

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


def over_rows(height: int, work: Callable[[int, int], object], what: str = "") -> None:
    """Call ``work(start, stop)`` for bands of rows, on the thread pool; ``what`` it does is told with how far it is."""
    bands = -(-height // BAND)
    with doing(what) if what else nullcontext() as deed:
        done = iter(range(1, bands + 1))

        def one(band: int) -> None:
            work(band * BAND, min(band * BAND + BAND, height))
            if deed is not None:
                deed.what = f"{what}, {100 * next(done) // bands} %"

        over_tiles(bands, one)
