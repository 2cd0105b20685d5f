"""Cells that interval bounds could not prove empty or full: they are reported. Imports numpy and numba."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sceneql.compiled.kernels import over_tiles
from sceneql.mesh.bounded import Corner, bounded
from sceneql.mesh.cubes.grid import grid_around
from sceneql.mesh.cubes.grid_extraction import BATCH, GridExtraction, joined
from sceneql.mesh.cubes.hidden_kernels import DEEPEST, hidden

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape
    from sceneql.mesh.cubes.grid import Grid

    Bytes = NDArray[np.uint8]


@dataclass(frozen=True, slots=True, eq=False)
class Unresolved:
    """Cells whose corners have one sign, without a proof that f has this sign throughout, and cells with an edge, or
    more, that the surface passes twice.
    """

    where: Ints
    """(n, 3) places of the cells, counted from the grid's first node."""
    volumes: Floats
    """(n,) [m^3] volume of the parts of each cell that have no proof."""
    grid: Grid
    """The grid of these cells."""
    seen: NDArray[np.bool_]
    """(n,) whether f was found to have the other sign in a cell."""
    cell: float | None = None
    """Side of the cells that are not cut [m], where it may be another than was asked for."""

    @property
    def cells(self) -> int:
        """Number of cells."""
        return len(self.where)

    @property
    def volume(self) -> float:
        """Total volume [m^3] without a proof."""
        return float(self.volumes.sum())

    @property
    def middles(self) -> Floats:
        """(n, 3) [m] centers of the cells."""
        found: Floats = self.grid.low + (self.where + 0.5) * self.grid.cell
        return found


def unresolved(tape: Tape, low: Corner, high: Corner, cell: float) -> Unresolved:
    """Cells of ``polygonise`` that may hide surface: thin walls and drops between their corners.

    Raises ValueError as ``grid_around``.
    """
    shop = GridExtraction(bounded(tape, low, high), grid_around(low, high, cell))
    return hidden_in(shop, shop.met())


def hidden_in(
    shop: GridExtraction, blocks: Ints, deepest: int = DEEPEST, finer: int = 0, eighths: Bytes | None = None
) -> Unresolved:
    """Cells of some blocks that may hide surface.

    A cell is bisected up to ``deepest`` times. Each part is proved empty or full by an interval enclosure of f or by
    the mean value form (Moore 1966). Cells without a proof are looked into at the nodes of cells ``finer`` times finer.
    ``eighths`` (b,) has a bit for each eighth of a block in which cells are looked at; by default in all.
    """
    import numpy as np

    count = -(-len(blocks) // BATCH)
    bits = np.full(len(blocks), 255, dtype=np.uint8) if eighths is None else eighths
    found: list[Any] = [None] * count

    def work(batch: int) -> None:
        r, mine = shop.room(), blocks[batch * BATCH : (batch + 1) * BATCH]
        cells, rest, seen = r.cells, r.rest, r.seen
        n = hidden(
            *shop.program, r.scratch, r.short, r.near, r.registers, r.points, r.values, r.nearest, r.stack,
            r.second, shop.grid.numbers, mine,
            bits[batch * BATCH : (batch + 1) * BATCH], deepest, finer, cells, rest, seen,
        )  # fmt: skip
        found[batch] = cells[:n].copy(), rest[:n].copy(), seen[:n].copy()

    over_tiles(count, work)
    where, volumes, seen = joined(found)
    return Unresolved(where, volumes, shop.grid, seen)
