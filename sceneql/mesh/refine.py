"""Marching cubes with finer cells where cells are too coarse for the surface, without gaps. Imports numpy and numba.

Cells are refined by groups, whose faces to other groups must show the same curves coarse and fine: a group whose
neighbor sees more than it does is refined too. The coarse triangles then follow the fine curves of the faces between.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sceneql.mesh.bounded import Corner, bounded
from sceneql.mesh.cases import cases
from sceneql.mesh.faces import Curves, Sides, among, border_curves, face_sides
from sceneql.mesh.grid import BLOCK, Grid, grid_around
from sceneql.mesh.hidden_kernels import DEEPEST
from sceneql.mesh.polygonise import connected
from sceneql.mesh.polygons import Polygons
from sceneql.mesh.stitch import stitched
from sceneql.mesh.unresolved import Unresolved, hidden_in
from sceneql.mesh.workshop import Found, Workshop

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape

    Keys = NDArray[np.int64]

MANY_GROUPS = 2**12
"""With more groups, fine cells are not halved further to prove that they hide nothing."""
FINE = 4
"""Parts that a cell's side is cut into."""
GROUP = BLOCK // FINE
"""Cells along a group, which is one block of the fine grid."""


MOST_GROUPS = 2**15
"""Groups to be refined; more are a field of noise, or a grid far too coarse."""


@dataclass(frozen=True, slots=True, eq=False)
class Level:
    """Triangles of the cells of one size."""

    places: Floats
    normals: Floats
    triangles: Ints
    """(t, 3)"""
    doubled: Keys
    """(v, 3) middles of the crossed edges in half cells, for the vertices on edges."""
    cells: Keys
    """(t, 3) the cell of each triangle."""
    bent: NDArray[np.bool_]
    """(t,) whether the surface turns much in it."""


def level(shop: Workshop, found: Found, blocks: int) -> Level:
    """The triangles of the first so many blocks."""
    import numpy as np

    triangles, bent = connected(shop, found, blocks)
    key = found.keys.astype(np.int64)
    owner = np.repeat(found.blocks.astype(np.int64), np.diff(found.begin), axis=0)
    doubled = 2 * (BLOCK * owner + _within(key // 3))
    doubled[np.arange(len(key)), key % 3] += 1
    cube = found.cubes[: len(bent)]
    inside = np.repeat(found.blocks[:blocks].astype(np.int64), np.diff(found.cube_at[: blocks + 1]), axis=0)
    cells = BLOCK * inside + _within(cube[:, 0].astype(np.int64))
    counts = np.diff(cases().start)[cube[:, 1]]
    return Level(
        found.place, found.normal, triangles, doubled, np.repeat(cells, counts, axis=0), np.repeat(bent == 1, counts)
    )


def _within(place: Keys) -> Keys:
    """(n, 3) of places (n,) in a block."""
    import numpy as np

    return np.stack([place % BLOCK, place // BLOCK % BLOCK, place // BLOCK**2], axis=1)


class Numbering:
    """Cells, groups and edges of a grid as single numbers."""

    def __init__(self, grid: Grid) -> None:
        import numpy as np

        size = 2 * BLOCK * (grid.blocks.astype(np.int64) + 2)
        self.strides = np.array([1, size[0], size[0] * size[1]])

    def of(self, places: Keys) -> Keys:
        """(n,) of (n, 3), distinct for cells, for groups, and for middles of edges in half cells."""
        found: Keys = (places + 1) @ self.strides
        return found


def refined(tape: Tape, low: Corner, high: Corner, cell: float) -> tuple[Polygons, Unresolved]:
    """Triangles of the solid {tape < 0} cut at the box low..high, by cells of a size [m]; what is left unresolved.

    Cells are cut in which the surface turns much, and those whose corners have one sign without a proof that f keeps it
    between them; none where that were more than MOST_GROUPS. Closed and 2-manifold; the bytes do not depend on the
    number of threads. Raises ValueError as ``grid_around``.
    """
    import numpy as np

    whole, grid = bounded(tape, low, high), grid_around(low, high, cell)
    shop, numbers = Workshop(whole, grid), Numbering(grid)
    blocks = shop.met()
    coarse, doubt = level(shop, shop.extracted(blocks), len(blocks)), hidden_in(shop, blocks)
    fine_shop = Workshop(whole, Grid(grid.low, grid.cell / FINE, grid.blocks * FINE))
    groups = np.unique(np.concatenate([coarse.cells[coarse.bent], doubt.where]).astype(np.int64) // GROUP, axis=0)
    while 0 < len(groups) <= MOST_GROUPS:
        chosen = np.sort(numbers.of(groups))
        owned = _with_owners(groups)
        fine = level(fine_shop, fine_shop.extracted(owned), len(groups))
        kept = ~among(numbers.of(coarse.cells // GROUP), chosen)
        sides = face_sides(coarse, kept, numbers, chosen, GROUP)
        curves = border_curves(fine, FINE, numbers, chosen, GROUP)
        more = _unmatched(sides, curves)
        if not len(more):
            # Every cell in doubt is in a group, so what the fine cells hide is all.
            left = hidden_in(fine_shop, owned[: len(groups)], DEEPEST if len(groups) < MANY_GROUPS else 0)
            return stitched(whole, coarse, kept, fine, sides, curves), left
        groups = np.unique(np.concatenate([groups, more // GROUP]), axis=0)
    return Polygons(coarse.places, coarse.triangles, coarse.normals), doubt


def _with_owners(groups: Keys) -> Ints:
    """The groups, and after them those next to them that own edges of theirs."""
    import numpy as np

    steps = np.array([[bits & 1, bits >> 1 & 1, bits >> 2] for bits in range(1, 8)])
    beside = np.unique((groups[:, None] + steps).reshape(-1, 3), axis=0)
    size = beside.max(axis=0) + 1
    strides = np.array([1, size[0], size[0] * size[1]])
    return np.concatenate([groups, beside[~np.isin(beside @ strides, groups @ strides)]]).astype(np.int32)


def _unmatched(sides: Sides, curves: Curves) -> Keys:
    """(n, 3) cells whose faces to finer ones do not show the same curves there."""
    import numpy as np

    return np.concatenate(
        [sides.cells[~np.isin(sides.ends, curves.ends)], curves.cells[~np.isin(curves.ends, sides.ends)]]
    )
