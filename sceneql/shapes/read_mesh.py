"""OBJ files to arrays, once for a run; size and numbers of a file are checked before it is used."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from sceneql.failure import LimitRefused

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints

LARGEST_FILE = 64 * 2**20
MOST_TRIANGLES = 4_000_000


@dataclass(frozen=True, slots=True, eq=False)
class Loaded:
    """A file's triangles, with vertices split along sharp edges."""

    vertices: Floats
    """(n, 3)"""
    triangles: Ints
    """(m, 3), counterclockwise seen from the front."""
    normals: Floats
    """(n, 3) unit."""


@lru_cache(maxsize=16)
def load(file: str, crease: float) -> Loaded:
    """The triangles of an OBJ file; edges that turn by more than ``crease`` [rad] are sharp. Reads no other file.

    Raises OSError for a file that cannot be read or is no mesh, LimitRefused for one that is too large.
    """
    import io

    import numpy as np
    import trimesh

    path = Path(file)
    size = path.stat().st_size
    if size > LARGEST_FILE:
        raise LimitRefused(f"{path.name} has {size} bytes, more than the {LARGEST_FILE} that a mesh may have")
    try:
        path.read_bytes().decode()  # an OBJ file is text; guessing another encoding needs one more library
        # Without a resolver, material and texture files that it names are not opened.
        whole = trimesh.load_mesh(io.BytesIO(path.read_bytes()), file_type="obj", skip_materials=True, process=False)
        if len(whole.faces) > MOST_TRIANGLES:
            raise LimitRefused(f"{path.name} has {len(whole.faces)} triangles, more than {MOST_TRIANGLES}")
        vertices, faces = np.asarray(whole.vertices, dtype=float), np.asarray(whole.faces)
    except (ValueError, IndexError, KeyError, TypeError, AttributeError) as error:
        raise OSError(f"{path.name} is no OBJ mesh: {error}") from error
    if not len(faces):
        raise OSError(f"{path.name} has no triangles")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise OSError(f"{path.name} has a face with a vertex that is not there")
    if not np.isfinite(vertices).all():
        raise OSError(f"{path.name} has a vertex that is not finite")
    return _creased(vertices, faces, crease)


def _creased(vertices: Floats, faces: Ints, crease: float) -> Loaded:
    """Each corner's normal is the mean of the normals of its vertex's faces within the crease angle, by area."""
    import numpy as np

    places, same = np.unique(vertices, axis=0, return_inverse=True)
    corners = same.reshape(-1)[faces]
    a, b, c = (places[corners[:, k]] for k in range(3))
    areas = np.cross(b - a, c - a)
    real = np.linalg.norm(areas, axis=1) > 0
    corners, areas = corners[real], areas[real]
    units = areas / np.linalg.norm(areas, axis=1, keepdims=True)
    of_vertex = corners.reshape(-1)
    order = np.argsort(of_vertex, kind="stable")
    starts = np.searchsorted(of_vertex[order], np.arange(len(places) + 1))
    normals = np.empty((len(of_vertex), 3))
    least = np.cos(crease)
    for k in range(len(places)):
        mine = order[starts[k] : starts[k + 1]]
        if len(mine):
            face = mine // 3
            near = units[face] @ units[face].T >= least - 1e-12
            normals[mine] = near @ areas[face]
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    keys = np.column_stack([of_vertex, np.round(normals * 1e6)])
    _, first, index = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return Loaded(places[of_vertex[first]], index.reshape(-1, 3).astype(np.int32), normals[first])
