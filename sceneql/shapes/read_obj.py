"""OBJ files to arrays, a block of text at a time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from sceneql.failure import LimitRefused
from sceneql.shapes import obj_kernels as obj
from sceneql.shapes.mesh_limits import MOST_TRIANGLES, MOST_VERTICES
from sceneql.shapes.raw_mesh import RawMesh, linear

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

BLOCK = 2**22
"""Bytes of a block, and of the longest line."""
MOST_WORK = 10**8
"""Most tests of corners in the ear clipping of all polygons: they take seconds."""
CONTINUED = (b"\\\n", b"\\\r\n")
ERRORS = {
    obj.NOT_A_NUMBER: "'{}' is no number, or not finite",
    obj.FEW_NUMBERS: "a vertex has three numbers",
    obj.NOT_AN_INDEX: "'{}' is no corner of a face: it is written 1, 1/2, 1//3 or 1/2/3",
    obj.NO_ZERO: "vertices are counted from 1, or back from -1, and none is 0",
    obj.TOO_FAR_BACK: "'{}' counts back beyond the first vertex",
    obj.FEW_CORNERS: "a face has three corners or more",
}


def read_obj(path: Path) -> RawMesh:
    """The polygons of an OBJ file as triangles, with vertex colors where all vertices have one.

    Raises ValueError for text that is no OBJ file, LimitRefused where it holds too much.
    """
    state = np.zeros(12, dtype=np.int64)
    state[obj.HIGHEST] = -1
    rows, given = _Rows(), 0
    with path.open("rb") as stream:
        for text in _blocks(stream):
            rows.add(text, state)
            given = int(state[obj.VERTICES])
            if given > MOST_VERTICES or rows.triangles > MOST_TRIANGLES:
                raise LimitRefused(
                    f"{path.name} has more than {MOST_TRIANGLES:,} triangles or {MOST_VERTICES:,} vertices"
                )
    if state[obj.HIGHEST] >= given:
        face = f"line {state[obj.HIGHEST_LINE] + 1}: a face names vertex {state[obj.HIGHEST] + 1}, of {given}"
        raise ValueError(f"{face}: it is not there")
    return rows.mesh(path.name)


def _blocks(stream: BinaryIO) -> Iterator[bytes]:
    """Blocks of whole lines, not cut where a backslash continues a line. Raises ValueError for a line above BLOCK."""
    rest = b""
    if (start := stream.read(3)) != b"\xef\xbb\xbf":  # the byte order mark of UTF-8
        rest = start
    while block := stream.read(BLOCK):
        text = rest + block
        cut = text.rfind(b"\n") + 1
        while cut and text.endswith(CONTINUED, 0, cut):
            cut = text.rfind(b"\n", 0, cut - 1) + 1
        if not cut and len(text) > BLOCK:
            raise ValueError(f"it has a line of more than {BLOCK:,} bytes")
        if cut:
            yield text[:cut]
        rest = text[cut:]
    if rest:
        yield rest


class _Rows:
    """Vertices, colors and faces of the blocks read so far."""

    def __init__(self) -> None:
        self.triangles = 0
        self._places: list[Floats] = []
        self._colors: list[NDArray[Any]] | None = []
        self._corners: list[Ints] = []
        self._sizes: list[Ints] = []

    def add(self, data: bytes, state: NDArray[int64]) -> None:
        """Read a block of whole lines. Raises ValueError."""
        text = np.frombuffer(data, dtype=np.uint8)
        # Bytes at least: eight of a vertex, "v 0 0 0" and a line's end, eight of a face, two of an index.
        most = len(text) // 8 + 1
        places = np.empty((most, obj.WIDTH))
        sizes = np.empty(most, dtype=np.int32)
        corners = np.empty(len(text) // 2 + 1, dtype=np.int32)
        hard = np.empty(len(text) + 2, dtype=np.uint8)
        hard_at = np.empty(len(text) // 2 + 1, dtype=np.int32)
        state[[obj.PLACES, obj.CORNERS, obj.FACES, obj.HARD, obj.HARD_LENGTH]] = 0
        obj.parse(text, state, places, corners, sizes, hard, hard_at)
        if state[obj.WRONG]:
            word = data[state[obj.FROM] : state[obj.UNTIL]].decode(errors="replace")
            shown = word if len(word) <= 40 else f"{word[:40]}..."
            if not shown.isprintable():
                raise ValueError("it is not text")
            raise ValueError(f"line {state[obj.LINE] + 1}: {ERRORS[int(state[obj.WRONG])].format(shown)}")
        places = places[: state[obj.PLACES]]
        if state[obj.HARD]:
            numbers = np.fromstring(hard[: state[obj.HARD_LENGTH]].tobytes(), sep=" ")
            places.reshape(-1)[hard_at[: state[obj.HARD]]] = numbers
        self._places.append(places[:, :3].copy())
        colored = len(places) == 0 or places[:, obj.GIVEN].min() >= obj.NUMBERS
        if self._colors is not None and colored:
            self._colors.append(np.clip(places[:, 3 : obj.NUMBERS], -1.0, 2.0).astype(np.float32))
        else:
            self._colors = None
        self._corners.append(corners[: state[obj.CORNERS]].copy())
        self._sizes.append(sizes[: state[obj.FACES]].copy())
        state[obj.VERTICES] += len(places)
        self.triangles += int(state[obj.CORNERS] - 2 * state[obj.FACES])

    def mesh(self, name: str) -> RawMesh:
        """The triangles of all blocks, polygons triangulated; frees the blocks' arrays. Raises LimitRefused."""
        places = _joined(self._places, np.zeros((0, 3)))
        corners = _joined(self._corners, np.zeros(0, dtype=np.int32))
        sizes = _joined(self._sizes, np.zeros(0, dtype=np.int32))
        colors = _joined(self._colors, np.zeros((0, 3), dtype=np.float32)) if self._colors else None
        if (sizes != 3).any():
            triangles = np.empty(3 * self.triangles, dtype=np.int32)
            largest = int(sizes.max())
            room = np.empty((largest, 2)), np.empty(largest, dtype=np.int64), np.empty((largest, 3), dtype=np.int64)
            if obj.triangulate(places, corners, sizes, triangles, *room, MOST_WORK) < 0:
                raise LimitRefused(f"{name} has polygons of too many corners that no fan of triangles fills")
            corners = triangles
        if colors is not None:  # numbers outside 0 to 1 are no colors
            colors = linear(colors) if len(colors) and colors.min() >= 0.0 and colors.max() <= 1.0 else None
        return RawMesh(places, corners.reshape(-1, 3), colors)


def _joined(parts: list[NDArray[Any]], none: NDArray[Any]) -> NDArray[Any]:
    """The parts concatenated, or ``none`` where there is no part; empties the list."""
    whole = np.concatenate(parts) if parts else none
    parts.clear()
    return whole
