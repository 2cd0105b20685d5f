"""Result of a renderer, and work over bands of rows."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sceneql.compiled.kernels import over_tiles, thread_count
from sceneql.doing import doing

if TYPE_CHECKING:
    from numpy import float32
    from numpy.typing import NDArray

BAND = 16
"""Number of pixel rows that a thread takes at a time."""
BROAD = 4 * BAND
"""Most rows of stages that do little for each pixel: what comes between their kernels finds the caches cold."""


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """Picture of a frame as a renderer returns it."""

    linear: NDArray[float32]
    """(h, w, 3): scene-referred linear RGB, or data."""
    undecided: int = 0
    """Number of pixels with a ray on which root isolation left an interval undecided."""
    unsearched: int = 0
    """Number of rays that were not searched, since the search of others at the same object had led nowhere."""


def over_rows(height: int, work: Callable[[int, int], object], what: str = "", most: int = BAND) -> None:
    """Call ``work(start, stop)`` for bands of rows, on the thread pool; ``what`` it does is told with how far it is.

    ``most``: rows of a band. They become fewer towards the end, so that no thread waits long for another one.
    """
    ends = _ends(height, most, thread_count())
    with doing(what) if what else nullcontext() as deed:
        done = iter(range(1, len(ends) + 1))

        def one(number: int) -> None:
            work(ends[number - 1] if number else 0, ends[number])
            if deed is not None:
                deed.what = f"{what}, {100 * next(done) // len(ends)} %"

        over_tiles(len(ends), one)


def _ends(height: int, most: int, threads: int) -> list[int]:
    """Ends of bands of up to ``most`` rows, each at most half of a thread's share of the rest, or one of BAND rows."""
    ends = [0]
    while ends[-1] < height:
        share = most if threads == 1 else (height - ends[-1]) // (2 * threads)
        ends.append(min(height, ends[-1] + max(BAND, min(most, share - share % BAND))))
    return ends[1:]
