"""How a skin is drawn."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from sceneql.frame import Mesh, Segments
from sceneql.shapes.placement import apply, uniform_scale
from sceneql.skins.skin_outputs import positions

if TYPE_CHECKING:
    from sceneql.frame import Floats, Shape, Surface
    from sceneql.skins.flat import Line
    from sceneql.system import ModelState


def drawn(
    name: str,
    surface: Surface,
    skin: Line,
    thickness: float | None,
    filled: bool,
    state: ModelState,
    place: Floats | None = None,
) -> Iterator[Shape]:
    """A closed line of a thickness [m], by default that of its sides, and a face of what it holds half as high."""
    place = np.eye(3, 4) if place is None else place
    points = positions(skin, state)
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
