"""Marching cubes with finer cells where cells are too coarse for the surface, without gaps. Imports numpy and numba.

Cells are refined by groups, whose faces to other groups must show the same curves coarse and fine: a group whose
neighbor sees more than it does is refined too. The coarse triangles then follow the fine curves of the faces between.
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

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape

    Keys = NDArray[np.int64]

MANY_GROUPS = 2**12
"""With more groups, fine cells are not halved further to prove that they hide nothing, nor are cells cut in FINEST."""
FINE, FINEST = 4, 8
"""Parts that a cell's side is cut into, and where these do not bring triangles within a tolerance."""
SAFE = 0.5
"""Of what so many parts are hoped to bring triangles within, at creases."""
FEW = 0.25
"""Part of the triangles, as along creases, that shorter cells for them alone are better than for all."""
AT_CREASE = 5 / 16
"""How far two planes that turn by 60 degrees are off a side between them, in what their normals differ by along it:
tan(30 deg) / 2 of its length. Of an arc that is more than twice too much."""
MOST_GROUPS = 2**15
"""Groups to be refined; more are a field of noise, or a grid far too coarse."""


def refined(
    tape: Tape, low: Corner, high: Corner, cell: float, tolerance: float | None = None
) -> tuple[Polygons, Unresolved]:
    """Triangles of the solid {tape < 0} cut at the box low..high, by cells of a size [m]; what is left unresolved.

    Cells are cut in which the surface turns much, and those whose corners have one sign without a proof that f keeps it
    between them; none where that were more than MOST_GROUPS. With a ``tolerance`` [m] those too in which triangles are
    farther off the surface, where they are FEW, as at creases: else all cells are too long. Closed and 2-manifold; the
    bytes do not depend on the number of threads. Raises ValueError as ``grid_around``.
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
            # Every cell in doubt is in a group, so what the fine cells hide is all.
            left = hidden_in(fine_shop, owned[: len(groups)], DEEPEST if len(groups) < MANY_GROUPS else 0)
            return stitched(whole, coarse, kept, fine, sides, curves), left
        groups = np.unique(np.concatenate([groups, more // group]), axis=0)
    return Polygons(coarse.places, coarse.triangles, coarse.normals), doubt


def _to_cut(tape: Tape, coarse: Level, tolerance: float | None) -> list[tuple[Keys, int]]:
    """Cells (n, 3) to be cut, with how many parts along a side, from what is best on to what is fewest."""
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
    """(t,) how far triangles are off the surface [m]: measured where their corners allow more than a tolerance."""
    import numpy as np

    off = np.empty(len(found.triangles))
    most_turn(found.places, found.triangles, found.normals, off)
    off *= AT_CREASE
    some = off > tolerance
    off[some] = distances_off(tape, found.places[found.triangles[some]])
    return off


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
