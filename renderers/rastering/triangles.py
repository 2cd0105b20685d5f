"""Triangle meshes with normals for all kinds of shapes (frame.Shape)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from renderers.rastering.skins import skin
from renderers.rastering.solids import capsule_sides, ellipsoid, faces, round_column, unit_ball
from sceneql.frame import Implicit, Mesh, Points, Quadric, Segments, held
from sceneql.shapes.held_arrays import OfHeld

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints, Shape, Surface

MOST_BALLS = 500_000
DETAIL = ((100, 4), (1_000, 3), (8_000, 2), (40_000, 1), (MOST_BALLS, 0))
"""Pairs (largest number of balls, number of subdivisions of each)."""


_flat: OfHeld[tuple[Floats, Floats, Ints]] = OfHeld()


@dataclass(frozen=True, slots=True, eq=False)
class Triangles:
    """Triangles of one surface: vertices (n, 3) [m] and unit normals (n, 3) in the world, triangles (m, 3)."""

    surface: Surface
    vertices: Floats
    normals: Floats
    triangles: Ints
    colors: Floats | None = None
    """(n, 3): linear RGB that replaces the surface's color."""
    flat: bool = False
    """Whether all faces are planes with their own vertices."""


def boundless(shape: Shape) -> bool:
    """Whether a shape is infinite, such as a plane."""
    if not isinstance(shape, Quadric) or any(shape.squares):
        return False
    return any(shape.linear) or not np.isfinite([shape.low, shape.high]).all()


def triangles(shape: Shape, cells: int, sharp: bool = False, reach: float = 0.0) -> Iterator[Triangles]:
    """Triangles of a shape; of an implicit one from ``skin``, of a boundless one as far as ``reach`` [m].

    Raises ValueError for a shape that cannot be drawn by triangles.
    """
    if isinstance(shape, Mesh):
        yield _of_mesh(shape)
    elif isinstance(shape, Implicit):
        if shape.within is not None:
            raise ValueError(f"raster draws solids alone, and '{shape.name}' is a sheet; draw it by `trace`")
        made = skin(shape, cells, sharp)
        if len(made.triangles):
            yield _of_mesh(made)
    elif isinstance(shape, Quadric):
        yield _of_quadric(shape, reach)
    elif isinstance(shape, Points) and shape.soft is None:
        yield from _balls(shape.surface, shape.centers, shape.radii, shape.colors)
    elif isinstance(shape, Segments):
        yield from _rods(shape)
    else:
        what = "soft discs" if isinstance(shape, Points) else type(shape).__name__.lower()
        raise ValueError(f"raster does not draw '{shape.name}' ({what}); draw it by `trace`")


def _of_mesh(mesh: Mesh) -> Triangles:
    if mesh.paint is not None and mesh.rest is not None:
        from sceneql.field.tape.tape_solid import paint_values

        mesh = replace(mesh, colors=paint_values(mesh.paint, mesh.rest), paint=None)
    if mesh.normals is not None:
        return Triangles(mesh.surface, mesh.vertices, mesh.normals, mesh.triangles, mesh.colors)
    points, normals, order = _flat.get((mesh.vertices, mesh.triangles), None, lambda: _parted(mesh))
    colors = None if mesh.colors is None else mesh.colors[mesh.triangles].reshape(-1, 3)
    return Triangles(mesh.surface, points, normals, order, colors)


def _parted(mesh: Mesh) -> tuple[Floats, Floats, Ints]:
    """Vertices (3 m, 3), normals and triangles (m, 3) of a mesh with flat faces; cached."""
    corners = mesh.vertices[mesh.triangles]
    normals = np.repeat(_unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])), 3, axis=0)
    order = np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3)
    return held(corners.reshape(-1, 3)), held(normals), held(order)


def _of_quadric(shape: Quadric, reach: float) -> Triangles:
    """Triangles of a ball, ellipsoid, column, block or plane: the convex solids that words draw as quadrics.

    Raises ValueError for any other quadric.
    """
    squares, linear = np.array(shape.squares, dtype=float), np.array(shape.linear, dtype=float)
    low, high = np.array(shape.low), np.array(shape.high)
    place = np.linalg.inv(np.vstack([shape.to_local, [0.0, 0.0, 0.0, 1.0]]))[:3]
    curved = squares > 0
    if linear.any() and not curved.any():
        points, normals, order = _half_space(shape, reach)
        return Triangles(shape.surface, points, normals, order, flat=True)
    middle = np.where(curved, -linear / np.where(curved, 2 * squares, 1.0), 0.0)
    rest = float((squares * middle**2).sum() - shape.constant)
    radii = np.sqrt(max(rest, 0.0) / np.where(curved, squares, 1.0))
    if curved.all() and np.all(middle - radii >= low - 1e-9) and np.all(middle + radii <= high + 1e-9):
        points, normals, order = ellipsoid(middle, radii)
    elif curved.sum() == 2 and np.isfinite(low[~curved]).all() and np.isfinite(high[~curved]).all():
        axis = int(np.argmin(curved))
        points, normals, order = round_column(axis, middle, radii, low[axis], high[axis])
    elif not curved.any():
        points, normals, order = faces(
            np.where(np.isfinite(low), low, -reach), np.where(np.isfinite(high), high, reach)
        )
    else:
        raise ValueError(f"raster cannot make triangles of '{shape.name}'; draw it by `trace`")
    linear_part = place[:, :3]
    if np.linalg.det(linear_part) < 0:
        order = order[:, ::-1]
    normals = _unit(normals @ np.linalg.inv(linear_part))
    return Triangles(shape.surface, points @ linear_part.T + place[:, 3], normals, order, flat=not curved.any())


def _half_space(shape: Quadric, reach: float) -> tuple[Floats, Floats, Ints]:
    """Square of the plane linear . p + constant = 0: half side ``reach`` [m], center nearest to the origin."""
    normal = np.array(shape.linear) @ shape.to_local[:, :3]
    offset = float(np.dot(shape.linear, shape.to_local[:, 3]) + shape.constant)
    length = float(np.linalg.norm(normal))
    normal /= length
    across = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    across /= np.linalg.norm(across)
    along = np.cross(normal, across)
    origin = -offset / length * normal
    sides = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    points = np.array([origin + reach * (a * across + b * along) for a, b in sides])
    return points, np.tile(normal, (4, 1)), np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)


def _balls(surface: Surface, centers: Floats, radii: Floats, colors: Floats | None) -> Iterator[Triangles]:
    if len(centers) == 0:
        return
    if len(centers) > MOST_BALLS:
        raise ValueError(f"raster draws at most {MOST_BALLS:,} balls; `trace` draws {len(centers):,}")
    detail = next(level for most, level in DETAIL if len(centers) <= most)
    directions, order = unit_ball(detail)
    count = len(directions)
    points = (centers[:, None] + radii[:, None, None] * directions).reshape(-1, 3)
    starts = count * np.arange(len(centers), dtype=np.int32)
    every = (order[None] + starts[:, None, None]).reshape(-1, 3)
    painted = None if colors is None else np.repeat(colors, count, axis=0)
    yield Triangles(surface, points, np.tile(directions, (len(centers), 1)), every, painted)


def _rods(shape: Segments) -> Iterator[Triangles]:
    if len(shape.ends) == 0:
        return
    points, normals, order = capsule_sides(shape.ends, shape.radii)
    colors = None if shape.colors is None else np.repeat(shape.colors, len(points) // len(shape.ends), axis=0)
    yield Triangles(shape.surface, points, normals, order, colors)
    twice = None if shape.colors is None else np.repeat(shape.colors, 2, axis=0)
    yield from _balls(shape.surface, shape.ends.reshape(-1, 3), np.repeat(shape.radii, 2), twice)


def _unit(vectors: Floats) -> Floats:
    found: Floats = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-300)
    return found
