"""Sets of nonnegative integers, as places in a sparsity pattern, by sorting."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray


def rising(keys: NDArray[int64]) -> NDArray[int64]:
    """The distinct values of nonnegative integers, ascending.

    Numpy's `unique` hashes them and takes many times as long.
    """
    import numpy as np

    ordered = np.sort(keys)
    found: NDArray[int64] = ordered[np.flatnonzero(np.diff(ordered, prepend=-1))]
    return found
