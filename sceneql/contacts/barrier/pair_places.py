"""Where the derivatives of a barrier between skins stand, as pairs come near. Imports numpy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.contacts.barrier import pairs_layout as layout

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.system import Slopes

SLOPES = "sceneql.contacts.barrier.skins_slopes_kernels:slopes"


@dataclass
class Places:
    """The pairs of vertices that have been near so far."""

    count: int
    keys: NDArray[int64]
    """Ascending, i * count + j."""
    rows: NDArray[int64]
    """(n, VERTEX) of pairs_layout."""

    def add(self, vertices: Any) -> bool:
        """Add all pairs among rows of four vertices (k, 4); whether any is new."""
        fours = np.asarray(vertices, dtype=np.int64).reshape(-1, 4)
        more = (fours[:, :, None] * self.count + fours[:, None, :]).ravel()
        before = len(self.keys)
        self.keys = np.union1d(self.keys, more)
        return len(self.keys) > before

    def slopes(self, ints: NDArray[int64]) -> Slopes:
        """The blocks of all these pairs; ``ints``: the integers of the term."""
        from sceneql.system import Slopes

        row, column = np.divmod(self.keys, self.count)
        starts = np.searchsorted(row, np.arange(self.count + 1))
        by = [self.rows[column, which] for which in (layout.POSITION, layout.VELOCITY)]
        own = np.concatenate([ints, starts, column])
        return Slopes(SLOPES, np.tile(self.rows[row, layout.VELOCITY], 2), np.concatenate(by), own, blocks=True)
