"""What a grid of cells cannot tell of a solid: told, not dropped. Imports numpy and numba."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from sceneql.kernels import over_tiles
from sceneql.mesh.bounded import Corner, bounded
from sceneql.mesh.grid import grid_around
from sceneql.mesh.hidden_kernels import DEPTH, hidden
from sceneql.mesh.workshop import BATCH, Workshop

if TYPE_CHECKING:
    from sceneql.frame import Tape


class Unresolved(NamedTuple):
    """Cells whose corners have one sign, which f could not be proved to keep inside."""

    cells: int
    volume: float
    """[m^3] of the parts of them that no proof was found for."""


def unresolved(tape: Tape, low: Corner, high: Corner, cell: float) -> Unresolved:
    """What the cells of ``polygonise`` may hide: walls and drops that pass between their corners.

    A cell is halved up to DEPTH times, each part proved by the interval of f or by the mean value theorem (Moore 1966).
    Raises ValueError as ``grid_around``.
    """
    import numpy as np

    shop = Workshop(bounded(tape, low, high), grid_around(low, high, cell))
    blocks = shop.met()
    count = -(-len(blocks) // BATCH)
    found: list[tuple[int, float]] = [(0, 0.0)] * count
    stacks = np.empty((count, 8 * DEPTH + 8, 4))

    def work(batch: int) -> None:
        r, mine = shop.room(), blocks[batch * BATCH : (batch + 1) * BATCH]
        found[batch] = hidden(
            *shop.program, r.scratch, r.short, r.near, r.registers, r.points, r.values, stacks[batch],
            shop.grid.numbers, mine,
        )  # fmt: skip

    over_tiles(count, work)
    return Unresolved(sum(cells for cells, _ in found), float(sum(volume for _, volume in found)))
