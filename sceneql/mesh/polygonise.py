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

from sceneql.field.batch_kernels import LANES
from sceneql.field.solid import scratch
from sceneql.kernels import over_tiles
from sceneql.mesh.bounded import Corner, bounded
from sceneql.mesh.cases import cases
from sceneql.mesh.connect_kernels import connect
from sceneql.mesh.cull_kernels import BLOCK, REACH, cull
from sceneql.mesh.extract_kernels import CUBES, EDGES, NODES, OWN, TRIANGLES, VERTICES, extract
from sceneql.mesh.grid import Grid, grid_around

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints, Tape

BATCH = 32
"""Blocks that a thread takes at a time."""


@dataclass(frozen=True, slots=True, eq=False)
class Polygons:
    """Triangles of a solid's surface, seen from outside counterclockwise."""

    vertices: Floats
    """(n, 3) [m]."""
    triangles: Ints
    """(m, 3)."""
    normals: Floats
    """(n, 3) unit gradients, pointing outward; zero where the field has none."""


class Room:
    """What one thread works in."""

    def __init__(self, tape: Tape) -> None:
        import numpy as np

        rows = len(tape.code)
        self.scratch = scratch(tape)
        self.short = np.empty((rows, 4), dtype=np.int32)
        self.near = np.empty((len(tape.parts), 8))
        self.registers = np.empty((rows, LANES))
        self.slope = np.empty((rows, 3, LANES))
        self.points, self.starts, self.search = np.empty((3, LANES)), np.empty((3, LANES)), np.empty((9, LANES))
        self.values, self.signs = np.empty(NODES**3), np.empty(NODES**3, dtype=np.int8)
        self.corners = np.empty(8)
        self.keys = np.empty(BATCH * EDGES, dtype=np.int16)
        self.place, self.normal = np.empty((BATCH * EDGES, 3)), np.empty((BATCH * EDGES, 3))
        self.cubes = np.empty((BATCH * BLOCK**3, 2), dtype=np.int32)
        self.local = np.empty(EDGES, dtype=np.int32)
        self.low = np.empty(3)


class Workshop:
    """A tape on a grid, and room for each thread."""

    def __init__(self, whole: Tape, grid: Grid) -> None:
        self.whole, self.grid = whole, grid
        self.program = (whole.code, whole.constants, whole.parts)
        self._own = threading.local()

    def room(self) -> Room:
        """This thread's room."""
        if not hasattr(self._own, "room"):
            self._own.room = Room(self.whole)
        found: Room = self._own.room
        return found

    def met(self) -> Ints:
        """(b, 3) blocks that the surface may meet."""
        import numpy as np

        grid = self.grid
        layers = -(-int(grid.blocks[2]) // REACH)
        most = REACH * int(grid.blocks[0] + REACH) * int(grid.blocks[1] + REACH)
        found: list[Any] = [None] * layers
        counts = grid.blocks.astype(np.int64)

        def work(layer: int) -> None:
            r, blocks = self.room(), np.empty((most, 3), dtype=np.int32)
            n = cull(*self.program, r.scratch, r.short, r.near, grid.numbers, counts, layer, blocks)
            found[layer] = blocks[:n]

        over_tiles(layers, work)
        return np.concatenate(found)

    def extracted(self, blocks: Ints) -> list[Any]:
        """Per batch of blocks (tally, keys, cubes, places, normals)."""
        import numpy as np

        table = cases()
        count = -(-len(blocks) // BATCH)
        found: list[Any] = [None] * count

        def work(batch: int) -> None:
            r, mine = self.room(), blocks[batch * BATCH : (batch + 1) * BATCH]
            tally = np.empty((len(mine), 4), dtype=np.int64)
            vertices, cubes = extract(
                *self.program, r.scratch, r.short, r.near, r.registers, r.slope, r.points, r.starts, r.search,
                r.values, r.signs, r.corners, self.grid.numbers, mine, table.first, table.faces, table.tunnel,
                table.start, table.centers, r.keys, r.place, r.normal, r.cubes, tally,
            )  # fmt: skip
            copies: list[Any] = [r.keys[:vertices], r.cubes[:cubes], r.place[:vertices], r.normal[:vertices]]
            found[batch] = (tally, *(copy.copy() for copy in copies))

        over_tiles(count, work)
        return found

    def joined(self, blocks: Ints, batches: list[Any]) -> Polygons:
        """One mesh of what was found in the blocks."""
        import numpy as np

        table = cases()
        empty = np.zeros((0, 4), np.int64), np.zeros(0, np.int16), np.zeros((0, 2), np.int32)
        tally, keys, cubes = (np.concatenate([none, *(batch[k] for batch in batches)]) for k, none in enumerate(empty))
        begin, cube_at, triangle_at, own_at = (
            np.concatenate([[0], np.cumsum(tally[:, column])]) for column in (VERTICES, CUBES, TRIANGLES, OWN)
        )
        own_at += begin[-1]
        place, normal = np.empty((int(own_at[-1]), 3)), np.empty((int(own_at[-1]), 3))
        for array, k in ((place, 3), (normal, 4)):
            array[begin[-1] :] = 0.0
            for b, batch in enumerate(batches):
                array[begin[b * BATCH] :][: len(batch[k])] = batch[k]
        where = np.full(self.grid.blocks[::-1] + 1, -1, dtype=np.int32)
        where[blocks[:, 2], blocks[:, 1], blocks[:, 0]] = np.arange(len(blocks))
        triangles = np.empty((int(triangle_at[-1]), 3), dtype=np.int32)

        def work(batch: int) -> None:
            r, first = self.room(), batch * BATCH
            connect(
                *self.program, r.scratch, self.grid.numbers, blocks, first, min(first + BATCH, len(blocks)), where,
                begin, cube_at, triangle_at, own_at, keys, cubes, table.start, table.triangles, table.around,
                r.local, r.low, place, normal, triangles,
            )  # fmt: skip

        over_tiles(len(batches), work)
        return Polygons(place, triangles, normal)


def polygonise(tape: Tape, low: Corner, high: Corner, cell: float) -> Polygons:
    """Triangles of the solid {tape < 0} cut at the box low..high, by cells of a size [m].

    The bytes do not depend on the number of threads. Raises ValueError as ``grid_around``.
    """
    shop = Workshop(bounded(tape, low, high), grid_around(low, high, cell))
    blocks = shop.met()
    return shop.joined(blocks, shop.extracted(blocks))
