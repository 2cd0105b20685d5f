"""Shading normals of mesh files: coincident vertices merged, then split along sharp edges (creases_kernels)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.frame import held
from sceneql.shapes.creases_kernels import by_place, drop_flat, smooth

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints
    from sceneql.shapes.raw_mesh import RawMesh


def creased(raw: RawMesh, crease: float) -> tuple[Floats, Ints, Floats, Floats | None]:
    """Vertices (n, 3) [m], triangles (m, 3), unit normals (n, 3) and linear colors (n, 3) or None, for shading.

    Triangles without area are dropped. An edge is sharp where its dihedral angle differs from flat by more than
    ``crease`` [rad]. Memory grows with the number of triangles alone.
    """
    places, place_of, corners, shades = _merged(raw)
    corners = corners[: 3 * drop_flat(places, corners, np.empty((3, 3)))]
    starts = np.zeros(int(place_of.max(initial=-1)) + 3, dtype=np.int32)
    order = np.empty(len(corners), dtype=np.int32)
    most = by_place(corners, place_of, starts, order)

    def room(size: int) -> NDArray[np.int32]:
        return np.empty(size, dtype=np.int32)

    heads, seen = (np.full(size, -1, dtype=np.int32) for size in (len(starts) - 2, len(places)))
    triangles, source, normals = room(len(corners)), room(len(corners)), np.empty((len(corners), 3))
    made = smooth(
        places, place_of, corners, starts, order, crease, heads, seen, np.empty((most + 2, 3)), np.empty((most, 3)),
        np.empty(most), np.empty(2 * most), room(most), room(2 * most), room(2 * most), room(2 * most), triangles,
        source, room(most), normals,
    )  # fmt: skip
    source = source[:made]
    colors = None if shades is None else held(shades[source].astype(float))
    return places[source], triangles.reshape(-1, 3), normals[:made].copy(), colors


def _merged(raw: RawMesh) -> tuple[Floats, Ints, Ints, NDArray[np.float32] | None]:
    """Vertices merged where position and color coincide.

    Returns positions (v, 3), for each vertex the number of its position (v,), the corners of the triangles as vertices
    (3 m,), and colors (v, 3) or None.
    """
    keys = list(raw.vertices.T)
    if raw.colors is not None:
        keys += list(raw.colors.T)
    order = np.lexsort(keys[::-1])
    places = raw.vertices[order]
    moved = (places[1:] != places[:-1]).any(axis=1)
    new = np.ones(len(order), dtype=bool)
    new[1:] = moved
    place_of = np.cumsum(new, dtype=np.int32) - np.int32(1)
    shades = None
    if raw.colors is not None:
        shades = raw.colors[order]
        new[1:] |= (shades[1:] != shades[:-1]).any(axis=1)
        shades = shades[new]
    same = np.empty(len(order), dtype=np.int32)
    same[order] = np.cumsum(new, dtype=np.int32) - np.int32(1)
    return places[new], place_of[new], same[raw.triangles].reshape(-1), shades
