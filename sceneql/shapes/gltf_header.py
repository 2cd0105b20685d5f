"""The JSON description in a glTF 2.0 file (Khronos 2021): its counts, its consistency, no reference to other files.

Imports no numpy, since the command `check` uses it.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any, BinaryIO, NamedTuple

from sceneql.kinds import Exceeds
from sceneql.shapes.mesh_limits import LARGEST_BINARY, LARGEST_DESCRIPTION, counted, within

MOST_PARTS = 500_000
"""Most objects, lists and values of the description, by its brackets and commas."""
MOST_NODES = 10_000
DEEPEST = 200
"""Most levels of the trees of nodes."""
SIZES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
"""Bytes of a number by its componentType."""
COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
HARMLESS = ("KHR_materials_", "KHR_texture_", "KHR_lights_", "EXT_texture_", "KHR_mesh_quantization", "KHR_xmp")
"""Prefixes of extensions that do not change the triangles, or that the reader supports anyway."""
JSON, BINARY = 0x4E4F534A, 0x004E4942


def glb(stream: BinaryIO, size: int) -> tuple[int, int]:
    """Vertices and triangles of all instances that a GLB declares. Raises ValueError and Exceeds."""
    within(size, LARGEST_BINARY)
    head = stream.read(20)
    magic, version, length, described, kind = (int.from_bytes(head[k : k + 4], "little") for k in range(0, 20, 4))
    if len(head) < 20 or magic != 0x46546C67 or version != 2 or kind != JSON:
        raise ValueError("it does not begin as a GLB of version 2 with a description")
    if length != size:
        raise ValueError(f"it declares {length:,} bytes, and has {size:,}")
    if 20 + described > size:
        raise ValueError(f"it declares a description of {described:,} bytes, and {size - 20:,} follow")
    within(described, LARGEST_DESCRIPTION, "the description in a GLB may have")
    text = stream.read(described)
    buffers: list[int] = []
    at, others = 20 + described, 0
    while at + 8 <= size:
        stream.seek(at)
        chunk = stream.read(8)
        length, kind = int.from_bytes(chunk[:4], "little"), int.from_bytes(chunk[4:], "little")
        at += 8 + length
        if at > size or others > 100:
            raise ValueError(f"its chunk of {length:,} bytes ends behind the file, or there are more than 100")
        others += 1
        if kind == BINARY:
            buffers.append(length)
    return _sums(text, buffers)


def gltf(stream: BinaryIO, size: int) -> tuple[int, int]:
    """Vertices and triangles of all instances that a glTF declares. Raises ValueError and Exceeds."""
    within(size, LARGEST_DESCRIPTION, "a .gltf may have: a .glb may have more")
    return _sums(stream.read(), [])


def _sums(text: bytes, own: list[int]) -> tuple[int, int]:
    """Vertices and triangles of all instances in a description; ``own``: bytes of the GLB's binary chunks."""
    parts = sum(text.count(mark) for mark in (b"{", b"[", b","))
    if parts > MOST_PARTS:
        raise Exceeds(f"has a description of {parts:,} parts, more than {MOST_PARTS:,}")
    try:
        tree = json.loads(text)
        return _Description(tree, own).sums()
    except Exceeds:
        raise
    except ValueError as error:
        told = f"its description is no JSON ({error})" if isinstance(error, json.JSONDecodeError) else str(error)
        raise ValueError(told) from error
    except (KeyError, TypeError, IndexError, AttributeError, RecursionError) as error:
        raise ValueError(f"its description is no glTF ({type(error).__name__}: {error})") from error


class _Counts(NamedTuple):
    """Numbers of vertices and triangles of a mesh's primitives."""

    vertices: int
    triangles: int


class _Description:
    """The JSON of a glTF, not validated: methods raise ValueError, KeyError, TypeError or IndexError for a bad one."""

    def __init__(self, tree: dict[str, Any], own: list[int]) -> None:
        self.tree, self.own = tree, own

    def sums(self) -> tuple[int, int]:
        """Vertices and triangles of all instances."""
        version = self.tree["asset"]["version"]
        if not str(version).startswith("2"):
            raise ValueError(f"it is glTF of version {str(version)[:20]}, not 2")
        for name in self.tree.get("extensionsRequired", []):
            if not str(name).startswith(HARMLESS):
                raise ValueError(f"it needs the extension {str(name)[:60]}: save it without")
        self._buffers()
        meshes = [self._mesh(mesh) for mesh in self.tree.get("meshes", [])]
        vertices = triangles = 0
        for node in self._shown():
            if "mesh" in node:
                mesh = meshes[_index(node["mesh"])]
                vertices, triangles = vertices + mesh.vertices, triangles + mesh.triangles
        if not triangles:
            raise ValueError("it shows no triangles")
        counted(triangles, vertices)
        return vertices, triangles

    def _buffers(self) -> None:
        """Raise ValueError for buffers in other files, and for views and accessors that exceed their buffers."""
        sizes, own = [], iter(self.own)
        for buffer in self.tree.get("buffers", []):
            uri = buffer.get("uri")
            if uri is None:
                sizes.append(next(own, 0))
            elif uri.startswith("data:") and "base64," in uri[:200]:
                sizes.append(len(uri) * 3 // 4)
            else:
                raise ValueError(f"it reads another file, '{uri[:60]}': save it as one .glb")
        views = []
        for view in self.tree.get("bufferViews", []):
            length = _index(view["byteLength"])
            if _index(view.get("byteOffset", 0)) + length > sizes[_index(view["buffer"])]:
                raise ValueError(f"it declares {length:,} bytes that its buffer has not")
            views.append(length)
        read = 0
        for accessor in self.tree.get("accessors", []):
            if "sparse" in accessor or ("bufferView" not in accessor and accessor["count"]):
                raise ValueError("it has sparse or compressed numbers: save it without")
            item = SIZES[accessor["componentType"]] * COLUMNS[accessor["type"]]
            count = _index(accessor["count"])
            read += count * item
            if count:
                view = self.tree["bufferViews"][_index(accessor["bufferView"])]
                stride = _index(view.get("byteStride", item))
                end = _index(accessor.get("byteOffset", 0)) + (count - 1) * stride + item
                if end > views[accessor["bufferView"]] or stride < 1:
                    raise ValueError(f"it declares {count:,} rows of {item} bytes that its buffer has not")
        if max(read, sum(views)) > LARGEST_BINARY:
            raise Exceeds(f"declares {max(read, sum(views)):,} bytes of numbers, more than {LARGEST_BINARY:,}")

    def _mesh(self, mesh: dict[str, Any]) -> _Counts:
        """Numbers of vertices and triangles of a mesh's primitives."""
        vertices = triangles = 0
        for primitive in mesh["primitives"]:
            mode = primitive.get("mode", 4)
            if mode == 6:
                raise ValueError("it has fans of triangles: save it without")
            if mode not in (4, 5):
                continue  # points and lines
            places = self.tree["accessors"][_index(primitive["attributes"]["POSITION"])]
            if places["type"] != "VEC3" or places.get("normalized"):
                raise ValueError("its places are compressed: save it without")
            rows = places["count"]
            if "indices" in primitive:
                rows = self.tree["accessors"][_index(primitive["indices"])]["count"]
            vertices += places["count"]
            triangles += rows // 3 if mode == 4 else max(rows - 2, 0)
        return _Counts(vertices, triangles)

    def _shown(self) -> Iterator[dict[str, Any]]:
        """The nodes of the default scene. Raises ValueError where they do not form trees, Exceeds for too many."""
        nodes = self.tree.get("nodes", [])
        if len(nodes) > MOST_NODES:
            raise Exceeds(f"has {len(nodes):,} nodes, more than {MOST_NODES:,}")
        scenes = self.tree.get("scenes", [{}])
        todo = [(_index(root), 1) for root in scenes[_index(self.tree.get("scene", 0))].get("nodes", [])]
        seen: set[int] = set()
        while todo:
            number, depth = todo.pop()
            if number in seen or depth > DEEPEST:
                raise ValueError(f"its nodes are no trees: node {number} stands in two, or more than {DEEPEST} deep")
            seen.add(number)
            yield nodes[number]
            todo += [(_index(child), depth + 1) for child in nodes[number].get("children", [])]


def _index(value: Any) -> int:
    """The value as a nonnegative integer. Raises ValueError for anything else."""
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise ValueError(f"its description has {str(value)[:40]} where it counts")
    return value
