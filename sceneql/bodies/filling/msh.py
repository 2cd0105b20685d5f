"""Reader of tetrahedra in Gmsh's text files, .msh of version 2 or 4 (Geuzaine & Remacle 2009). Imports numpy."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

MOST = 2**28
"""Largest file [bytes]."""
TETRAHEDRON, QUADRATIC = 4, 11
"""Gmsh's element types of tetrahedra with 4 and with 10 nodes."""
CORNERS = {TETRAHEDRON: 4, QUADRATIC: 10}
ORDER = (0, 1, 2, 3, 4, 6, 7, 5, 9, 8)
"""For each of our ten nodes, with edges in the order of tetrahedra.ENDS, its place among Gmsh's ten."""
MOST_NUMBER = 2.0**53
"""Largest integer that is read: float64 represents it exactly."""
TAGS_FIRST = 4.05
"""Version 4.1, above this, lists the numbers of a block's nodes before their positions; 4.0 on the same lines."""
OTHERS = (5, 6, 7, 12, 13, 14, 17, 18, 19, 29, 30, 31)
"""Gmsh's element types of other solids, which are refused."""


@dataclass(frozen=True, slots=True, eq=False)
class Read:
    """The mesh of a file."""

    points: Floats
    """(n, 3) positions of the nodes that elements use."""
    cells: NDArray[int64]
    """(e, 4 or 10) nodes of the elements, corners before nodes on edges."""
    numbers: NDArray[int64]
    """(e,) the elements' numbers in the file."""


def read_msh(path: Path) -> Read:
    """The nodes and tetrahedra of a file. Raises ValueError with the fault and its line, and OSError."""
    if path.stat().st_size > MOST:
        raise ValueError(f"{path.name} has more than {MOST // 2**20} MiB")
    lines = _Lines(path.name, path.read_bytes())
    version = 0.0
    points: dict[str, Any] = {}
    cells: list[tuple[int, Any, Any]] = []
    for name in lines.sections():
        if name == "$MeshFormat":
            version, kind, *_ = lines.row(3)
            if kind != 0:
                raise ValueError(f"{path.name} is a binary .msh: save it as text (ASCII)")
            if int(version) not in (2, 4):
                raise ValueError(f"{path.name} is a .msh of version {version:g}: versions 2 and 4 are read")
        elif name == "$Nodes":
            points = dict(zip(("numbers", "places"), _nodes(lines, version), strict=True))
        elif name == "$Elements":
            cells += _elements(lines, version)
    if version == 0.0:
        raise ValueError(f"{path.name} is no .msh: it does not begin with $MeshFormat")
    if not points or not cells:
        raise ValueError(f"{path.name} has no {'tetrahedra' if points else '$Nodes'}")
    kinds = {kind for kind, _, _ in cells}
    if kinds - CORNERS.keys():
        raise ValueError(f"{path.name} has solids that are no tetrahedra of 4 or 10 nodes")
    if len(kinds) > 1:
        raise ValueError(f"{path.name} has tetrahedra of 4 and of 10 nodes: save it in one order")
    numbers, named = (np.concatenate([one[k] for one in cells]) for k in (1, 2))
    order = np.argsort(points["numbers"], kind="stable")
    known = points["numbers"][order]
    at = np.minimum(np.searchsorted(known, named), len(known) - 1)
    if (known[at] != named).any():
        missing = int(named[known[at] != named][0])
        raise ValueError(f"{path.name}: an element names node {missing}, which is not there")
    used, which = np.unique(order[at], return_inverse=True)
    which = which.reshape(named.shape)
    return Read(points["places"][used], which[:, ORDER] if named.shape[1] == 10 else which, numbers)


class _Lines:
    """The lines of a file, read one after another, with line numbers for messages."""

    def __init__(self, name: str, text: bytes) -> None:
        self.name = name
        self._lines = text.decode("utf-8", errors="replace").splitlines()
        self._at = 0

    def sections(self) -> Iterator[str]:
        """Yields the name of each section, with the first line of its content as the next line."""
        while self._at < len(self._lines):
            name = self._lines[self._at].strip()
            self._at += 1
            if name.startswith("$") and not name.startswith("$End"):
                yield name

    def row(self, least: int = 1) -> list[float]:
        """The numbers of the next line. Raises ValueError for fewer than ``least`` numbers."""
        return [float(one) for one in self.rows(1, least)[0]]

    def counts(self, least: int = 1) -> list[int]:
        """The integers of the next line. Raises ValueError for fewer than ``least``, or for other numbers."""
        return [int(one) for one in self.whole(1, least)[0]]

    def whole(self, count: int, least: int) -> NDArray[int64]:
        """The integers (count, k) of the next lines. Raises ValueError as `rows`, and for other numbers."""
        first = self._at
        found = self.rows(count, least)
        other = np.flatnonzero(((np.abs(found) > MOST_NUMBER) | (found != np.floor(found))).any(axis=1))
        if len(other):
            raise ValueError(f"line {first + other[0] + 1} of {self.name} should have whole numbers below 2^53")
        return np.asarray(found, dtype=np.int64)

    def rows(self, count: int, least: int) -> Any:
        """The numbers (count, k) of the next ``count`` lines, k >= ``least``. Raises ValueError for unequal lengths."""
        some = self._lines[self._at : self._at + count]
        if count < 0 or len(some) < count or not count:
            raise ValueError(f"{self.name} ends too soon, in line {len(self._lines)}")
        try:
            found = np.array([line.split() for line in some], dtype=float)
        except ValueError:
            found = np.empty((0, 0))
        if found.ndim != 2 or found.shape[1] < least or not np.isfinite(found).all():
            line, wide = self._wrong(some, least)
            raise ValueError(f"line {self._at + line} of {self.name} should have {wide} number{'s' * (wide > 1)}")
        self._at += count
        return found

    def ragged(self, count: int) -> Iterator[list[int]]:
        """Yields the integers of each of the next ``count`` lines, of any lengths from 3 on."""
        for _ in range(count):
            yield self.counts(3)

    def _wrong(self, some: list[str], least: int) -> tuple[int, int]:
        """(number from 1 of the first line of ``some`` with another length, the expected length)."""
        wide = max(least, len(some[0].split()))
        for k, line in enumerate(some):
            try:
                if len([one for one in map(float, line.split()) if np.isfinite(one)]) != wide:
                    return k + 1, wide
            except ValueError:
                return k + 1, wide
        return 1, wide


def _nodes(lines: _Lines, version: float) -> tuple[Any, Floats]:
    """Numbers (n,) and positions (n, 3) of the section of nodes."""
    if version < 4:
        rows = lines.rows(lines.counts()[0], 4)
        return rows[:, 0].astype(np.int64), rows[:, 1:4]
    numbers, places = [], []
    for _ in range(lines.counts(2)[0]):
        count = lines.counts(4)[3]
        if count and version < TAGS_FIRST:
            rows = lines.rows(count, 4)
            numbers.append(rows[:, 0].astype(np.int64))
            places.append(rows[:, 1:4])
        elif count:
            numbers.append(lines.whole(count, 1)[:, 0])
            places.append(lines.rows(count, 3)[:, :3])
    if not numbers:
        raise ValueError(f"{lines.name} has no nodes")
    return np.concatenate(numbers), np.concatenate(places)


def _elements(lines: _Lines, version: float) -> Iterator[tuple[int, Any, Any]]:
    """Yields (element type, numbers (e,), nodes (e, k)) of the blocks of solids in the section of elements."""
    if version >= 4:
        for _ in range(lines.counts(2)[0]):
            _, _, kind, count = lines.counts(4)[:4]
            if count and (kind in CORNERS or kind in OTHERS):
                rows = lines.whole(count, 1)
                _have_nodes(lines, kind, int(rows[0, 0]), {rows.shape[1]})
                yield kind, rows[:, 0], rows[:, 1:]
            elif count:
                lines.rows(count, 2)
        return
    found: dict[int, list[list[int]]] = {}
    for row in lines.ragged(lines.counts()[0]):
        kind, tags = row[1], row[2]
        if kind in CORNERS or kind in OTHERS:
            found.setdefault(kind, []).append([row[0], *row[3 + max(tags, 0) :]])
    for kind, some in found.items():
        _have_nodes(lines, kind, some[0][0], {len(one) for one in some})
        rows = np.array(some if kind in CORNERS else [one[:1] for one in some], dtype=np.int64)
        yield kind, rows[:, 0], rows[:, 1:]


def _have_nodes(lines: _Lines, kind: int, number: int, lengths: set[int]) -> None:
    """Raise ValueError for tetrahedra with a wrong number of nodes.

    ``number``: of the first one; ``lengths``: the lengths of their lines, element number and nodes.
    """
    if kind in CORNERS and lengths != {1 + CORNERS[kind]}:
        text = f"{lines.name}: element {number} and others of kind {kind} should have {CORNERS[kind]} nodes"
        raise ValueError(text)
