"""Extraction of a tape's surface on a grid, block by block on all threads. Imports numpy and numba."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sceneql.compiled.kernels import over_tiles
from sceneql.field.tape.batch_kernels import LANES
from sceneql.field.tape.tape_solid import scratch
from sceneql.mesh.cubes.cases import cases
from sceneql.mesh.cubes.cull_kernels import REACH, cull
from sceneql.mesh.cubes.extract_kernels import CUBES, EDGES, OWN, TRIANGLES, VERTICES, extract
from sceneql.mesh.cubes.grid import BLOCK
from sceneql.mesh.cubes.hidden_kernels import DEEPEST
from sceneql.mesh.cubes.polish_kernels import ROWS
from sceneql.mesh.cubes.sample_kernels import NODES

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape
    from sceneql.mesh.cubes.grid import Grid

    Hidden = tuple[Ints, Floats, NDArray[np.bool_]]

BATCH = 32
"""Blocks of one task of a thread."""
UNLOOKED = -1
"""In place of a number of halvings: cells are not looked into."""


class Room:
    """Working memory of one thread."""

    def __init__(self, tape: Tape) -> None:
        import numpy as np

        rows = len(tape.code)
        self.scratch = scratch(tape)
        self.short = np.empty((3, rows, 4), dtype=np.int32)
        self.near = np.empty((2, len(tape.parts), 8))
        self.registers = np.empty((rows, LANES))
        self.slope = np.empty((rows, 3, LANES))
        self.points, self.starts, self.search = np.empty((3, LANES)), np.empty((3, LANES)), np.empty((ROWS, LANES))
        self.values, self.nearest = np.empty(2 * NODES**3), np.empty(NODES**3)
        self.masks = np.empty(NODES**2, dtype=np.int64)
        self.corners = np.empty(8)
        self.keys = np.empty(BATCH * EDGES, dtype=np.int16)
        self.place, self.normal = np.empty((BATCH * EDGES, 3)), np.empty((BATCH * EDGES, 3))
        self.cubes = np.empty((BATCH * BLOCK**3, 2), dtype=np.int32)
        self.local = np.empty(EDGES, dtype=np.int32)
        self.cells = np.empty((BATCH * BLOCK**3, 3), dtype=np.int32)
        self.rest, self.seen = np.empty(BATCH * BLOCK**3), np.empty(BATCH * BLOCK**3, dtype=bool)
        self.stack = np.empty((8 * DEEPEST + 8, 4), dtype=np.int64)
        self.second = np.empty((rows, 6))
        self.low, self.fit = np.empty(3), np.empty((15, 3))


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """The surface in b blocks; a block's vertices on edges begin at ``begin``, its cubes at ``cube_at``."""

    blocks: Ints
    """(b, 3) places of the blocks."""
    beyond: Ints
    """(b, 8) row of the block one step up along the axes whose bits are set; -1 where it was not extracted."""
    begin: Ints
    cube_at: Ints
    triangle_at: Ints
    own_at: Ints
    """(b + 1,) first inner vertex of each block, counted after the vertices on edges."""
    keys: Ints
    """(v,) number of each vertex's edge in its block, ascending within a block."""
    cubes: Ints
    """(c, 2) of each cube that the surface meets: number in its block, and variant (cases.py)."""
    place: Floats
    """(v + own, 3) [m] positions of the vertices; of inner vertices zero until ``connected`` places them."""
    normal: Floats
    """(v + own, 3) unit gradients, or zero."""


class GridExtraction:
    """A tape on a grid, with working memory for each thread."""

    def __init__(self, whole: Tape, grid: Grid) -> None:
        self.whole, self.grid = whole, grid
        self.program = (whole.code, whole.constants, whole.parts)
        self._own = threading.local()

    def room(self) -> Room:
        """This thread's working memory."""
        if not hasattr(self._own, "room"):
            self._own.room = Room(self.whole)
        found: Room = self._own.room
        return found

    def met(self) -> Ints:
        """(b, 3) places of the blocks that the surface may meet, the others proved empty or full."""
        import numpy as np

        grid = self.grid
        layers = -(-int(grid.blocks[2]) // REACH)
        most = REACH * int(grid.blocks[0] + REACH) * int(grid.blocks[1] + REACH)
        found: list[Any] = [None] * layers
        counts = grid.blocks.astype(np.int64)

        def work(layer: int) -> None:
            r, blocks = self.room(), np.empty((most, 3), dtype=np.int32)
            n = cull(
                *self.program, r.scratch, r.short[0], r.near[0], r.second, r.registers, r.points, grid.numbers, counts,
                layer, blocks,
            )  # fmt: skip
            found[layer] = blocks[:n].copy()

        over_tiles(layers, work)
        return np.concatenate(found)

    def extracted(self, blocks: Ints) -> Found:
        """The surface in some blocks; an edge on the high side of a block belongs to its neighbor there."""
        return self.looked_into(blocks, UNLOOKED, 0)[0]

    def looked_into(self, blocks: Ints, deepest: int, finer: int) -> tuple[Found, Hidden]:
        """The surface in some blocks, and their cells that may hide more (kernel ``hidden``)."""
        import numpy as np

        table = cases()
        count = -(-len(blocks) // BATCH)
        batches: list[Any] = [None] * count

        def work(batch: int) -> None:
            r, mine = self.room(), blocks[batch * BATCH : (batch + 1) * BATCH]
            tally = np.empty((len(mine), 4), dtype=np.int64)
            most = 0 if deepest == UNLOOKED else len(mine) * BLOCK**3
            cells, rest, seen = r.cells[:most], r.rest[:most], r.seen[:most]
            vertices, cubes, doubts = extract(
                *self.program, r.scratch, r.short, r.near, r.registers, r.slope, r.points, r.starts, r.search,
                r.values, r.nearest, r.masks, r.corners, r.stack, r.second, self.grid.numbers, mine, table.first,
                table.faces, table.tunnel, table.start, table.centers, r.keys, r.place, r.normal, r.cubes, tally,
                deepest, finer, cells, rest, seen,
            )  # fmt: skip
            copies: list[Any] = [r.keys[:vertices], r.cubes[:cubes], r.place[:vertices], r.normal[:vertices]]
            copies += [cells[:doubts], rest[:doubts], seen[:doubts]]
            batches[batch] = (tally, *(copy.copy() for copy in copies))

        over_tiles(count, work)
        return gathered(blocks, batches), joined([batch[-3:] for batch in batches])

    def over_blocks(self, count: int, work: Callable[[Room, int, int], None]) -> None:
        """Call ``work(room, first, last)`` for batches of ``count`` blocks, on all threads."""
        over_tiles(-(-count // BATCH), lambda b: work(self.room(), b * BATCH, min((b + 1) * BATCH, count)))


def joined(batches: list[Hidden]) -> Hidden:
    """What may be hidden in batches of blocks as one."""
    import numpy as np

    none = np.zeros((0, 3), np.int32), np.zeros(0), np.zeros(0, bool)
    where, volumes, seen = (np.concatenate(column) for column in zip(none, *batches, strict=True))
    return where, volumes, seen


def gathered(blocks: Ints, batches: list[Any]) -> Found:
    """The results of batches of blocks as one."""
    import numpy as np

    empty = np.zeros((0, 4), np.int64), np.zeros(0, np.int16), np.zeros((0, 2), np.int32)
    tally, keys, cubes = (np.concatenate([none, *(batch[k] for batch in batches)]) for k, none in enumerate(empty))
    at = np.zeros((4, len(blocks) + 1), dtype=np.int64)
    np.cumsum(tally.T, axis=1, out=at[:, 1:])
    begin, own_at = at[VERTICES], at[OWN]
    own_at += begin[-1]
    place, normal = np.empty((2, int(own_at[-1]), 3))
    for array, k in ((place, 3), (normal, 4)):
        array[begin[-1] :] = 0.0
        for b, batch in enumerate(batches):
            array[begin[b * BATCH] :][: len(batch[k])] = batch[k]
    return Found(blocks, beyond(blocks), begin, at[CUBES], at[TRIANGLES], own_at, keys, cubes, place, normal)


def beyond(blocks: Ints) -> Ints:
    """(b, 8) as in Found, for distinct blocks (b, 3)."""
    import numpy as np

    if not len(blocks):
        return np.empty((0, 8), dtype=np.int32)
    size = blocks.max(axis=0).astype(np.int64) + 2
    strides = np.array([1, size[0], size[0] * size[1]])
    numbers = blocks @ strides
    order = np.argsort(numbers)
    ascending = numbers[order]
    wanted = numbers[:, None] + np.array([[bits & 1, bits >> 1 & 1, bits >> 2] for bits in range(8)]) @ strides
    at = np.minimum(np.searchsorted(ascending, wanted), len(blocks) - 1)
    found: Ints = np.where(ascending[at] == wanted, order[at], -1).astype(np.int32)
    return found
