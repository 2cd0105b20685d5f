"""Plan of species_kernels: the systems that a multigrid over cells of several species solves, and their layout."""

from __future__ import annotations

from itertools import accumulate
from math import prod
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.island.system import System
    from sceneql.system import Grid

FEWEST = {2: 30_000, 3: 2_000}
"""Least number of cells, in 2 or 3 dimensions, for which multigrid cycles are faster than a factorization."""


def one_grid(system: System, core: NDArray[int64]) -> bool:
    """Whether the unknowns are species without drift on one grid of enough cells."""
    grids = system.grids
    if not grids or any(grid.carried or grid.cells.shape != grids[0].cells.shape for grid in grids):
        return False
    shape = grids[0].cells.shape
    return prod(shape) >= FEWEST[3 if shape[2] > 1 else 2] and bool((_places(grids, len(system.y))[core] >= 0).all())


def plan(system: System, core: NDArray[int64], pattern: Any) -> tuple[NDArray[int64], int, str]:
    """Integers after the preconditioner's number, number of floats of the levels, and text for users.

    ``core`` (unknowns,): entries of y; ``pattern``: scipy CSR (unknowns, unknowns).
    """
    import numpy as np

    grids = system.grids
    s, first = len(grids), grids[0]
    n, sides = prod(first.cells.shape), (3 if first.cells.shape[2] > 1 else 2)
    shapes = [first.cells.shape]
    while any(count > 1 for count in shapes[-1]):  # the last cell solves for the mean over the whole grid
        nx, ny, nz = ((count + 1) // 2 for count in shapes[-1])
        shapes.append((nx, ny, nz))
    sizes = [(2 * sides * s + s * s + 3 * s) * prod(shape) for shape in shapes]
    starts = list(accumulate(sizes, initial=0))
    table = [number for shape, start in zip(shapes, starts, strict=False) for number in (*shape, start)]
    places = _places(grids, len(system.y))[core]
    at = np.full(s * n, -1, dtype=np.int64)
    at[places] = np.arange(len(core))
    entry = _Entries(pattern, at.reshape(s, n))
    cells = np.arange(n).reshape(first.cells.shape[::-1])
    blocks = [entry.of(m, cells.ravel(), q, cells.ravel()) for m in range(s) for q in range(s)]
    ties = []
    for direction in range(2 * sides):
        axis, high = direction // 2, direction % 2
        beside = np.roll(cells, -1 if high else 1, axis=2 - axis).ravel()
        ties += [np.where(beside == cells.ravel(), -1, entry.of(m, cells.ravel(), m, beside)) for m in range(s)]
    volumes = system.floats[first.volumes_at : first.volumes_at + n] / system.floats[first.volumes_at :][:n].max()
    head = [len(shapes), s, 2 * sides, starts[-1], *table]
    numbers = np.concatenate([head, places, *blocks, *ties, volumes.view(np.int64)]).astype(np.int64)
    text = f"multigrid over {len(shapes)} grids, {s} species of a cell at once, for {len(core)} unknowns"
    return numbers, starts[-1] + s * first.cells.shape[0], text


def _places(grids: tuple[Grid, ...], size: int) -> NDArray[int64]:
    """(size,): index of each entry of y among the species' cells; -1 for entries that are no cells."""
    import numpy as np

    found = np.full(size, -1, dtype=np.int64)
    n = prod(grids[0].cells.shape)
    for number, grid in enumerate(grids):
        found[grid.at : grid.at + n] = number * n + np.arange(n)
    return found


class _Entries:
    """Lookup of entries' places among a pattern's values."""

    def __init__(self, pattern: Any, at: NDArray[int64]) -> None:
        """``at`` (s, n): unknown of each species in each cell, -1 for none."""
        import numpy as np

        self._at, self._count = at, pattern.shape[0]
        rows = np.repeat(np.arange(self._count, dtype=np.int64), np.diff(pattern.indptr))
        self._keys = rows * self._count + pattern.indices

    def of(self, species: int, cells: Any, other: int, others: Any) -> NDArray[int64]:
        """Places (k,) of derivatives of ``species`` in ``cells`` by species ``other`` in cells ``others``; -1: none."""
        import numpy as np

        rows, columns = self._at[species, cells], self._at[other, others]
        keys = rows * self._count + columns
        found = np.minimum(np.searchsorted(self._keys, keys), len(self._keys) - 1)
        return np.where((rows >= 0) & (columns >= 0) & (self._keys[found] == keys), found, -1)
