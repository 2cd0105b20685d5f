"""Adaptive marching cubes: cells too coarse for the surface are subdivided, without cracks. Imports numpy and numba.

Cells are refined in groups. On a face between a refined group and a coarse one, the fine and the coarse curves of the
surface must connect the same edges; a coarse group where they do not is refined too. The sides of the coarse triangles
there are then replaced by the fine curves.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING

from sceneql.mesh.bounded import Corner, bounded
from sceneql.mesh.cubes.faces import Curves, Sides, among, border_curves, face_sides
from sceneql.mesh.cubes.grid import BLOCK, MOST_BLOCKS, Grid, grid_around
from sceneql.mesh.cubes.grid_extraction import GridExtraction
from sceneql.mesh.cubes.hidden_kernels import DEEPEST
from sceneql.mesh.cubes.kept_blocks import KeptBlocks
from sceneql.mesh.cubes.levels import Level, Numbering
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

FEW_BLOCKS, FEW_CELLS = 2**8, 10_000
"""From these numbers of blocks with fine cells that are not proved empty or full, and of such cells, on, they are
halved but once, and not at all."""
MANY_GROUPS = 2**12
"""Above this number of groups cells are not subdivided by FINEST."""
MOST_BENT = 2**18
"""Most triangles of the fine cells in which normals vary by too much: beyond it, and beyond 4 times the coarse
triangles, the surface is left to shorter cells that are asked for."""
MOST_TWICE = 2**19
"""Most triangles of the mesh whose cells are cut by FINEST since the surface passes fine ones twice along an edge."""
FEW_TWICE = 2.0**-9
"""Share of the triangles up to which such cells are left as they are: where surface touches itself in points, cells of
any size pass it twice.
"""
COARSER, FINE, FINEST = 2, 4, 8
"""Factors of subdivision along a cell's side: where FINE would make too many triangles, the usual one, and one for a
tolerance that FINE would miss."""
TURN = 0.8
"""Largest difference of normals along a side, in cells, of triangles that stay: about eight times their distance from
the surface."""
SEAMLESS = 0.4
"""Time for a triangle of cells of one size, relative to one of cells that are cut among others."""
STILL_BENT = 2.0
"""Most triangles where bent cells are cut after all cells have got half the side, by those where they are cut before:
those of creases; of smooth surfaces there are fewer.
"""
SAFE = 0.5
"""Share of the tolerance to be reached along creases, where the error falls with the factor of subdivision."""
FEW = 0.25
"""Largest share of triangles beyond the tolerance for which subdividing their cells is better than a finer grid."""
AT_CREASE = 5 / 16
"""Bound of a side's distance from a crease of 60 degrees, in units of the side times the difference of its normals:
tan(30 deg) / 2. For a circular arc the bound is more than twice too large."""
STRAIGHT = 0.1
"""Distance of the fine curve on a face from the coarse side there, in coarse cells, above which the cell beyond
the face is subdivided too."""
MOST_GROUPS = 2**15
"""Most groups that are refined; more arise from noise, or from a grid far too coarse."""


def refined(
    tape: Tape, low: Corner, high: Corner, cell: float, tolerance: float | None = None
) -> tuple[Polygons, Unresolved]:
    """Triangles of the solid {tape < 0} clipped at the box low..high, from cells with side ``cell`` [m], and the
    unresolved cells.

    Subdivided are cells in which the normals vary by more than 60 degrees, or by TURN, within MOST_BENT triangles, and
    cells in which f has the other sign between corners of one sign; with a ``tolerance`` [m] also cells with triangles
    farther from the surface, unless these are more than FEW. They are cut by FINEST where the surface is seen to pass
    between corners of fine cells, within MOST_TWICE triangles. No cell is cut if groups are more than MOST_GROUPS.
    Where a smooth surface turns by too much nearly everywhere, all cells get half the side, and again where they need
    it: fewer triangles than cells cut where they turn, of thin tubes nearer at most and farther in the mean.
    The mesh is a closed 2-manifold; its bytes do not depend on the number of threads. Raises ValueError as
    ``grid_around``.
    """
    import numpy as np

    whole, grid = bounded(tape, low, high), grid_around(low, high, cell)
    shop, numbers = GridExtraction(whole, grid), Numbering(grid)
    blocks = shop.met()
    found, (where, volumes, seen) = shop.looked_into(blocks, 1, FINE)
    coarse, doubt = Level(shop, found, len(blocks)), Unresolved(where, volumes, grid, seen)
    if tolerance is None and _turns_much(coarse, grid, numbers):
        return refined(tape, low, high, 0.5 * cell)
    for cells, parts, most in _to_cut(whole, coarse, grid.cell, tolerance):
        asked = np.concatenate([cells, doubt.where[doubt.seen]])
        groups = _groups(asked, parts, numbers)
        if len(groups) > (MANY_GROUPS if parts == FINEST else MOST_GROUPS) or not len(groups):
            continue
        group = BLOCK // parts
        if parts**2 * among(numbers.of(coarse.cells // group), np.sort(numbers.of(groups))).sum() <= most:
            break
    made, left = _cut(shop, coarse, doubt, groups, parts)
    few, twice = FEW_TWICE * len(made.triangles), (FINEST / parts) ** 2 * len(made.triangles)
    if tolerance is None and left.seen.sum() > few and len(groups) <= MOST_GROUPS and twice <= MOST_TWICE:
        finest = _groups(asked, FINEST, numbers)
        if parts < FINEST and len(finest) <= MANY_GROUPS:
            made, left = _cut(shop, coarse, doubt, finest, FINEST)
    return unfolded(whole, made), replace(left, cell=grid.cell)


def _turns_much(coarse: Level, grid: Grid, numbers: Numbering) -> bool:
    """Whether half the side for all cells takes less time than to cut by FINE those in which normals vary by too much.

    As for a smooth surface all of which turns by too much: in cells of half the side few are left to be cut.
    """
    import numpy as np

    asked, halved = coarse.bent | (coarse.turns > TURN * grid.cell), COARSER**2 * len(coarse.triangles)
    if not asked.any() or halved > MOST_BENT or COARSER**3 * np.prod(grid.blocks + 1.0) > MOST_BLOCKS:
        return False
    group, owners = BLOCK // FINE, numbers.of(coarse.cells // (BLOCK // FINE))
    cut, bent = (
        FINE**2 * int(np.isin(owners, numbers.of(coarse.places_of(np.flatnonzero(some)) // group)).sum())
        for some in (asked, coarse.bent)
    )
    return SEAMLESS * halved + STILL_BENT * bent <= cut


def _groups(cells: Keys, parts: int, numbers: Numbering) -> Keys:
    """(g, 3) the groups of coarse cells, each one block of a grid ``parts`` times finer, that hold some cells."""
    return _distinct(cells // (BLOCK // parts), numbers)


def _cut(
    shop: GridExtraction, coarse: Level, doubt: Unresolved, groups: Keys, parts: int
) -> tuple[Polygons, Unresolved]:
    """The mesh with the cells of the ``groups`` cut by ``parts``, and of those around as far as the curves on their
    faces ask for it, and what stays unresolved.
    """
    import numpy as np

    group, grid, numbers = BLOCK // parts, shop.grid, Numbering(shop.grid)
    fine_shop = GridExtraction(shop.whole, Grid(grid.low, grid.cell / parts, grid.blocks * parts))
    kept_blocks = KeptBlocks(fine_shop)
    made = Polygons(coarse.places, coarse.triangles, coarse.normals)
    while 0 < len(groups) <= MOST_GROUPS:
        chosen = np.sort(numbers.of(groups))
        owned = _with_owners(groups)
        fine = Level(fine_shop, kept_blocks.extracted(owned), len(groups))
        kept = ~among(numbers.of(coarse.cells // group), chosen)
        sides = face_sides(coarse, kept, numbers, chosen, group)
        curves = border_curves(fine, parts, numbers, chosen, group)
        more = np.concatenate([_unmatched(sides, curves), _winding(fine, curves, grid.cell)])
        if not len(more):
            made = stitched(shop.whole, coarse, kept, fine, sides, curves)
            break
        before = len(groups)
        groups = _distinct(np.concatenate([groups, more // group]), numbers)
        if len(groups) == before:
            break
    return made, _left(fine_shop, groups, coarse, doubt, numbers)


def _left(fine_shop: GridExtraction, groups: Keys, coarse: Level, doubt: Unresolved, numbers: Numbering) -> Unresolved:
    """The unresolved ones of the fine cells of the coarse cells in doubt, and of those that the surface meets in the
    ``groups`` (g, 3); the coarse ones where these are too many.
    """
    import numpy as np

    if not (len(groups) or doubt.cells):
        return doubt
    group = BLOCK // round(doubt.grid.cell / fine_shop.grid.cell)
    within = coarse.met[among(numbers.of(coarse.met // group), np.sort(numbers.of(groups)))] if len(groups) else groups
    blocks, eighths = _by_eighths(np.concatenate([within, doubt.where]), group)
    if len(blocks) > MOST_GROUPS:
        return doubt
    left = hidden_in(fine_shop, blocks, 0, eighths=eighths)
    if 0 < left.cells < FEW_CELLS:
        blocks, eighths = _by_eighths(left.where.astype(np.int64), BLOCK)
        left = hidden_in(fine_shop, blocks, DEEPEST if len(blocks) < FEW_BLOCKS else 1, eighths=eighths)
    return left


def _distinct(places: Keys, numbers: Numbering) -> Keys:
    """The distinct ones of integer places (n, 3)."""
    import numpy as np

    return places[np.unique(numbers.of(places), return_index=True)[1]].astype(np.int64)


def _by_eighths(cells: Keys, group: int) -> tuple[Ints, NDArray[np.uint8]]:
    """Groups (n, 3) of ``group`` cells along each axis that cells (m, 3) lie in, and (n,) in which eighths of these."""
    import numpy as np

    where = cells // group
    size = where.max(axis=0, initial=0) + 1
    keys, first, owner = np.unique(
        where @ np.array([1, size[0], size[0] * size[1]]), return_index=True, return_inverse=True
    )
    eighths = np.full(len(keys), 255 if group == 1 else 0, dtype=np.uint8)
    half = 2 * (cells - group * where) // group
    np.bitwise_or.at(eighths, owner, (1 << (half @ np.array([1, 2, 4]))).astype(np.uint8))
    return where[first].astype(np.int32), eighths


def _to_cut(tape: Tape, coarse: Level, cell: float, tolerance: float | None) -> list[tuple[Keys, int, float]]:
    """Choices (cells (n, 3) to subdivide, factor of subdivision, most triangles), from the best to the cheapest."""
    import numpy as np

    count = len(coarse.triangles)
    too_bent, none = coarse.places_of(np.flatnonzero(coarse.bent)), np.zeros((0, 3), dtype=np.int64)
    if tolerance is None:
        most = max(4 * count, MOST_BENT)
        asked = coarse.places_of(np.flatnonzero(coarse.bent | (coarse.turns > TURN * cell)))
        return [(asked, FINE, most), (too_bent, FINE, most), (too_bent, COARSER, inf), (none, COARSER, inf)]
    off = _off(tape, coarse, tolerance)
    if (off > tolerance).sum() > FEW * len(off):
        return [(too_bent, FINE, inf), (none, FINE, inf)]
    cells = np.concatenate([too_bent, coarse.cells[off > tolerance]])
    finest = off.max(initial=0.0) > SAFE * FINE * tolerance
    first = [(cells, FINEST, inf)] if finest else []
    return [*first, (cells, FINE, inf), (too_bent, FINE, inf), (none, FINE, inf)]


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
    size = groups.max(axis=0) + 2
    strides = np.array([size[1] * size[2], size[2], 1])  # x first, as rows are sorted
    own = groups @ strides
    beside = np.setdiff1d(own[:, None] + steps @ strides, own)
    places = np.stack([beside // strides[0], beside // strides[1] % size[1], beside % size[2]], axis=1)
    return np.concatenate([groups, places]).astype(np.int32)


def _winding(fine: Level, curves: Curves, cell: float) -> Keys:
    """(n, 3) coarse cells at whose faces fine curves leave the straight line by more than STRAIGHT cells.

    As where a rim or a tip of the solid passes through a face between two vertices whose normals agree.
    """
    import numpy as np

    places = fine.places[curves.paths]
    first, along = places[:, :1], places[:, -1:] - places[:, :1]
    square = np.maximum((along**2).sum(axis=2, keepdims=True), 1e-300 * cell**2)
    share = np.clip(((places - first) * along).sum(axis=2, keepdims=True) / square, 0.0, 1.0)
    off = np.linalg.norm(places - first - share * along, axis=2).max(axis=1)
    found: Keys = curves.cells[off > STRAIGHT * cell]
    return found


def _unmatched(sides: Sides, curves: Curves) -> Keys:
    """(n, 3) coarse cells at whose faces coarse sides and fine curves do not connect the same edges."""
    import numpy as np

    return np.concatenate(
        [sides.cells[~np.isin(sides.ends, curves.ends)], curves.cells[~np.isin(curves.ends, sides.ends)]]
    )
