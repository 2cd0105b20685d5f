"""Sparsity pattern of a barrier's derivatives, without and with rigid bodies. Imports numpy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.contacts.barrier import pairs_layout as layout

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.contacts.barrier.surfaces_of import Surface
    from sceneql.system import Slopes

SLOPES = "sceneql.contacts.barrier.skins_slopes_kernels:slopes"
KERNEL = "sceneql.contacts.barrier.carried_slopes_kernels:slopes"


@dataclass
class Places:
    """Pairs of vertices that have been near each other so far."""

    count: int
    keys: NDArray[int64]
    """Pairs (i, j) as i * count + j, ascending."""
    rows: NDArray[int64]
    """(n, VERTEX): rows of the vertices by pairs_layout."""

    def add(self, vertices: Any) -> bool:
        """Add all pairs among rows of four vertices (k, 4); returns whether any is new."""
        fours = np.asarray(vertices, dtype=np.int64).reshape(-1, 4)
        more = (fours[:, :, None] * self.count + fours[:, None, :]).ravel()
        before = len(self.keys)
        self.keys = np.union1d(self.keys, more)
        return len(self.keys) > before

    def slopes(self, ints: NDArray[int64]) -> Slopes:
        """Derivatives as blocks of all pairs; ``ints``: integers of the term."""
        from sceneql.system import Slopes

        row, column = np.divmod(self.keys, self.count)
        starts = np.searchsorted(row, np.arange(self.count + 1))
        by = [self.rows[column, which] for which in (layout.POSITION, layout.VELOCITY)]
        own = np.concatenate([ints, starts, column])
        return Slopes(SLOPES, np.tile(self.rows[row, layout.VELOCITY], 2), np.concatenate(by), own, blocks=True)


@dataclass
class Carriers(Places):
    """Pairs of carriers that have been near each other so far; a carrier is an elastic vertex or a rigid body."""

    carrier: NDArray[int64]
    """(n,): carrier of each vertex."""
    turns: NDArray[Any]
    """(count,): whether a carrier is a rigid body."""
    first: NDArray[int64]
    """(count,): index of a carrier's first vertex."""

    @classmethod
    def of(cls, surfaces: Sequence[Surface], rows: NDArray[int64]) -> Carriers:
        """Carriers of surfaces, each paired with itself alone; ``rows``: as in Places."""
        found: list[NDArray[int64]] = []
        first: list[int] = []
        turns: list[bool] = []
        count = vertex = 0
        for one in surfaces:
            own = 1 if one.rigid else len(one.at)
            found.append(count + (np.zeros(len(one.at), dtype=np.int64) if one.rigid else np.arange(own)))
            first += [vertex] if one.rigid else range(vertex, vertex + own)
            turns += [one.rigid] * own
            count, vertex = count + own, vertex + len(one.at)
        keys = np.arange(count, dtype=np.int64) * (count + 1)
        return cls(count, keys, rows, np.concatenate(found), np.array(turns), np.array(first))

    def add(self, vertices: Any) -> bool:
        """Add all pairs of carriers among rows of four vertices (k, 4); returns whether any is new."""
        return super().add(self.carrier[np.asarray(vertices, dtype=np.int64)])

    def slopes(self, ints: NDArray[int64]) -> Slopes:
        """Derivatives as entries of all pairs; ``ints``: integers of the term."""
        from sceneql.system import Slopes

        row, column = np.divmod(self.keys, self.count)
        starts = np.searchsorted(row, np.arange(self.count + 1))
        rows, columns, lengths = [], [], []
        for i, j in zip(row.tolist(), column.tolist(), strict=True):
            down, across = self._felt(i), self._moved(j)
            rows.append(np.repeat(down, len(across)))
            columns.append(np.tile(across, len(down)))
            lengths.append(len(down) * len(across))
        begins = np.cumsum([0, *lengths])[:-1]
        own = np.concatenate([ints, [self.count], starts, column, begins, self.carrier])
        return Slopes(KERNEL, np.concatenate(rows), np.concatenate(columns), own)

    def _felt(self, carrier: int) -> list[int]:
        """Indices of the rates that a carrier's forces change: velocity, and momentum of a rigid body."""
        place = self.rows[self.first[carrier]].tolist()
        found = [place[layout.VELOCITY] + k for k in range(3)]
        return found + [place[layout.MOMENTUM] + k for k in range(3)] if self.turns[carrier] else found

    def _moved(self, carrier: int) -> list[int]:
        """Indices in y of a carrier's position and velocity; of a body in the order of place_slopes_kernels."""
        place = self.rows[self.first[carrier]].tolist()
        x, v = ([place[which] + k for k in range(3)] for which in (layout.POSITION, layout.VELOCITY))
        if not self.turns[carrier]:
            return x + v
        return x + [place[layout.ROTATION] + k for k in range(4)] + v + [place[layout.MOMENTUM] + k for k in range(3)]
