"""Marching cubes on a tape: closed, in ambiguous cubes joined as f itself is at saddles. Imports numpy and numba."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.mesh.bounded import Corner, bounded
from sceneql.mesh.cubes.cases import cases
from sceneql.mesh.cubes.connect_kernels import connect
from sceneql.mesh.cubes.grid import grid_around
from sceneql.mesh.cubes.grid_extraction import Found, GridExtraction, Room
from sceneql.mesh.polygons import Polygons

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape


def connected(shop: GridExtraction, found: Found, blocks: int) -> tuple[Ints, NDArray[np.bool_], Floats]:
    """Triangles (t, 3) of the first ``blocks`` blocks, and of each cube (c,) whether its normals vary by too much
    (``bends``) and the largest difference of normals along a side of its triangles (``turn``) [m].

    Writes positions and normals of the inner vertices into ``found``.
    """
    import numpy as np

    table = cases()
    triangles = np.empty((int(found.triangle_at[blocks]), 3), dtype=np.int32)
    bent, turns = np.zeros(int(found.cube_at[blocks]), dtype=bool), np.zeros(int(found.cube_at[blocks]))

    def work(r: Room, first: int, last: int) -> None:
        connect(
            *shop.program, r.scratch, shop.grid.numbers, found.blocks, first, last, found.beyond,
            found.begin, found.cube_at, found.triangle_at, found.own_at, found.keys, found.cubes,
            table.start, table.triangles, table.around, r.local, r.low, found.place, found.normal, triangles,
            bent, turns,
        )  # fmt: skip

    shop.over_blocks(blocks, work)
    return triangles, bent, turns


def polygonise(tape: Tape, low: Corner, high: Corner, cell: float) -> Polygons:
    """Triangles of the solid {tape < 0} clipped at the box low..high, from cells with side ``cell`` [m].

    The bytes do not depend on the number of threads. Raises ValueError as ``grid_around``.
    """
    shop = GridExtraction(bounded(tape, low, high), grid_around(low, high, cell))
    found = shop.extracted(shop.met())
    triangles, _, _ = connected(shop, found, len(found.blocks))
    return Polygons(found.place, triangles, found.normal)
