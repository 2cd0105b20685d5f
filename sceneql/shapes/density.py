"""Bounds on the distance of a density field's surface from the parts of its skeleton."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.field.skeleton.skeleton import Skeleton
    from sceneql.frame import Floats

PAIRWISE_LIMIT = 2000
"""Number of parts above which distances between parts are not computed: all count as neighbors of each."""


def reaches(skeleton: Skeleton, threshold: float) -> Floats:
    """(p,) distances [m] from the parts whose union of neighborhoods contains {density >= threshold c}; 0: empty.

    At a point of the solid let part i have the largest contribution, w_i K(d_i / R_i). At most N_i parts reach the
    point, so this contribution is at least c / N_i; since the kernel K decreases, that bounds the distance d_i. N_i
    counts the parts j of positive weight whose support R_j meets the neighborhood of part i. A second pass counts with
    the distances of the first.
    """
    return skeleton.kept(f"reaches {threshold!r}", lambda: _reaches(skeleton, threshold))


def _reaches(skeleton: Skeleton, threshold: float) -> Floats:
    import numpy as np

    from sceneql.field.skeleton.profile import farthest

    radii, weights = skeleton.largest, skeleton.weights
    giving = weights > 0
    gaps = _gaps(skeleton.corners) if len(radii) <= PAIRWISE_LIMIT else None
    reach = np.where(giving, radii, 0.0)
    for _ in range(2):
        if gaps is None:
            count = np.full(len(radii), np.count_nonzero(giving))
        else:
            count = np.count_nonzero((gaps < reach[:, None] + radii) & giving, axis=1)
        with np.errstate(over="ignore"):  # a weight near 0 gives inf, and reaches nowhere
            share = np.divide(threshold, count * weights, out=np.ones(len(radii)), where=giving & (count > 0))
        reach = radii * farthest(skeleton.kernel, share)
    return reach


def _gaps(corners: Floats) -> Floats:
    """(p, p) distances between the boxes around the parts: lower bounds of the distances between the parts."""
    import numpy as np

    low, high = corners.min(axis=1), corners.max(axis=1)
    apart = np.maximum(low[:, None] - high, low - high[:, None])
    distances: Floats = np.linalg.norm(np.maximum(apart, 0.0), axis=2)
    return distances
