"""Mesh files that trimesh reads: PLY, STL, OFF, GLB and glTF. Their headers were checked before (mesh_header)."""

from __future__ import annotations

import logging
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
import trimesh

from sceneql.shapes.mesh_limits import counted
from sceneql.shapes.raw_mesh import RawMesh, linear

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy import float32
    from numpy.typing import NDArray

    from sceneql.shapes.mesh_header import Declared

logging.getLogger("trimesh").addHandler(logging.NullHandler())  # trimesh's complaints reach the user once, as an error
MOST_SOLIDS = 10_000
"""Most solids of an ASCII STL: trimesh makes a mesh of each before they are joined."""
TOLD = {
    "PLY is unexpected length!": "its rows are not as long as its header says, or its faces differ in their corners",
}
"""Plain text for messages of trimesh that do not explain themselves."""
LINEAR = ("glb", "gltf")
"""Formats whose colors are linear (glTF 2.0, 3.7.2.1)."""


def read_foreign(path: Path, found: Declared) -> RawMesh:
    """All triangles of a file, in the coordinates of its scene.

    Raises ValueError, also where trimesh raises any exception, and its subclass Exceeds.
    """
    with path.open("rb") as stream, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        # numpy only warns where it stops at text that is no number
        warnings.filterwarnings("error", "string or file could not be read", DeprecationWarning)
        if found.format == "stl" and found.triangles is None:
            _few_solids(stream.read())
            stream.seek(0)
        try:
            others: dict[str, bytes] = {}  # contents of the other files that it may refer to: none
            scene = trimesh.load_scene(
                stream, file_type=found.format, resolver=others, skip_materials=True, process=False
            )
            parts = list(_placed(scene))
        except MemoryError:
            raise
        except Exception as error:  # a library of many readers raises anything for a file that is broken
            raise ValueError(TOLD.get(str(error), f"{error} ({type(error).__name__})")) from error
    vertices = sum(len(part.vertices) for part in parts)
    triangles = sum(len(part.triangles) for part in parts)
    counted(triangles, vertices)
    if (found.vertices or 0) > vertices or (found.triangles or 0) > triangles:
        text = f"it declares {found.vertices:,} vertices and {found.triangles:,} faces"
        raise ValueError(f"{text}, and has {vertices:,} and {triangles:,}")
    return _joined(parts, found.format in LINEAR)


def _few_solids(text: bytes) -> None:
    """Raise ValueError for an ASCII STL of more than MOST_SOLIDS solids."""
    solids = text.lower().count(b"endsolid")
    if solids > MOST_SOLIDS:
        raise ValueError(f"it has {solids:,} solids, more than {MOST_SOLIDS:,}")


def _placed(scene: Any) -> Iterator[RawMesh]:
    """The mesh of each node of a scene, in the scene's coordinates, with colors as in the file (sRGB or linear)."""
    for node in scene.graph.nodes_geometry:
        place, name = scene.graph[node]
        mesh = scene.geometry[name]
        if not isinstance(mesh, trimesh.Trimesh):
            continue  # points or lines
        vertices, triangles = np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces)
        if not np.array_equal(place, np.eye(4)):
            vertices = vertices @ place[:3, :3].T + place[:3, 3]
            if np.linalg.det(place[:3, :3]) < 0:
                triangles = triangles[:, ::-1]
        look: Any = mesh.visual
        colors = look.vertex_colors[:, :3].astype(np.float32) / np.float32(255) if look.kind == "vertex" else None
        if len(triangles) and (triangles.min() < 0 or triangles.max() >= len(vertices)):
            raise ValueError("a face has a vertex that is not there")
        yield RawMesh(vertices, triangles, colors)


def _joined(parts: list[RawMesh], is_linear: bool) -> RawMesh:
    """The meshes joined into one; colors are linear, or None unless all parts have colors."""
    firsts = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    some = [part.colors for part in parts if part.colors is not None]
    colors: NDArray[float32] | None = None
    if parts and len(some) == len(parts):
        colors = np.concatenate(some)
        colors = colors if is_linear else linear(colors)
    return RawMesh(
        np.concatenate([part.vertices for part in parts] or [np.zeros((0, 3))]),
        np.concatenate(
            [part.triangles.astype(np.int32) + np.int32(first) for part, first in zip(parts, firsts, strict=True)]
            or [np.zeros((0, 3), dtype=np.int32)]
        ),
        colors,
    )
