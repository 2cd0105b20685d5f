"""Sets of places in a pattern: whole numbers in order, each once."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray


def rising(keys: NDArray[int64]) -> NDArray[int64]:
    """Numbers from 0 on in order, each once; numpy's own `unique` hashes them, which takes many times as long."""
    import numpy as np

    ordered = np.sort(keys)
    found: NDArray[int64] = ordered[np.flatnonzero(np.diff(ordered, prepend=-1))]
    return found
