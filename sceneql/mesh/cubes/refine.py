"""Marching cubes with finer cells where cells are too coarse for the surface, without gaps. Imports numpy and numba.

Cells are refined by groups, on whose faces to other groups the curves of coarse and fine cells must match: a group
whose neighbor shows more curves than it does is refined too. The coarse triangles then follow the fine curves there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.mesh.bounded import Corner, bounded
from sceneql.mesh.cubes.faces import Curves, Sides, among, border_curves, face_sides
from sceneql.mesh.cubes.grid import BLOCK, Grid, grid_around
from sceneql.mesh.cubes.grid_extraction import GridExtraction
from sceneql.mesh.cubes.hidden_kernels import DEEPEST
from sceneql.mesh.cubes.levels import Level, Numbering, level
from sceneql.mesh.cubes.stitch import stitched
from sceneql.mesh.cubes.tolerance import distances_off
from sceneql.mesh.cubes.triangle_kernels import most_turn
from sceneql.mesh.cubes.unresolved import Unresolved, hidden_in
from sceneql.mesh.polygons import Polygons
from sceneql.mesh.repair.unfolded import unfolded

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape

    Keys = NDArray[np.int64]

MANY_GROUPS = 2**12
"""With more groups, fine cells are not halved further to prove them empty, nor are cells cut in FINEST."""
FINE, FINEST = 4, 8
"""Parts of a cell's side after a cut, and after one for a tolerance that FINE misses."""
SAFE = 0.5
"""Share of the tolerance that a cut in FINE is expected to reach at creases."""
FEW = 0.25
"""Largest share of triangles, as along creases, for which cutting only their cells is better than shorter cells."""
AT_CREASE = 5 / 16
"""Distance of two planes that meet at 60 degrees from a side between them, over the difference of their normals along
it: tan(30 deg) / 2 of its length. For an arc that is more than twice too much."""
MOST_GROUPS = 2**15
"""Most groups that are refined; more come from noise, or from a grid far too coarse."""


def refined(
    tape: Tape, low: Corner, high: Corner, cell: float, tolerance: float | None = None
) -> tuple[Polygons, Unresolved]:
    """Triangles of the solid {tape < 0} cut at the box low..high, by cells of a size [m]; and the unresolved cells.

    Cut are cells in which the normals turn too much, and cells with corners of one sign without a proof that f keeps it
    inside; none if these are more than MOST_GROUPS. With a ``tolerance`` [m] also cells with triangles farther off the
    surface, if they are FEW, as at creases: else all cells are too long. Closed and 2-manifold; the bytes do not depend
    on the number of threads. Raises ValueError as ``grid_around``.
    """
    import numpy as np

    whole, grid = bounded(tape, low, high), grid_around(low, high, cell)
    shop, numbers = GridExtraction(whole, grid), Numbering(grid)
    blocks = shop.met()
    coarse, doubt = level(shop, shop.extracted(blocks), len(blocks)), hidden_in(shop, blocks)
    for cells, parts in _to_cut(whole, coarse, tolerance):
        group = BLOCK // parts  # cells along a group, which is one block of the fine grid
        groups = np.unique(np.concatenate([cells, doubt.where]).astype(np.int64) // group, axis=0)
        if len(groups) <= (MANY_GROUPS if parts == FINEST else MOST_GROUPS):
            break
    fine_shop = GridExtraction(whole, Grid(grid.low, grid.cell / parts, grid.blocks * parts))
    while 0 < len(groups) <= MOST_GROUPS:
        chosen = np.sort(numbers.of(groups))
        owned = _with_owners(groups)
        fine = level(fine_shop, fine_shop.extracted(owned), len(groups))
        kept = ~among(numbers.of(coarse.cells // group), chosen)
        sides = face_sides(coarse, kept, numbers, chosen, group)
        curves = border_curves(fine, parts, numbers, chosen, group)
        more = _unmatched(sides, curves)
        if not len(more):
            # Every doubtful cell is in a group, so the fine cells account for all.
            left = hidden_in(fine_shop, owned[: len(groups)], DEEPEST if len(groups) < MANY_GROUPS else 0)
            return unfolded(whole, stitched(whole, coarse, kept, fine, sides, curves)), left
        groups = np.unique(np.concatenate([groups, more // group]), axis=0)
    return unfolded(whole, Polygons(coarse.places, coarse.triangles, coarse.normals)), doubt


def _to_cut(tape: Tape, coarse: Level, tolerance: float | None) -> list[tuple[Keys, int]]:
    """Choices of cells (n, 3) to be cut, and into how many parts a side, from the most accurate to the cheapest."""
    bent = coarse.cells[coarse.bent]
    if tolerance is None:
        return [(bent, FINE)]
    off = _off(tape, coarse, tolerance)
    if (off > tolerance).sum() > FEW * len(off):
        return [(bent, FINE)]
    cells = coarse.cells[coarse.bent | (off > tolerance)]
    finest = off.max(initial=0.0) > SAFE * FINE * tolerance
    return [*([(cells, FINEST)] if finest else []), (cells, FINE), (bent, FINE)]


def _off(tape: Tape, found: Level, tolerance: float) -> Floats:
    """(t,) distances of triangles from the surface [m]; measured only if a bound by normals exceeds the tolerance."""
    import numpy as np

    off = np.empty(len(found.triangles))
    most_turn(found.places, found.triangles, found.normals, off)
    off *= AT_CREASE
    some = off > tolerance
    off[some] = distances_off(tape, found.places[found.triangles[some]])
    return off


def _with_owners(groups: Keys) -> Ints:
    """The groups, followed by the neighbors that own some of their edges."""
    import numpy as np

    steps = np.array([[bits & 1, bits >> 1 & 1, bits >> 2] for bits in range(1, 8)])
    beside = np.unique((groups[:, None] + steps).reshape(-1, 3), axis=0)
    size = beside.max(axis=0) + 1
    strides = np.array([1, size[0], size[0] * size[1]])
    return np.concatenate([groups, beside[~np.isin(beside @ strides, groups @ strides)]]).astype(np.int32)


def _unmatched(sides: Sides, curves: Curves) -> Keys:
    """(n, 3) cells whose curves on faces to the other size of cells do not match."""
    import numpy as np

    return np.concatenate(
        [sides.cells[~np.isin(sides.ends, curves.ends)], curves.cells[~np.isin(curves.ends, sides.ends)]]
    )
