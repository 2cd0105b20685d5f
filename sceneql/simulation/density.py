"""How far the surface of a density field can lie from its skeleton parts."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.frame import Floats

PAIRWISE_LIMIT = 2000
"""Above this number of parts, neighbors are not told apart."""


def reaches(parts: Floats, threshold: float) -> Floats:
    """(p,) distance [m] from each part within which, taken together, the solid {density >= threshold} lies; 0 for none.

    At a point of the solid let part i give the most. Of the parts that reach there, N_i at most, each gives no more,
    so w_i (1 - d_i^2/R_i^2)^3 >= c/N_i, and d_i <= R_i sqrt(1 - (c/(N_i w_i))^(1/3)). N_i counts the parts of weight
    above 0 that come within R_j of where part i can give the most; a second round uses the distances of the first.
    """
    import numpy as np

    radii, weights = parts[:, 6], parts[:, 7]
    giving = weights > 0
    gaps = _gaps(parts) if len(parts) <= PAIRWISE_LIMIT else None
    reach = np.where(giving, radii, 0.0)
    for _ in range(2):
        if gaps is None:
            count = np.full(len(parts), np.count_nonzero(giving))
        else:
            count = np.count_nonzero((gaps < reach[:, None] + radii) & giving, axis=1)
        with np.errstate(over="ignore"):  # a weight next to nothing reaches nowhere
            share = np.divide(threshold, count * weights, out=np.ones(len(parts)), where=giving & (count > 0))
        reach = radii * np.sqrt(np.maximum(0.0, 1.0 - np.cbrt(share)))
    return reach


def _gaps(parts: Floats) -> Floats:
    """(p, p) distances between the boxes around the parts' skeletons: no more than those between the skeletons."""
    import numpy as np

    ends = parts[:, :6].reshape(-1, 2, 3)
    low, high = ends.min(axis=1), ends.max(axis=1)
    apart = np.maximum(low[:, None] - high, low - high[:, None])
    distances: Floats = np.linalg.norm(np.maximum(apart, 0.0), axis=2)
    return distances
