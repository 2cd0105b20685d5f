"""Files of triangle meshes; a file appears under its final name only when complete."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.failure import Unsuitable
from sceneql.files import whole

if TYPE_CHECKING:
    from pathlib import Path

    from sceneql.frame import Floats
    from sceneql.mesh.polygons import Polygons

FORMATS = ("ply", "stl", "obj", "glb")


def format_of(path: Path) -> str:
    """The format that a path's extension names. Raises Unsuitable for another."""
    extension = path.suffix.lower().lstrip(".")
    if extension not in FORMATS:
        named = f".{extension}" if extension else "nothing"
        raise Unsuitable(f"a mesh's file ends in .{', .'.join(FORMATS)}, but {path.name} in {named}")
    return extension


def write(path: Path, polygons: Polygons, colors: Floats | None = None) -> None:
    """Write a mesh in meters, y up; with normals if the format has them and all vertices have one.

    ``colors`` (n, 3): linear RGB of the vertices, left out of an STL file. Raises Unsuitable and OSError.
    """
    import trimesh

    smooth = bool(polygons.normals.any(axis=1).all())
    mesh = trimesh.Trimesh(
        vertices=polygons.vertices,
        faces=polygons.triangles,
        vertex_normals=polygons.normals if smooth else None,
        process=False,
    )
    kind = format_of(path)
    if colors is not None:
        from sceneql.mesh.display_colors import levels

        curved = kind != "glb"  # glb stores linear colors (glTF 2.0, 3.7.2.1)
        mesh.visual = trimesh.visual.ColorVisuals(mesh, vertex_colors=levels(colors, curved=curved))
    normals = {"ply": "vertex_normal", "obj": "include_normals", "glb": "include_normals"}
    options: dict[str, Any] = {normals[kind]: smooth} if kind in normals else {}
    data: Any = mesh.export(file_type=kind, **options)
    with whole(path) as stream:
        stream.write(data.encode() if isinstance(data, str) else data)
