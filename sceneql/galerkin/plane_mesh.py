"""Triangle meshes inside outlines, with vertices at corners and quadratic sides on the outline. Imports numpy."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.galerkin import plane_corners
from sceneql.galerkin.field_mesh import FieldMesh, sized
from sceneql.galerkin.plane_quality import delaunay, outer_sides, smoothed
from sceneql.galerkin.plane_stuffing import Values, crossing, sides_of, stuffed
from sceneql.galerkin.simplex import Simplex

if TYPE_CHECKING:
    from sceneql.frame import Floats

LEAST_BENT = 0.2
"""Least Jacobian of a curved triangle, relative to the straight one."""
FINE, THIN = 0.25, 0.95
"""Check for thin parts: points FINE spacings apart; one inside farther than THIN spacings from all vertices fails."""
GAP = 0.05
"""Largest distance [spacings] outside the outline of centers and inner sides."""
LOOKED_AT = (0.1, 0.25, 0.5, 0.75, 0.9)
"""Fractions of inner sides at which they are tested."""
ROUGH = 1e-4
"""Tolerance, relative to a side, of vertices on the outline while they are smoothed."""
ROUNDS = 3
"""Rounds of smoothing and flips."""


class TooCoarse(ValueError):
    """Error for a domain with parts or gaps too thin for the spacing."""


def outlined(low: Floats, high: Floats, spacing: float, level: Any, element: Simplex) -> FieldMesh | None:
    """Mesh of the inside of a flat level (grids.domain.cut.Level); None if no triangle lies inside.

    Raises TooCoarse for parts, or gaps between parts, thinner than the spacing.
    """

    def values(points: Floats) -> Floats:
        found: Floats = level.values(np.column_stack([points, np.zeros(len(points))]))
        return found

    made = stuffed(low[:2], high[:2], spacing, values)
    if not len(made.triangles):
        return None
    told = getattr(level, "corners", None)
    corners = plane_corners.corners_of(made, values, spacing) if told is None else told()
    made, fixed = plane_corners.kept(made, _distinct(corners, spacing), spacing)

    def onto(places: Floats, normals: Floats, reach: Floats, within: float = 4e-16) -> Floats:
        way = reach[:, None] * normals
        inner, outer = places - way, places + way
        met = (values(inner) < 0.0) & ~(values(outer) < 0.0)
        found = np.full_like(places, np.nan)
        share = crossing(values, inner[met], outer[met], within)
        found[met] = inner[met] + share[:, None] * (outer - inner)[met]
        return found

    points, triangles = made.points, delaunay(made.points, made.triangles)
    for _ in range(ROUNDS):
        points = smoothed(points, triangles, fixed, partial(onto, within=ROUGH))
        triangles = delaunay(points, triangles)
    points = _settled(points, triangles, fixed, onto)
    _whole(points, triangles, low[:2], high[:2], spacing, values)
    _, outer = outer_sides(triangles)
    middles = 0.5 * (points[outer[:, 0]] + points[outer[:, 1]])
    pieces = level.pieces(np.column_stack([middles, np.zeros(len(middles))]))
    straight = flat_mesh(points, triangles, element, pieces, level.names)
    return straight if element.degree == 1 else _curved(straight, onto)


def _settled(points: Floats, triangles: Any, fixed: Any, onto: Any) -> Floats:
    """Points with the vertices of outer sides moved onto the outline to rounding, except ``fixed`` ones."""
    _, outer = outer_sides(triangles)
    normals = np.zeros_like(points)
    way = points[outer[:, 1]] - points[outer[:, 0]]
    for k in (0, 1):
        np.add.at(normals, outer[:, k], np.stack([way[:, 1], -way[:, 0]], axis=1))
    free = np.setdiff1d(outer, fixed)
    size = np.linalg.norm(normals[free], axis=1)
    found = onto(points[free], normals[free] / np.maximum(size, 1e-300)[:, None], 10.0 * ROUGH * size)
    met = np.isfinite(found).all(axis=1)
    points = points.copy()
    points[free[met]] = found[met]
    return points


def flat_mesh(points: Floats, triangles: Any, element: Simplex, pieces: Any, names: tuple[str, ...]) -> FieldMesh:
    """Mesh of triangles (t, 3) with points (n, 2) and straight sides; ``pieces``: of outer sides, in their order."""
    cells = triangles
    if element.degree == 2:
        ends, which = sides_of(triangles)
        points = np.concatenate([points, 0.5 * (points[ends[:, 0]] + points[ends[:, 1]])])
        cells = np.concatenate([triangles, len(points) - len(ends) + which[:, [2, 0, 1]]], axis=1)
    own, _ = outer_sides(triangles)
    return FieldMesh(element, points, cells.astype(np.int64), cells.astype(np.int64), len(points), own, pieces, names)


def _distinct(corners: Floats, spacing: float) -> Floats:
    """Corners (k, 2) without duplicates."""
    kept: list[Any] = []
    for corner in corners:
        if all(np.abs(corner - other).max() > 1e-3 * spacing for other in kept):
            kept.append(corner)
    return np.array(kept).reshape(-1, 2)


def _curved(mesh: FieldMesh, onto: Any) -> FieldMesh:
    """Mesh with the nodes on outer sides moved onto the outline, unless that bends a triangle too much."""
    from dataclasses import replace

    points = mesh.points.copy()
    own = np.array(mesh.element.side_nodes())[mesh.faces[:, 1]]
    nodes = np.take_along_axis(mesh.cells[mesh.faces[:, 0]], own, axis=1)
    way = points[nodes[:, 1]] - points[nodes[:, 0]]
    length = np.linalg.norm(way, axis=1)
    normal = np.stack([way[:, 1], -way[:, 0]], axis=1) / length[:, None]
    found = onto(points[nodes[:, 2]], normal, 0.4 * length)
    met = np.isfinite(found).all(axis=1)
    points[nodes[met, 2]] = found[met]
    places = np.concatenate([mesh.element.rule[0], np.eye(3), np.full((3, 3), 0.5) - 0.5 * np.eye(3)])
    least = LEAST_BENT * sized(mesh.element, mesh.points[mesh.cells], places[:1])
    bad = (sized(mesh.element, points[mesh.cells], places) < least).any(axis=1)
    back = np.unique(mesh.cells[bad, 3:])
    points[back] = mesh.points[back]
    return replace(mesh, points=points)


def _whole(points: Floats, triangles: Any, low: Floats, high: Floats, spacing: float, values: Values) -> None:
    """Raise TooCoarse for a part, or a gap between parts, too thin for the lattice to resolve."""
    from scipy.spatial import cKDTree

    counts = np.ceil((high - low) / (FINE * spacing)).astype(int) + 1
    axes = [np.linspace(a, b, n) for a, b, n in zip(low, high, counts, strict=True)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    places = places[values(places) < 0.0]
    if len(places):
        away, _ = cKDTree(points).query(places)
        k = int(np.argmax(away))
        if away[k] > THIN * spacing:
            raise TooCoarse(f"at ({places[k][0]:.3g}, {places[k][1]:.3g}) m it is thinner than the spacing")
    ends, which = sides_of(triangles)
    one, two = points[ends[np.bincount(which.ravel()) == 2]].transpose(1, 0, 2)
    inner = np.concatenate([points[triangles].mean(axis=1), *(one + part * (two - one) for part in LOOKED_AT)])
    beyond = np.maximum(values(inner), 0.0)
    some = np.flatnonzero(beyond > 0.0)
    steep = np.linalg.norm(plane_corners.slopes(values, inner[some], 1e-3 * spacing), axis=1)
    beyond[some] /= np.maximum(steep, 1e-300)
    k = int(np.argmax(beyond))
    if beyond[k] > GAP * spacing:
        raise TooCoarse(f"at ({inner[k][0]:.3g}, {inner[k][1]:.3g}) m a gap or bay is narrower than the spacing")
