"""Whether places lie inside a closed mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sceneql.frame import Floats

PAIRS_AT_ONCE = 4_000_000


def winding(places: Floats, corners: Floats) -> Floats:
    """(n,) how often triangles (m, 3, 3), counterclockwise from outside, wind around places (n, 3): 1 inside, 0 out.

    The sum of the signed solid angles by 4 pi (Van Oosterom & Strackee 1983, eq. 8); holes spoil it only near them
    (Jacobson, Kavan & Sorkine-Hornung 2013).
    """
    rows = max(1, PAIRS_AT_ONCE // max(1, len(corners)))
    result = np.zeros(len(places))
    for first in range(0, len(places), rows):
        a, b, c = (corners[None, :, k] - places[first : first + rows, None] for k in range(3))
        la, lb, lc = (np.linalg.norm(side, axis=2) for side in (a, b, c))
        triple = np.sum(a * np.cross(b, c), axis=2)
        rest = la * lb * lc
        for p, q, length in ((a, b, lc), (b, c, la), (c, a, lb)):
            rest += np.sum(p * q, axis=2) * length
        result[first : first + rows] = np.arctan2(triple, rest).sum(axis=1) / (2 * np.pi)
    return result
