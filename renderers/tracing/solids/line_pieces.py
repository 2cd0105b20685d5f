"""Lines made of capsules that share ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

if TYPE_CHECKING:
    from sceneql.frame import Floats


def line_lengths(ends: Floats, same: float) -> Floats:
    """Length (n,) [m] of the line that each capsule, with ends (n, 2, 3) [m], belongs to, along all its pieces.

    Ends rounded to the same multiple of ``same`` [m] count as one place.
    """
    places = np.round(ends.reshape(-1, 3) / same)
    order = np.lexsort(places.T)
    new = np.any(np.diff(places[order], axis=0) != 0.0, axis=1)
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.concatenate([[0], np.cumsum(new)])
    first, last = number.reshape(-1, 2).T
    links = coo_array((np.ones(len(first), dtype=bool), (first, last)), shape=(number.max() + 1,) * 2)
    _, line = connected_components(links, directed=False)
    of = line[first]
    lengths: Floats = np.bincount(of, np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1))[of]
    return lengths
