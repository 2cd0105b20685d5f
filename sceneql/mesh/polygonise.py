"""A tape's solid to triangles: marching cubes on the blocks of a grid that the surface may meet.

Lorensen & Cline (1987), with the topology of the trilinear interpolant (Nielson & Hamann 1991; Chernyaev 1995). Only
f < 0 is inside: a sample that is zero or undefined is outside, so there are no holes. A vertex is found once, by the
block that owns its edge, and brought onto the surface; hence the mesh is closed and 2-manifold. Imports numpy and
numba.
"""

from __future__ import annotations

import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.field.batch_kernels import LANES
from sceneql.field.solid import scratch
from sceneql.kernels import over_tiles
from sceneql.mesh.bounded import Corner, bounded
from sceneql.mesh.cases import Cases, cases
from sceneql.mesh.connect_kernels import connect
from sceneql.mesh.cull_kernels import BLOCK, REACH, cull
from sceneql.mesh.extract_kernels import CUBES, EDGES, NODES, OWN, TRIANGLES, VERTICES, extract

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints, Tape

MOST_BLOCKS = 2**28
"""Blocks of a grid, the empty ones included."""
BATCH = 32
"""Blocks that a thread takes at a time."""


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """Cells of one size around a box, in blocks of BLOCK cells; at least half a cell of it lies outside the box."""

    low: Floats
    """(3,) [m]."""
    cell: float
    """[m]"""
    blocks: Ints
    """(3,) along each axis."""

    @property
    def numbers(self) -> Floats:
        """First node and cell, as kernels take them."""
        return np.array([*self.low, self.cell])


@dataclass(frozen=True, slots=True, eq=False)
class Polygons:
    """Triangles of a solid's surface, seen from outside counterclockwise."""

    vertices: Floats
    """(n, 3) [m]."""
    triangles: Ints
    """(m, 3)."""
    normals: Floats
    """(n, 3) unit gradients, pointing outward; zero where the field has none."""


def grid_around(low: Corner, high: Corner, cell: float) -> Grid:
    """The grid of cells of a size [m] around a box. Raises ValueError for one too fine, or a box that is not finite."""
    corners = np.array([low, high], dtype=np.float64)
    if not (np.isfinite(corners).all() and (corners[1] > corners[0]).all() and 0.0 < cell < np.inf):
        raise ValueError("a grid needs a finite box and a cell above 0")
    cells = np.ceil((corners[1] - corners[0]) / cell * (1.0 - 1e-12)) + 1.0
    blocks = np.ceil(cells / BLOCK)
    if not np.prod(blocks) <= MOST_BLOCKS:
        raise ValueError(f"cells of {cell:g} m are too many for a box of {np.ptp(corners, axis=0).max():g} m")
    first = corners[0] - 0.5 * (cells * cell - (corners[1] - corners[0]))
    return Grid(first, float(cell), blocks.astype(np.int32))


class Room:
    """What one thread works in."""

    def __init__(self, tape: Tape) -> None:
        rows = len(tape.code)
        self.scratch = scratch(tape)
        self.short = np.empty((rows, 4), dtype=np.int32)
        self.near = np.empty((len(tape.parts), 8))
        self.registers = np.empty((rows, LANES))
        self.slope = np.empty((rows, 3, LANES))
        self.points, self.starts, self.search = np.empty((3, LANES)), np.empty((3, LANES)), np.empty((7, LANES))
        self.values, self.signs = np.empty(NODES**3), np.empty(NODES**3, dtype=np.int8)
        self.corners = np.empty(8)
        self.keys = np.empty(BATCH * EDGES, dtype=np.int16)
        self.place, self.normal = np.empty((BATCH * EDGES, 3)), np.empty((BATCH * EDGES, 3))
        self.cubes = np.empty((BATCH * BLOCK**3, 2), dtype=np.int32)
        self.local = np.empty(EDGES, dtype=np.int32)
        self.low = np.empty(3)


def polygonise(tape: Tape, low: Corner, high: Corner, cell: float) -> Polygons:
    """Triangles of the solid {tape < 0} cut at the box low..high, by cells of a size [m].

    The bytes do not depend on the number of threads. Raises ValueError as ``grid_around``.
    """
    grid = grid_around(low, high, cell)
    whole = bounded(tape, low, high)
    own = threading.local()

    def room() -> Room:
        if not hasattr(own, "room"):
            own.room = Room(whole)
        found: Room = own.room
        return found

    program = (whole.code, whole.constants, whole.parts)
    blocks = _met(program, grid, room)
    return _joined(program, grid, blocks, _extracted(program, grid, blocks, room), room)


def _met(program: Any, grid: Grid, room: Any) -> Ints:
    """(b, 3) blocks that the surface may meet."""
    layers = -(-int(grid.blocks[2]) // REACH)
    most = REACH * int(grid.blocks[0] + REACH) * int(grid.blocks[1] + REACH)
    found: list[Any] = [None] * layers
    counts = grid.blocks.astype(np.int64)

    def work(layer: int) -> None:
        mine, blocks = room(), np.empty((most, 3), dtype=np.int32)
        n = cull(*program, mine.scratch, mine.short, mine.near, grid.numbers, counts, layer, blocks)
        found[layer] = blocks[:n]

    over_tiles(layers, work)
    return np.concatenate(found)


def _extracted(program: Any, grid: Grid, blocks: Ints, room: Any) -> list[Any]:
    """Per batch of blocks (tally, keys, places, normals, cubes)."""
    table = cases()
    count = -(-len(blocks) // BATCH)
    found: list[Any] = [None] * count

    def work(batch: int) -> None:
        r, mine = room(), blocks[batch * BATCH : (batch + 1) * BATCH]
        tally = np.empty((len(mine), 4), dtype=np.int64)
        vertices, cubes = extract(
            *program, r.scratch, r.short, r.near, r.registers, r.slope, r.points, r.starts, r.search, r.values, r.signs,
            r.corners, grid.numbers, mine, table.first, table.faces, table.tunnel, table.start, table.centers,
            r.keys, r.place, r.normal, r.cubes, tally,
        )  # fmt: skip
        copies = [r.keys[:vertices], r.place[:vertices], r.normal[:vertices], r.cubes[:cubes]]
        found[batch] = (tally, *(copy.copy() for copy in copies))

    over_tiles(count, work)
    return found


def _joined(program: Any, grid: Grid, blocks: Ints, batches: list[Any], room: Any) -> Polygons:
    """One mesh of what was found in the blocks."""
    table = cases()
    empty = np.zeros((0, 4), np.int64), np.zeros(0, np.int16), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 2), np.int32)
    tally, keys, place, normal, cubes = (np.concatenate(arrays) for arrays in zip(empty, *batches, strict=True))
    begin, cube_at, triangle_at, own_at = (
        np.concatenate([[0], np.cumsum(tally[:, column])]) for column in (VERTICES, CUBES, TRIANGLES, OWN)
    )
    fresh = np.zeros((int(own_at[-1]), 3))
    own_at += len(place)
    place, normal = np.concatenate([place, fresh]), np.concatenate([normal, fresh])
    where = np.full(grid.blocks[::-1] + 1, -1, dtype=np.int32)
    where[blocks[:, 2], blocks[:, 1], blocks[:, 0]] = np.arange(len(blocks))
    triangles = np.empty((int(triangle_at[-1]), 3), dtype=np.int32)

    def work(batch: int) -> None:
        r, first = room(), batch * BATCH
        connect(
            *program, r.scratch, grid.numbers, blocks, first, min(first + BATCH, len(blocks)), where, begin, cube_at,
            triangle_at, own_at, keys, cubes, table.start, table.triangles, table.around, r.local, r.low,
            place, normal, triangles,
        )  # fmt: skip

    over_tiles(-(-len(blocks) // BATCH), work)
    return Polygons(place, triangles, normal)
