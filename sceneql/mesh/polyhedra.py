"""Volume, center and second moments of polyhedra, as sums over tetrahedra. Imports numpy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.kinds import VolumeMoments
from sceneql.mesh.holes import caps, loops, open_sides, welded

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints

PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))
"""Coordinates (i, j) of the second moments, in their order in an array."""
LEAST = 1e-15
"""Volume relative to the cubed size that counts as zero: what rounding leaves of a flat mesh."""


def moments(vertices: Floats, triangles: Ints) -> VolumeMoments:
    """Moments of the solid in a closed mesh, triangles (m, 3) counterclockwise from outside (Mirtich 1996, section 2).

    Exact but for rounding, at any distance from the origin. Raises ValueError for a mesh that is open, inside out or
    flat.
    """
    places, welded_triangles = welded(vertices, triangles)
    sides = open_sides(welded_triangles)
    if len(sides) and len(caps(places, sides)[1]):
        count = len(loops(sides))
        raise ValueError(
            f"its mesh is not closed: {count} hole{'s' if count > 1 else ''} of {len(sides)} edges,"
            " or triangles beside each other that face opposite ways"
        )
    middle = vertices.mean(axis=0)
    size = float(np.ptp(vertices, axis=0).max())
    whole = integrals(vertices, triangles, middle)
    if whole[0] < 0.0:
        raise ValueError(f"its mesh is turned inside out: it encloses {whole[0]:.4g} m^3")
    if not whole[0] > LEAST * size**3:
        raise ValueError("its mesh encloses no volume")
    # Integrated again about the center of mass, where no large terms cancel.
    center = middle + whole[1:4] / whole[0]
    return about(integrals(vertices, triangles, center), center)


def integrals(vertices: Floats, triangles: Ints, origin: Floats) -> Floats:
    """(10,) volume integrals of 1, of p (3), and of the products PAIRS of p's coordinates (6), p relative to an origin.

    The sum over the tetrahedra between ``origin`` (3,) and each triangle, signed by the triangle's orientation.
    """
    a, b, c = (np.ascontiguousarray((vertices[triangles[:, k]] - origin).T) for k in range(3))
    det = (a * np.cross(b, c, axis=0)).sum(axis=0)
    total = a + b + c
    rows = [det / 6.0, *(det * total / 24.0)]
    for i, j in PAIRS:
        rows.append(det * (total[i] * total[j] + a[i] * a[j] + b[i] * b[j] + c[i] * c[j]) / 120.0)
    # numpy sums contiguous rows pairwise: rounding grows with the logarithm of their length.
    found: Floats = np.array([row.sum() for row in rows])
    return found


def about(whole: Floats, origin: Floats) -> VolumeMoments:
    """Moments about the center of mass, from ``integrals`` about an origin (3,)."""
    away = whole[1:4] / whole[0]
    second = np.empty((3, 3))
    for value, (i, j) in zip(whole[4:], PAIRS, strict=True):
        second[i, j] = second[j, i] = value - whole[0] * away[i] * away[j]
    return VolumeMoments(float(whole[0]), origin + away, second)
