"""Coarse and fine triangles joined into a closed mesh. Imports numpy and numba."""

from __future__ import annotations

from collections import defaultdict
from itertools import pairwise
from typing import TYPE_CHECKING

from sceneql.field.tape.tape_solid import field_values
from sceneql.mesh.cubes.connect_kernels import BENT
from sceneql.mesh.polygons import Polygons
from sceneql.mesh.repair.move_vertices import settled, turned_outward

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Tape
    from sceneql.mesh.cubes.faces import Curves, Sides
    from sceneql.mesh.cubes.levels import Level


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
    inner: defaultdict[int, dict[int, list[int]]] = defaultdict(dict)
    for triangle, turn, path in zip(sides.triangles.tolist(), sides.turns.tolist(), paths.tolist(), strict=True):
        inner[triangle][turn] = [vertex + offset for vertex in path[1:] if vertex != path[-1]]
    fans: list[tuple[int, int, int]] = []
    middles: list[list[int]] = []
    fresh = offset + len(fine.places)
    for triangle, corners in zip(bordering.tolist(), same[coarse.triangles[bordering]].tolist(), strict=True):
        found = inner[triangle]
        ring = [vertex for turn in range(3) for vertex in (corners[turn], *found.get(turn, ()))]
        if len(found) == 1:
            (turn,) = found
            apex = corners[(turn + 2) % 3]
            at = ring.index(apex)
            ring = ring[at + 1 :] + ring[:at]
            fans += [(a, b, apex) for a, b in pairwise(ring)]
        else:
            apex = fresh + len(middles)
            middles.append(ring)
            fans += [(a, b, apex) for a, b in zip(ring, [*ring[1:], ring[0]], strict=True)]
    places, normals = np.concatenate([coarse.places, fine.places]), np.concatenate([coarse.normals, fine.normals])
    means = np.array([places[ring].mean(axis=0) for ring in middles]).reshape(-1, 3)
    reach = [np.linalg.norm(places[ring] - mean, axis=1).max() for ring, mean in zip(middles, means, strict=True)]
    ways = np.array([normals[ring].sum(axis=0) for ring in middles]).reshape(-1, 3)
    own, slopes = _on_sheets(tape, means, ways, np.array(reach))
    triangles = np.concatenate(
        [same[coarse.triangles[plain]], np.array(fans, dtype=np.int64).reshape(-1, 3), fine.triangles + offset]
    )
    places, normals = np.concatenate([places, own]), np.concatenate([normals, slopes])
    used = np.zeros(len(places), dtype=bool)
    used[triangles] = True
    triangles = (np.cumsum(used) - 1)[triangles].astype(np.int32)
    seams = np.arange(plain.sum(), len(triangles) - len(fine.triangles))
    return turned_outward(tape, Polygons(places[used], triangles, normals[used]), seams)


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
