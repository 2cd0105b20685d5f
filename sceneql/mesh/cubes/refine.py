"""Adaptive marching cubes: cells too coarse for the surface are subdivided, without cracks. Imports numpy and numba.

Cells are refined in groups. On a face between a refined group and a coarse one, the fine and the coarse curves of the
surface must connect the same edges; a coarse group where they do not is refined too. The sides of the coarse triangles
there are then replaced by the fine curves.
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
"""Above this number of groups, cells are not subdivided by FINEST, nor fine cells bisected to prove them empty."""
FINE, FINEST = 4, 8
"""Factors of subdivision along a cell's side: the usual one, and one for a tolerance that FINE would miss."""
SAFE = 0.5
"""Share of the tolerance to be reached along creases, where the error falls with the factor of subdivision."""
FEW = 0.25
"""Largest share of triangles beyond the tolerance for which subdividing their cells is better than a finer grid."""
AT_CREASE = 5 / 16
"""Bound of a side's distance from a crease of 60 degrees, in units of the side times the difference of its normals:
tan(30 deg) / 2. For a circular arc the bound is more than twice too large."""
MOST_GROUPS = 2**15
"""Most groups that are refined; more arise from noise, or from a grid far too coarse."""


def refined(
    tape: Tape, low: Corner, high: Corner, cell: float, tolerance: float | None = None
) -> tuple[Polygons, Unresolved]:
    """Triangles of the solid {tape < 0} clipped at the box low..high, from cells with side ``cell`` [m], and the
    unresolved cells.

    Subdivided are cells in which the normals vary too much, and cells with corners of one sign for which no proof was
    found that f has it throughout; with a ``tolerance`` [m] also cells with triangles farther from the surface, unless
    these are more than FEW. No cell is subdivided if their groups are more than MOST_GROUPS. The mesh is a closed
    2-manifold; its bytes do not depend on the number of threads. Raises ValueError as ``grid_around``.
    """
    import numpy as np

    whole, grid = bounded(tape, low, high), grid_around(low, high, cell)
    shop, numbers = GridExtraction(whole, grid), Numbering(grid)
    blocks = shop.met()
    coarse, doubt = level(shop, shop.extracted(blocks), len(blocks)), hidden_in(shop, blocks)
    for cells, parts in _to_cut(whole, coarse, tolerance):
        group = BLOCK // parts  # coarse cells along a group, which is one block of the fine grid
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
    """Choices (cells (n, 3) to subdivide, factor of subdivision), from the most accurate to the cheapest."""
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
    """The groups, followed by those of their upper neighbors not among them, which own edges on the groups' borders."""
    import numpy as np

    steps = np.array([[bits & 1, bits >> 1 & 1, bits >> 2] for bits in range(1, 8)])
    beside = np.unique((groups[:, None] + steps).reshape(-1, 3), axis=0)
    size = beside.max(axis=0) + 1
    strides = np.array([1, size[0], size[0] * size[1]])
    return np.concatenate([groups, beside[~np.isin(beside @ strides, groups @ strides)]]).astype(np.int32)


def _unmatched(sides: Sides, curves: Curves) -> Keys:
    """(n, 3) coarse cells at whose faces coarse sides and fine curves do not connect the same edges."""
    import numpy as np

    return np.concatenate(
        [sides.cells[~np.isin(sides.ends, curves.ends)], curves.cells[~np.isin(curves.ends, sides.ends)]]
    )
