"""Headers of mesh files: format, numbers of vertices and triangles, so that a bad file is refused before it is read.

Imports no numpy, since the command `check` uses it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO, NamedTuple

from sceneql.kinds import Exceeds
from sceneql.shapes.gltf_header import glb, gltf
from sceneql.shapes.mesh_limits import LARGEST_BINARY, LARGEST_STREAM, LARGEST_TEXT, counted, unreadable, within

LARGEST_HEADER = 2**16
"""Most bytes of a PLY's header, and of the lines before the vertices in an OFF."""


class Declared(NamedTuple):
    """Format and counts that a mesh file's header declares; None where the header has no counts."""

    format: str
    """The file name's extension: obj, ply, stl, off, glb, gltf."""
    vertices: int | None = None
    triangles: int | None = None
    """A lower bound: a polygon counts as one triangle."""


def declared(file: str) -> Declared:
    """The header of a mesh file in the format that its extension names.

    Raises Exceeds for a file that is too large, OSError for one that is not of that format or of an unknown one.
    """
    path = Path(file)
    form = path.suffix.lower().lstrip(".")
    if form not in READERS:
        endings = f".{', .'.join(READERS)}"
        raise OSError(f"{path.name} is no mesh that can be read: the name of one ends in {endings}")
    size = path.stat().st_size
    with path.open("rb") as stream:
        try:
            found = READERS[form](stream, size)
        except Exceeds as error:
            raise Exceeds(f"{path.name} {error}") from error
        except ValueError as error:
            raise unreadable(path.name, error) from error
    return found


def _text_within(size: int) -> None:
    within(size, LARGEST_TEXT, "one that is text may have: as OBJ or binary it may be larger")


def _obj(stream: BinaryIO, size: int) -> Declared:
    within(size, LARGEST_STREAM)
    if b"\0" in stream.read(4096):
        raise ValueError("it is not text")
    return Declared("obj")


def _stl(stream: BinaryIO, size: int) -> Declared:
    within(size, LARGEST_BINARY)
    start = stream.read(1024)
    count = int.from_bytes(start[80:84], "little")
    if size == 84 + 50 * count and len(start) >= 84:
        counted(count, 3 * count)
        return Declared("stl", 3 * count, count)
    if start.lstrip()[:5].lower() == b"solid" and b"\0" not in start:
        _text_within(size)
        return Declared("stl")
    text = f"it is not text that begins with solid, and as binary it declares {count:,} triangles"
    raise ValueError(f"{text}, {84 + 50 * count:,} bytes, and has {size:,}")


PLY_BYTES = {
    **dict.fromkeys(("char", "uchar", "int8", "uint8"), 1),
    **dict.fromkeys(("short", "ushort", "int16", "uint16"), 2),
    **dict.fromkeys(("int", "uint", "float", "int32", "uint32", "float32"), 4),
    **dict.fromkeys(("double", "float64"), 8),
}


class _Element:
    """An element of a PLY's header: name, number of rows, and the properties of a row."""

    def __init__(self, name: str, count: str) -> None:
        if not count.isdecimal() or len(count) > 18:
            raise ValueError(f"it declares '{count[:40]}' rows of '{name[:40]}'")
        self.name, self.count = name, int(count)
        self.bytes = self.columns = 0
        self.names: list[str] = []

    def take(self, words: list[str]) -> None:
        """Add a property, given as the words of its header line. Raises ValueError for a malformed line."""
        many = words[1:2] == ["list"]
        types = words[2:-1] if many else words[1:-1]
        if len(types) != (2 if many else 1) or any(kind not in PLY_BYTES for kind in types) or words[-1] in self.names:
            raise ValueError(f"its header has the line '{' '.join(words)[:60]}'")
        self.bytes += PLY_BYTES[types[0]]  # a list has at least its length
        self.columns += 1
        self.names.append(words[-1])


def _ply(stream: BinaryIO, size: int) -> Declared:
    within(size, LARGEST_BINARY)
    text, elements = _ply_header(stream)
    if text:
        _text_within(size)
    left = size - stream.tell()
    least = sum(one.count * (2 * one.columns if text else one.bytes) for one in elements.values())
    if least > left + 1:  # the last line may have no end
        raise ValueError(f"its header declares rows of {least:,} bytes or more, and {left:,} follow")
    if not {"x", "y", "z"} <= set(elements["vertex"].names):
        raise ValueError("its vertices have no x, y and z")
    triangles, vertices = elements["face"].count, elements["vertex"].count
    counted(triangles, vertices)
    return Declared("ply", vertices, triangles)


def _ply_header(stream: BinaryIO) -> tuple[bool, dict[str, _Element]]:
    """(whether the format is ASCII, elements by name); leaves the stream at the first row. Raises ValueError."""
    lines: list[list[str]] = []
    while "end_header" not in (words := stream.readline(LARGEST_HEADER).decode("ascii", "replace").split()):
        lines.append(words)
        if not words or stream.tell() > LARGEST_HEADER or lines[0][0] != "ply":
            raise ValueError("it has no header from 'ply' to 'end_header'")
    form = [*lines[1], ""] if len(lines) > 1 else [""]
    if form[0] != "format" or form[1] not in ("ascii", "binary_little_endian", "binary_big_endian"):
        raise ValueError("its second line is not 'format' with ascii, binary_little_endian or binary_big_endian")
    elements: dict[str, _Element] = {}
    last: _Element | None = None
    for words in lines[2:]:
        if words[:1] == ["element"] and len(words) == 3 and words[1] not in elements:
            last = elements[words[1]] = _Element(words[1], words[2])
        elif words[:1] == ["property"] and last is not None:
            last.take(words)
        elif words[:1] not in [["comment"], ["obj_info"]]:
            raise ValueError(f"its header has the line '{' '.join(words)[:60]}'")
    if not {"vertex", "face"} <= set(elements):
        raise ValueError("it has no vertices and faces")
    if "edge" in elements:
        raise ValueError("it has edges beside its faces")
    if not all(one.columns for one in elements.values()):
        raise ValueError("it has rows without properties")
    return form[1] == "ascii", elements


def _off(stream: BinaryIO, size: int) -> Declared:
    _text_within(size)
    words: list[str] = []
    while len(words) < 4 and stream.tell() < LARGEST_HEADER and (line := stream.readline(LARGEST_HEADER)):
        words += line.partition(b"#")[0].decode("ascii", "replace").split()
    if words[:1] not in [["OFF"], ["COFF"]] or len(words) < 4 or not all(w.isdecimal() for w in words[1:4]):
        raise ValueError("it does not begin with OFF and the numbers of its vertices, faces and edges")
    vertices, triangles = (int(word[:18]) for word in words[1:3])
    if 6 * (vertices + triangles) > size:  # "0 0 0" and a line's end
        raise ValueError(f"it declares {vertices:,} vertices and {triangles:,} faces, and has {size:,} bytes")
    counted(triangles, vertices)
    return Declared("off", vertices, triangles)


def _gltf(stream: BinaryIO, size: int) -> Declared:
    return Declared("gltf", *gltf(stream, size))


def _glb(stream: BinaryIO, size: int) -> Declared:
    return Declared("glb", *glb(stream, size))


READERS: dict[str, Callable[[BinaryIO, int], Declared]] = {
    "obj": _obj, "ply": _ply, "stl": _stl, "off": _off, "glb": _glb, "gltf": _gltf,
}  # fmt: skip
