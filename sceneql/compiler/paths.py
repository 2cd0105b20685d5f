"""Paths of files named by a script: they must exist, below the scene's folder."""

from __future__ import annotations

from pathlib import Path

from sceneql.language.tree import Node, Scalar
from sceneql.quantities.diagnostic import Diagnostics

_EXPORTED = (".blend", ".fbx", ".dae", ".3ds", ".max", ".ma", ".mb", ".c4d", ".usd", ".usdz", ".step", ".stp")
"""Endings of files that programs for meshes write, and that nothing here reads."""


def read_path(node: Node, folder: Path, what: str, found: Diagnostics) -> str | None:
    """The path of an existing file below the scene's folder, links followed; None after reporting an error."""
    if not isinstance(node, Scalar) or not node.text.strip():
        found.error("wrong-shape", f"{what} is the path of a file", node.span)
        return None
    path = folder / node.text
    try:
        inside = path.resolve().is_relative_to(folder.resolve())
        there = inside and path.is_file()
    except (OSError, ValueError):  # a name that no file can have
        inside, there = True, False
    if not inside:
        help = "copy it beside the scene, and name it by a path below it"
        found.error("file-outside", f"{what} stays inside the scene's folder", node.span, help=help)
        return None
    if not there:
        help = f"it is looked for at {path}"
        if "://" in node.text:
            help = f"no file is fetched: save it beside the scene, and write `{what}: {path.name}`"
        if node.text.startswith("~"):
            help = f"no `~` is read: copy it beside the scene, and write `{what}: {path.name}`"
        if path.suffix.lower() in _EXPORTED:
            help = f"export it there as GLB, OBJ, PLY or STL: a {path.suffix} file is its own program's alone"
        found.error("file-missing", f"there is no file '{node.text}'", node.span, help=help)
        return None
    return str(path)
