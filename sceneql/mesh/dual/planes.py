"""Points moved onto the tangent planes of a surface near them. Imports numpy and numba."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.field.tape.tape_solid import field_values, many_gradients

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Tape

TURNS = 3
NEARER = 0.05
"""Distance of the planes' points from the moved point, relative to the turn before; converges on curved faces."""
TRUNCATION = 0.1
"""Singular values below this share of the largest count as zero, as in the kernel ``dual``."""


def onto_planes(tape: Tape, points: Floats, given: NDArray[np.bool_], crossings: Floats, slopes: Floats) -> Floats:
    """Points (n, 3) moved onto the surface's tangent planes at ``crossings`` (n, k, 3), by least squares.

    ``given`` (n, k) masks the crossings in use, ``slopes`` (n, k, 3) are the unit gradients there. The move is the
    shortest one (truncated pseudoinverse): by the rank of its planes a point moves onto a face, an edge or a corner of
    the solid.
    """
    import numpy as np

    points = points.copy()
    normals = np.where(given[:, :, None], slopes, 0.0)
    away = np.einsum("nkj,nkj->nk", normals, crossings - points[:, None])
    for turn in range(TURNS):
        if turn:
            steps = NEARER**turn * (crossings - points[:, None])
            beside = (points[:, None] + steps).reshape(-1, 3)
            with np.errstate(all="ignore"):
                values, slopes = field_values(tape, beside), many_gradients(tape, beside)
                sizes = np.linalg.norm(slopes, axis=1)
                known = given.ravel() & (sizes > 0.0) & np.isfinite(sizes) & np.isfinite(values)
                normals = np.where(known[:, None], slopes / sizes[:, None], 0.0).reshape(crossings.shape)
                values = np.where(known, values / sizes, 0.0).reshape(given.shape)
            away = np.einsum("nkj,nkj->nk", normals, steps) - values
        points += np.einsum("njk,nk->nj", np.linalg.pinv(normals, rcond=TRUNCATION), away)
    return points
