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
    import numpy as np

    smooth = bool(np.einsum("vj,vj->v", polygons.normals, polygons.normals).all())
    kind = format_of(path)
    hues = None
    if colors is not None and kind != "stl":
        from sceneql.mesh.display_colors import levels

        hues = levels(colors, curved=kind != "glb")  # glb stores linear colors (glTF 2.0, 3.7.2.1)
    with whole(path) as stream:
        stream.write(_ply(polygons, smooth, hues) if kind == "ply" else _by_trimesh(polygons, smooth, hues, kind))


def _ply(polygons: Polygons, smooth: bool, hues: Any) -> bytes:
    """A binary PLY file (Turk 1994), the columns of a vertex in the order that trimesh writes them."""
    import numpy as np

    vertices, triangles = polygons.vertices, polygons.triangles
    columns = [("x y z", "<f4", "float", vertices)]
    columns += [("nx ny nz", "<f4", "float", polygons.normals)] if smooth else []
    columns += [("red green blue", "u1", "uchar", hues)] if hues is not None else []
    rows = np.empty(len(vertices), dtype=[(names, code, 3) for names, code, _, _ in columns])
    for names, _, _, values in columns:
        rows[names] = values
    faces = np.empty(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}"]
    lines += [f"property {kind} {name}" for names, _, kind, _ in columns for name in names.split()]
    lines += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header", ""]
    return "\n".join(lines).encode() + rows.tobytes() + faces.tobytes()


def _by_trimesh(polygons: Polygons, smooth: bool, hues: Any, kind: str) -> bytes:
    """A file of one of the other FORMATS."""
    import trimesh

    normals = polygons.normals if smooth else None
    mesh = trimesh.Trimesh(
        vertices=polygons.vertices, faces=polygons.triangles, vertex_normals=normals, process=False
    )  # fmt: skip
    if hues is not None:
        mesh.visual = trimesh.visual.ColorVisuals(mesh, vertex_colors=hues)
    options: dict[str, Any] = {} if kind == "stl" else {"include_normals": smooth}
    data: Any = mesh.export(file_type=kind, **options)
    return data.encode() if isinstance(data, str) else bytes(data)
