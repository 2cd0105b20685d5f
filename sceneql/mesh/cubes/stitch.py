"""Coarse and fine triangles joined into a closed mesh. Imports numpy and numba."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.field.tape.tape_solid import field_values
from sceneql.mesh.cubes.connect_kernels import BENT
from sceneql.mesh.cubes.fan_kernels import center, fan, renumber
from sceneql.mesh.polygons import Polygons
from sceneql.mesh.repair.move_vertices import settled, turned_outward

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Tape
    from sceneql.mesh.cubes.faces import Curves, Sides
    from sceneql.mesh.cubes.levels import Level

    Keys = NDArray[np.int64]

TRIED, HALVINGS = 8, 40
"""Places to either side at which a change of sign is sought, and halvings of what is found."""


def stitched(tape: Tape, coarse: Level, kept: NDArray[np.bool_], fine: Level, sides: Sides, curves: Curves) -> Polygons:
    """The mesh of the ``kept`` coarse and of all fine triangles.

    A coarse triangle with sides on the border is replaced by a fan whose border follows the fine curves.
    """
    import numpy as np

    offset = len(coarse.places)
    order = np.argsort(curves.ends)
    paths = curves.paths[order[np.searchsorted(curves.ends[order], sides.ends)]]
    same = np.arange(offset)
    same[coarse.triangles[sides.triangles, sides.turns]] = paths[:, 0] + offset
    same[coarse.triangles[sides.triangles, (sides.turns + 1) % 3]] = paths[:, -1] + offset
    bordering = np.unique(sides.triangles)
    plain = kept.copy()
    plain[bordering] = False
    fans, rings, begin = _fans(same[coarse.triangles[bordering]], sides, bordering, paths, offset, len(fine.places))
    places, normals = np.concatenate([coarse.places, fine.places]), np.concatenate([coarse.normals, fine.normals])
    (means, ways), reach = np.empty((2, len(begin) - 1, 3)), np.empty(len(begin) - 1)
    center(places, normals, rings, begin, means, ways, reach)
    own, slopes = _on_sheets(tape, means, ways, reach)
    triangles = np.concatenate([same[coarse.triangles[plain]], fans, fine.triangles + offset])
    numbers, counted = np.zeros(len(places) + len(own), dtype=np.int32), np.empty(triangles.shape, dtype=np.int32)
    renumber(triangles, numbers, counted)
    used = numbers >= 0
    places, normals = np.concatenate([places, own])[used], np.concatenate([normals, slopes])[used]
    seams = np.arange(plain.sum(), len(triangles) - len(fine.triangles))
    return turned_outward(tape, Polygons(places, counted, normals), seams)


def _fans(corners: Keys, sides: Sides, bordering: Keys, paths: Keys, offset: int, fine: int) -> tuple[Keys, Keys, Keys]:
    """(triangles (n, 3) in place of those of ``corners`` (m, 3), whose rows are ``bordering`` (m,), vertices of the
    rings around inner vertices, first one of each ring), as the kernel ``fan`` has them.

    ``paths`` (s, n) of the ``sides``; fine vertices are counted from ``offset`` on, there are ``fine``.
    """
    import numpy as np

    rows = np.full(corners.shape, -1)
    rows[np.searchsorted(bordering, sides.triangles), sides.turns] = np.arange(len(paths))
    room = corners.size + paths.size
    fans, rings = np.empty((room, 3), dtype=np.int64), np.empty(room, dtype=np.int64)
    begin = np.zeros(len(corners) + 1, dtype=np.int64)
    count, inner = fan(corners, rows, paths, offset, offset + fine, fans, rings, begin)
    return fans[:count], rings, begin[: inner + 1]


def _on_sheets(tape: Tape, means: Floats, ways: Floats, reach: Floats) -> tuple[Floats, Floats]:
    """Points (n, 3) on the surface near ``means`` (n, 3), at most ``reach`` (n,) [m] away, and the normals there.

    Beside a rim Newton's method may go to the face beyond: where the normal is not as ``ways`` (n, 3), those of the
    vertices around, the surface is sought along these.
    """
    import numpy as np

    own, slopes = settled(tape, means, reach)
    sizes = np.linalg.norm(ways, axis=1, keepdims=True)
    ways = np.divide(ways, sizes, out=np.zeros_like(ways), where=sizes > 0.0)
    beyond = np.flatnonzero(np.einsum("nj,nj->n", slopes, ways) < BENT)
    if not len(beyond):
        return own, slopes
    begun, along = means[beyond], reach[beyond, None] * ways[beyond]
    steps = np.linspace(-1.0, 1.0, 2 * TRIED + 1)
    inside = (field_values(tape, (begun[:, None] + steps[:, None] * along[:, None]).reshape(-1, 3)) < 0.0).reshape(
        len(begun), -1
    )
    left = inside[:, :-1] & ~inside[:, 1:]
    first = np.where(left, np.abs(steps[:-1] + steps[1:]), np.inf).argmin(axis=1)
    low, high = steps[first], steps[first + 1]
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        within = field_values(tape, begun + middle[:, None] * along) < 0.0
        low, high = np.where(within, middle, low), np.where(within, high, middle)
    new, normals = settled(tape, begun + low[:, None] * along, reach[beyond])
    better = left.any(axis=1) & (np.einsum("nj,nj->n", normals, ways[beyond]) >= BENT)
    own[beyond[better]], slopes[beyond[better]] = new[better], normals[better]
    return own, slopes
