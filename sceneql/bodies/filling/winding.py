"""Whether points lie inside a closed mesh, and where segments leave it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sceneql.frame import Floats

PAIRS_AT_ONCE = 4_000_000
EDGE = 1e-9
"""Tolerance in barycentric coordinates, so that no segment passes between two triangles."""


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


def exits(inner: Floats, outer: Floats, corners: Floats) -> Floats:
    """(n,) fractions (0..1) at which segments from ``inner`` to ``outer``, each (n, 3), first hit triangles (m, 3, 3).

    NaN where none is met (Moeller & Trumbore 1997).
    """
    rows = max(1, PAIRS_AT_ONCE // max(1, len(corners)))
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    result = np.full(len(inner), np.nan)
    for at in range(0, len(inner), rows):
        start = inner[at : at + rows, None] - corners[None, :, 0]
        way = (outer - inner)[at : at + rows, None]
        across, turned = np.cross(way, second), np.cross(start, first)
        with np.errstate(divide="ignore", invalid="ignore"):
            whole = np.sum(across * first, axis=2)
            u = np.sum(across * start, axis=2) / whole
            v = np.sum(turned * way, axis=2) / whole
            t = np.sum(turned * second, axis=2) / whole
            met = (u >= -EDGE) & (v >= -EDGE) & (u + v <= 1.0 + EDGE) & (t >= 0.0) & (t <= 1.0)
        nearest = np.where(met, t, np.inf).min(axis=1, initial=np.inf)
        result[at : at + rows] = np.where(np.isfinite(nearest), nearest, np.nan)
    return result
