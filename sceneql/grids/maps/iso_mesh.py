"""Meshes of frame.Grid surfaces, for renderers and measures that know only triangles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from sceneql.frame import Grid, Mesh
from sceneql.grids.maps.interpolation import trilinear
from sceneql.grids.maps.iso import iso_sheet
from sceneql.grids.maps.sheets import kept
from sceneql.mesh.polygons import Polygons
from sceneql.shapes.placement import apply, inverse

if TYPE_CHECKING:
    from sceneql.frame import Floats


def meshed(grid: Grid) -> Mesh:
    """The mesh, with normals, of a grid's zero surface by marching cubes, clipped at its box and its ``bounds``."""
    sheet = iso_sheet(*_within(grid))
    if grid.bounds is not None:
        bounds = grid.bounds
        sheet = kept(sheet, lambda places: trilinear(bounds, places))
    slopes = np.gradient(grid.values)
    normals = np.stack([trilinear(slope, sheet.vertices) for slope in reversed(slopes)], axis=1)
    normals = normals @ grid.to_nodes[:, :3]
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    place = inverse(grid.to_nodes)
    triangles = sheet.triangles if np.linalg.det(place[:, :3]) > 0 else sheet.triangles[:, ::-1].copy()
    return Mesh(grid.name, grid.surface, apply(place, sheet.vertices), triangles, normals)


def polygons_of(grids: Sequence[Grid]) -> tuple[Polygons, float]:
    """The triangles of several grids' surfaces, and the shortest side [m] of their cells."""
    meshes = [meshed(grid) for grid in grids]
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    triangles = [mesh.triangles + start for mesh, start in zip(meshes, starts, strict=False)]
    normals = [mesh.normals for mesh in meshes if mesh.normals is not None]
    finest = max(float(np.linalg.norm(grid.to_nodes[:, :3], axis=1).max()) for grid in grids)
    vertices = np.concatenate([mesh.vertices for mesh in meshes])
    return Polygons(vertices, np.concatenate(triangles).astype(np.int32), np.concatenate(normals)), 1.0 / finest


def _within(grid: Grid) -> tuple[tuple[Floats, Floats, Floats], Floats]:
    """Node positions along x, y, z with the first and last moved to the sides of the box, and the values there."""
    axes, values = [], grid.values
    for axis, (low, high) in enumerate(zip(grid.low, grid.high, strict=True)):
        inner = np.arange(np.floor(low) + 1.0, np.ceil(high))
        places = np.concatenate([[low], inner, [high]])
        first = np.minimum(np.floor(places).astype(int), values.shape[2 - axis] - 2)
        share = (places - first).reshape([-1 if 2 - axis == k else 1 for k in range(3)])
        below, above = (np.take(values, first + step, axis=2 - axis) for step in (0, 1))
        values = (1.0 - share) * below + share * above
        axes.append(places)
    return (axes[0], axes[1], axes[2]), np.ascontiguousarray(values)
