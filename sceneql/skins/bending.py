"""Bending energy of skins: its terms in the island, and its value. Imports numpy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.system import Assembly, Membrane


def add_to_line(skin: Membrane, bend: float, held: int, assembly: Assembly) -> None:
    """Add the bending term of a closed line; ``bend``: bending stiffness times depth [N m^2]; ``held``: HELD_AT."""
    ints = (skin.count, skin.position_at, skin.force_at, assembly.floats([bend]), held)
    assembly.term("internal", "sceneql.skins.bend_line_kernels:bend", ints, stiff=True)


def add_to_sheet(skin: Membrane, bend: float, assembly: Assembly) -> None:
    """Add the bending term of a closed sheet; ``bend``: bending stiffness [J]."""
    folds = folds_of(skin.faces)
    head = (skin.count, skin.position_at, skin.force_at, assembly.floats([bend]))
    sums = assembly.floats(np.zeros(2 * skin.count))
    ints = (*head, sums, len(folds), *folds.ravel().tolist(), *skin.faces.ravel().tolist())
    assembly.term("internal", "sceneql.skins.bend_sheet_kernels:bend", ints)


def folds_of(triangles: NDArray[int64]) -> NDArray[int64]:
    """Edges (k, 4) of a closed sheet (m, 3): both vertices, then the vertices opposite on the left and the right."""
    ways = np.concatenate([np.roll(triangles, -k, axis=1) for k in range(3)])
    up = ways[ways[:, 0] < ways[:, 1]]
    down = ways[ways[:, 0] > ways[:, 1]]
    up, down = up[np.lexsort((up[:, 1], up[:, 0]))], down[np.lexsort((down[:, 0], down[:, 1]))]
    return np.column_stack([up, down[:, 2]])


def of_line(points: Floats) -> float:
    """Integral of half the squared curvature along a closed line (n, 2) [1/m]."""
    sides = np.roll(points, -1, axis=0) - points
    before = np.roll(sides, 1, axis=0)
    across = before[:, 0] * sides[:, 1] - before[:, 1] * sides[:, 0]
    angles = np.arctan2(across, (before * sides).sum(axis=1))
    lengths = 0.5 * (np.hypot(*sides.T) + np.hypot(*before.T))
    return float(0.5 * (angles**2 / lengths).sum())


def of_sheet(points: Floats, triangles: NDArray[int64]) -> float:
    """Integral of half the square of twice the mean curvature over a closed sheet with vertices (n, 3) [1]."""
    a, b, c, d = (points[one] for one in folds_of(triangles).T)
    along = b - a
    left, right = np.cross(along, c - a), np.cross(d - a, along)
    lengths = np.linalg.norm(along, axis=1)
    angles = np.arctan2((np.cross(left, right) * along).sum(axis=1), lengths * (left * right).sum(axis=1))
    sums = np.bincount(folds_of(triangles)[:, :2].T.ravel(), np.tile(lengths * angles, 2), len(points))
    corners = points[triangles]
    twice = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    areas = np.bincount(triangles.ravel(), np.repeat(twice / 6.0, 3), len(points))
    return float((sums**2 / areas).sum() / 8.0)
