"""Mesh files to arrays, cached until the file changes; sizes and numbers are checked before use."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from sceneql.failure import LimitRefused
from sceneql.kinds import Exceeds
from sceneql.shapes.mesh_header import declared
from sceneql.shapes.mesh_limits import unreadable

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints
    from sceneql.shapes.raw_mesh import RawMesh

FARTHEST = 1e100
"""[m] Largest coordinate: products of longer edges would overflow."""


@dataclass(frozen=True, slots=True, eq=False)
class Loaded:
    """A file's triangles, with vertices split along sharp edges."""

    vertices: Floats
    """(n, 3)"""
    triangles: Ints
    """(m, 3), counterclockwise seen from the front."""
    normals: Floats
    """(n, 3) unit."""
    colors: Floats | None
    """(n, 3) linear RGB where the file has colors of all vertices, else None."""


def load(file: str, crease: float) -> Loaded:
    """The triangles of a mesh file; edges that turn by more than ``crease`` [rad] are sharp. Reads no other file.

    A file that has been written since it was last read is read anew.

    Raises OSError for a file that cannot be read or is no mesh, LimitRefused for one that is too large.
    """
    now = Path(file).stat()
    return _load(file, crease, (now.st_dev, now.st_ino, now.st_size, now.st_mtime_ns, now.st_ctime_ns))


@lru_cache(maxsize=16)
def _load(file: str, crease: float, identity: tuple[int, ...]) -> Loaded:
    """As ``load``; ``identity`` differs between files and between states of one file, and is the key of the cache."""
    from sceneql.shapes.creases import creased

    raw = _read(Path(file))
    _check(raw, Path(file).name)
    loaded = Loaded(*creased(raw, crease))
    if not len(loaded.triangles):
        raise OSError(f"{Path(file).name} has no triangle of any area")
    return loaded


def _read(path: Path) -> RawMesh:
    """Triangles and colors of a file. Raises OSError and LimitRefused."""
    try:
        found = declared(str(path))
        if found.format == "obj":
            from sceneql.shapes.read_obj import read_obj

            raw = read_obj(path)
        else:
            from sceneql.shapes.read_foreign import read_foreign

            raw = read_foreign(path, found)
        if not len(raw.triangles):
            raise ValueError("it has no triangles")
        return raw
    except Exceeds as error:
        raise LimitRefused(str(error)) from error
    except ValueError as error:
        raise unreadable(path.name, error) from error


def _check(raw: RawMesh, name: str) -> None:
    """Raise OSError for indices or coordinates that no mesh can have."""
    import numpy as np

    if raw.triangles.min() < 0 or raw.triangles.max() >= len(raw.vertices):
        raise OSError(f"{name} has a face with a vertex that is not there")
    if not np.isfinite(raw.vertices).all():
        raise OSError(f"{name} has a vertex that is not finite")
    if np.abs(raw.vertices).max() > FARTHEST:
        raise OSError(f"{name} has a vertex that is farther away than {FARTHEST:g} m")
