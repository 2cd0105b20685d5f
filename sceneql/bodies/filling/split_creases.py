"""Repair of creases that tetrahedra still cut off: notches are filled, or edges split. Imports numpy.

`creases_kept` leaves notches where no vertex could be moved onto the crease. An outer edge whose ends lie on different
surfaces cuts off a crease. If the opposite corners of its two outer triangles are both on the crease, one more
tetrahedron between these triangles fills the notch. Otherwise the edge is split at a new vertex on the crease, and each
tetrahedron around the edge becomes two.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.filling.kept_creases import (
    CREASE,
    Crossing,
    Holds,
    Kept,
    around,
    convex,
    onto_crease,
    onto_planes,
    shapes,
)
from sceneql.bodies.filling.tetrahedra import boundary, edges

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints

PASSES = 12
FARTHEST_NEW = 1.5
"""Largest distance of a new vertex from the midpoint of its edge, in spacings."""
NOWHERE = [np.nan] * 3
LEAST_SHAPES = (0.08, 0.06, 0.04)
"""Least shapes (kept_creases.shapes) of tetrahedra that a split makes: the next one is used where the last allows no
more splits."""


def creases_split(
    kept: Kept, tetrahedra: Ints, spacing: float, holds: Holds, crossing: Crossing, smooth: bool = False
) -> tuple[Floats, Ints]:
    """Points (n, 3) [m] and tetrahedra (t, 4), with new ones where creases were cut off.

    ``smooth``: the object is known to have no creases; notches between planes that turn much are filled all the same.
    """
    points, planes = kept.points, kept.normals
    cells: Any = tetrahedra.astype(np.int64)
    level = 0
    for _ in range(PASSES):
        faces = boundary(cells).astype(np.int64)
        sides = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
        sides = np.unique(sides, axis=0)
        sides, chosen = _cut_off(points, planes, sides)
        if not len(sides):
            break
        more = _filling(points, planes, cells, faces, sides, chosen)
        if len(more):
            cells = np.concatenate([cells, more])
            continue
        if smooth:
            break
        places, good = _places(points[sides], chosen, spacing, holds, crossing)
        touched = np.zeros(len(cells), dtype=bool)
        new: list[Any] = []
        on: list[Any] = []
        made: list[Any] = []
        gone: list[Any] = []
        which, starts = around(cells, len(points))
        order = np.argsort(np.linalg.norm(places - points[sides].mean(axis=1), axis=1), kind="stable")
        for k in order[good[order]]:
            a, b = sides[k]
            own = which[starts[a] : starts[a + 1]]
            own = own[(cells[own] == b).any(axis=1)]
            if touched[own].any():
                continue
            number = len(points) + len(new)
            one, two = (np.where(cells[own] == end, number, cells[own]) for end in (a, b))
            both = np.concatenate([one, two])
            at = np.where((both == number)[:, :, None], places[k], points[np.minimum(both, len(points) - 1)])
            if shapes(at).min() < LEAST_SHAPES[level]:
                continue
            touched[own] = True
            new.append(places[k])
            on.append([*chosen[k], NOWHERE])
            gone.append(own)
            made.append(both)
        if not new:
            level += 1
            if level == len(LEAST_SHAPES):
                break
            continue
        points = np.concatenate([points, new])
        planes = np.concatenate([planes, on])
        cells = np.concatenate([np.delete(cells, np.concatenate(gone), axis=0), *made])
    return points, cells.astype(tetrahedra.dtype)


def _cut_off(points: Floats, planes: Floats, sides: Any) -> tuple[Any, Floats]:
    """Outer edges (s, 2) whose ends have no surface in common, and normals (s, 2, 3) of the two surfaces, one of each
    end, that meet nearest to the edge."""
    cosines = np.einsum("sai,sbi->sab", planes[sides[:, 0]], planes[sides[:, 1]])
    known = ~np.isnan(cosines)
    which = np.flatnonzero(known.any(axis=(1, 2)) & ~(known & (cosines >= CREASE)).any(axis=(1, 2)))
    chosen = np.zeros((len(which), 2, 3))
    for k, side in enumerate(which):
        ends, least = points[sides[side]], np.inf
        for a, b in np.argwhere(known[side]):
            pair = np.stack([planes[sides[side, 0], a], planes[sides[side, 1], b]])
            move = float(np.linalg.norm(onto_planes(ends.mean(axis=0)[None], ends[None], pair[None])))
            if move < least:
                least, chosen[k] = move, pair
    return sides[which], chosen


def _filling(points: Floats, planes: Floats, cells: Any, faces: Any, sides: Any, chosen: Floats) -> Any:
    """Tetrahedra (m, 4) that fill notches, each between the two outer faces at one of the edges ``sides`` (s, 2).

    ``chosen`` (s, 2, 3): normals of the surfaces that meet in the crease that the edge cuts off.
    """
    size = np.array([len(points), 1])
    ends = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1) @ size
    order = np.argsort(ends, kind="stable")
    first, last = (np.searchsorted(ends[order], sides @ size, side) for side in ("left", "right"))
    two = last - first == 2
    one, other = (order[first[two] + k] for k in (0, 1))
    across = np.concatenate([faces[:, 2], faces[:, 0], faces[:, 1]])
    tips = np.sort(np.stack([across[one], across[other]], axis=1), axis=1)
    new = ~np.isin(tips @ size, edges(cells)[0] @ size)
    found: list[list[int]] = []
    taken: set[tuple[int, int]] = set()
    for k in np.flatnonzero(new).tolist():
        cell = [*faces[one[k] % len(faces)].tolist(), int(across[other[k]])]
        own = set(combinations(sorted(cell), 2))
        on = all(_is_on(planes[tip], chosen[two][k]) for tip in tips[k])
        if on and not own & taken and shapes(points[[cell]])[0] >= LEAST_SHAPES[0]:
            found.append(cell)
            taken |= own
    return np.array(found, dtype=np.int64).reshape(-1, 4)


def _is_on(planes: Floats, normals: Floats) -> bool:
    """Whether a point on surfaces with normals ``planes`` (3, 3) is on all k surfaces with normals near (k, 3)."""
    with np.errstate(invalid="ignore"):
        return bool((planes @ normals.T >= CREASE).any(axis=0).all())


def _places(ends: Floats, planes: Floats, spacing: float, holds: Holds, crossing: Crossing) -> tuple[Floats, Any]:
    """Points (s, 3) on the creases that edges with ends (s, 2, 3) cut off, and (s,) whether each is near its edge."""
    middle = ends.mean(axis=1)
    flat = middle + onto_planes(middle, ends, planes)
    places = onto_crease(flat, planes, convex(ends, planes), spacing, holds, crossing)
    return places, np.linalg.norm(places - middle, axis=1) <= FARTHEST_NEW * spacing
