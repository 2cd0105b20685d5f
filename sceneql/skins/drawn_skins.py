"""Shapes that draw a skin."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from sceneql.frame import Mesh, Segments
from sceneql.shapes.placement import apply, uniform_scale
from sceneql.skins.skin_outputs import positions

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints, Shape, Surface
    from sceneql.skins.deep import Sheet
    from sceneql.skins.flat import Line
    from sceneql.system import ModelState


def drawn(
    name: str,
    surface: Surface,
    skin: Line | Sheet,
    thickness: float | None,
    filled: bool,
    state: ModelState,
    place: Floats | None = None,
) -> Iterator[Shape]:
    """Shapes of a skin: a smooth mesh in a deep flow, a closed line in a flat one.

    ``thickness`` of the line [m], by default the length of its longest side at the start. ``filled``: adds a face of
    the inside, raised by a quarter of the thickness.
    """
    place = np.eye(3, 4) if place is None else place
    points = positions(skin, state)
    if len(skin.triangles):
        places, triangles = apply(place, points), skin.triangles.astype(np.int32)
        yield Mesh(name, surface, places, triangles, _normals(places, triangles))
        return
    radius = 0.5 * (float(skin.lengths.max()) if thickness is None else thickness)
    round_it = apply(place, points)
    ends = np.stack([round_it, np.roll(round_it, -1, axis=0)], axis=1)
    yield Segments(name, surface, ends, np.full(len(ends), radius * uniform_scale(place)))
    if filled:
        from sceneql.shapes.ears import ears

        raised = apply(place, points + np.array([0.0, 0.0, 0.5 * radius]))
        up = place[:, :3] @ np.array([0.0, 0.0, 1.0])
        normals = np.tile(up / np.linalg.norm(up), (len(points), 1))
        yield Mesh(f"{name}.inside", surface, raised, ears(points).astype(np.int32), normals)


def _normals(points: Floats, triangles: Ints) -> Floats:
    """Unit normals (n, 3) of vertices: means of the adjacent triangles' normals, weighted by area."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    own = np.cross(b - a, c - a)
    sums = np.column_stack([np.bincount(triangles.ravel(), np.repeat(own[:, k], 3), len(points)) for k in range(3)])
    found: Floats = sums / np.maximum(np.linalg.norm(sums, axis=1), 1e-300)[:, None]
    return found
