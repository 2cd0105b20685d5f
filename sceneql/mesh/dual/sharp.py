"""Polygonization with edges and corners kept sharp: dual contouring. Imports numpy and numba."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.mesh.bounded import Corner, bounded
from sceneql.mesh.cubes.cases import cases
from sceneql.mesh.cubes.grid import grid_around
from sceneql.mesh.cubes.grid_extraction import Found, GridExtraction, Room
from sceneql.mesh.dual.dual_kernels import dual
from sceneql.mesh.dual.halves import halved
from sceneql.mesh.dual.split_nonmanifold import split_nonmanifold
from sceneql.mesh.polygons import Polygons
from sceneql.mesh.repair.repair_folds import Dual, repair_folds, repair_turned

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape

AROUND = [0, 1, 3, 2]
"""The four cubes around a grid edge, counterclockwise seen against its axis; each by the edge's number in it, mod 4."""


def polygonise_sharp(tape: Tape, low: Corner, high: Corner, cell: float) -> Polygons:
    """Triangles of the solid {tape < 0} clipped at the box low..high, with sharp edges and corners, from cells [m].

    A closed 2-manifold; passages narrower than a cell may be closed. The bytes do not depend on the number of threads.
    Raises ValueError as ``grid_around``.
    """
    import numpy as np

    whole = bounded(tape, low, high)
    shop = GridExtraction(whole, grid_around(low, high, cell))
    found = shop.extracted(shop.met())
    places, normals, rings, corners, outward = _vertices(shop, found)
    quads = corners[:, AROUND]
    quads[outward == 0] = quads[outward == 0, ::-1]
    plain, more_places, more = split_nonmanifold(quads, rings, found.place, len(places))
    ways = np.where(outward == 0, -1, 1) * (found.keys % 3 + 1)
    quads, ways = quads[plain], ways[plain]
    triangles = np.concatenate([halved(whole, places, quads, ways), more]).astype(np.int32)
    places, normals = np.concatenate([places, more_places]), np.concatenate([normals, np.zeros_like(more_places)])
    means = _means(rings, found.place)
    lows = shop.grid.low + np.floor((means - shop.grid.low) / cell) * cell
    dual = Dual(whole, quads, ways, rings, found.place, found.normal, means, lows, cell)
    return repair_turned(whole, repair_folds(dual, Polygons(places, triangles, normals)))


def _vertices(shop: GridExtraction, found: Found) -> tuple[Floats, Floats, Ints, Ints, NDArray[np.int8]]:
    """(places, normals, rings, corners, outward) as of the kernel ``dual``, for all blocks."""
    import numpy as np

    table = cases()
    curves = (table.curves[:, :, 0] >= 0).sum(axis=1)[found.cubes[:, 1]]
    dual_at = np.concatenate([[0], np.cumsum(curves)])[found.cube_at]
    count, edges = int(dual_at[-1]), int(found.begin[-1])
    places, normals = np.empty((count, 3)), np.empty((count, 3))
    rings, corners = np.empty((count, 12), dtype=np.int32), np.full((edges, 4), -1, dtype=np.int32)
    outward = np.empty(edges, dtype=np.int8)

    def work(r: Room, first: int, last: int) -> None:
        dual(
            *shop.program, r.scratch, shop.grid.numbers, found.blocks, first, last, found.beyond, found.begin,
            found.cube_at, dual_at, found.keys, found.cubes, table.config, table.curves, r.local, r.fit,
            found.place, found.normal, places, normals, rings, corners, outward,
        )  # fmt: skip

    shop.over_blocks(len(found.blocks), work)
    return places, normals, rings, corners, outward


def _means(rings: Ints, crossings: Floats) -> Floats:
    """(v, 3) [m] for each dual vertex the mean of the crossings (e, 3) in its ring."""
    import numpy as np

    given = rings >= 0
    total = np.zeros((len(rings), 3))
    for k in range(rings.shape[1]):
        total[given[:, k]] += crossings[rings[given[:, k], k]]
    found: Floats = total / given.sum(axis=1)[:, None]
    return found
