"""Cells of a model, stored in the floats of an island."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sceneql.grids.domain.cells import Cells
    from sceneql.system import Assembly


class Ground:
    """A model's cells, with the offsets of their box, volumes and divisors in the island's floats."""

    def __init__(self, cells: Cells, assembly: Assembly) -> None:
        self.cells = cells
        self.count = len(cells.volumes)
        self.inside = cells.volumes > 0.0
        self.centers = cells.centers()
        if cells.flat:
            self.centers[:, 2] = 0.0
        low_z = -0.5 * cells.spacing[2] if cells.flat else cells.low[2]
        self.box_at = assembly.floats([*cells.low[:2], low_z, *cells.spacing])
        self.volumes_at = assembly.floats(cells.volumes)
        self.divisors_at = assembly.floats(np.where(self.inside, cells.volumes, 1.0))
        """Offset of the volumes with 1 in place of 0 outside, to divide by."""

    @property
    def memory(self) -> tuple[int, ...]:
        """The integers that medium.layout_of reads."""
        return (self.volumes_at, self.box_at, *self.cells.shape)
