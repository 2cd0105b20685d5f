"""Sharp edges (creases) and corners of an object, kept by the tetrahedra that fill it. Imports numpy.

Isosurface stuffing puts outer vertices on the surface where the lattice crosses it, so tetrahedra cut off the object's
sharp edges. Here outer vertices near them are moved: first the nearest one to each corner, a point where three surfaces
meet, then others to creases, where two meet. Tangent planes at neighboring vertices give a first estimate, as in dual
contouring (Ju, Losasso, Schaefer & Warren 2002), which Newton's method improves with the surfaces themselves.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.filling.tetrahedra import ENDS, boundary

if TYPE_CHECKING:
    from numpy import bool_
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

CREASE = 0.77
"""Cosine of 40 degrees: planes with a larger angle between their normals meet in a crease."""
FARTHEST = 0.6
"""Largest move of a vertex onto a crease, in spacings."""
BESIDE, REACH = 1e-3, 0.25
"""Distances, in spacings, of the four surface points around a vertex that give its normal, and of the search for them
along the normal."""
FLAT = 0.02
"""Largest curvature there, as sag relative to BESIDE: a vertex so near to a crease has no normal."""
LEAST_SHAPE, LEAST_LEFT = 0.08, 0.4
"""Least shape of a tetrahedron after a move (``shapes``): absolute, or relative to its shape before."""
LEAST_CORNER = 0.3
"""Least determinant of three unit normals whose planes meet in a corner."""
FARTHEST_CORNER, MOST_KINDS = 1.0, 5
"""Largest move of a vertex to a corner, in spacings; most different surfaces considered around a vertex."""
PASSES = 4
FIRST, LAST, LAST_MISSED, NEARER, STEPS = (0.2, 0.4, 0.8, 0.1), 1e-5, 0.01, (0.05, 0.5), 32
"""Of Newton's method onto a crease, distances beside it in spacings: first ones tried, last one, the one below which a
missed surface ends the search; then range of the factor from one step to the next, most steps."""
FARTHEST_MET = 0.5
"""Largest distance along a normal, in spacings, at which a surface beside a crease is searched."""
FARTHEST_STEP = 2.0
"""Largest Newton step, relative to the distance beside the crease."""
WITHIN = (0.3, 1.0, 3.0, 10.0)
"""Distances along a normal at which a surface is searched in turn, relative to the distance beside the crease."""
LEAST_TURNED = 0.8
"""Cosine of the largest angle by which a plane may turn in a Newton step."""

Holds = Callable[["Floats"], "NDArray[bool_]"]
Crossing = Callable[["Floats", "Floats"], "Floats"]


@dataclass(frozen=True, slots=True, eq=False)
class Kept:
    """Points after some have been moved onto creases and corners."""

    points: Floats
    """(n, 3) [m]."""
    normals: Floats
    """(n, 3, 3) unit normals of the one to three surfaces that a point is on; NaN for missing and uncertain ones."""


def creases_kept(
    points: Floats, tetrahedra: Ints, spacing: float, holds: Holds, crossing: Crossing, smooth: bool = False
) -> Kept:
    """The points (n, 3), those near creases and corners moved onto them where tetrahedra keep their shape.

    ``holds`` and ``crossing`` as of ``stuffed``; ``smooth``: the object is known to have no creases, which a search
    finds out at three times the cost of all else.
    """
    faces = boundary(tetrahedra).astype(np.int64)
    sides = np.unique(np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0)
    normals = _normals(points, faces, spacing, holds, crossing)
    points, free = points.copy(), np.isin(np.arange(len(points)), faces)
    planes = np.full((len(points), 3, 3), np.nan)
    planes[:, 0] = normals
    if smooth:
        return Kept(points, planes)
    cells, starts = around(tetrahedra, len(points))
    outer = np.unique(faces)
    corners, turned = _corners(points, sides, normals, spacing, holds, crossing)
    taken: set[int] = set()
    for which, corner in _nearest(points[outer], corners, spacing):
        vertex = outer[which]
        own = tetrahedra[cells[starts[vertex] : starts[vertex + 1]]]
        if free[vertex] and corner not in taken and keeps_shape(points, own, vertex, corners[corner]):
            points[vertex], planes[vertex], free[vertex] = corners[corner], turned[corner], False
            taken.add(corner)
    for _ in range(PASSES):
        found = _targets(points, normals, sides[free[sides].all(axis=1)])
        if not len(found):
            break
        pairs = found[:, 1:]
        flat, at = normals[pairs], points[pairs]
        places = points[found[:, 0]] + onto_planes(points[found[:, 0]], at, flat)
        places = onto_crease(places, flat, convex(at, flat), spacing, holds, crossing)
        moves = np.linalg.norm(places - points[found[:, 0]], axis=1)
        moves[np.isnan(moves)] = np.inf
        before = int(free.sum())
        for k in np.argsort(moves, kind="stable"):
            vertex = found[k, 0]
            if not moves[k] <= FARTHEST * spacing:
                break
            if not free[found[k]].all():
                continue
            own = tetrahedra[cells[starts[vertex] : starts[vertex + 1]]]
            if keeps_shape(points, own, vertex, places[k]):
                points[vertex], free[vertex] = places[k], False
                planes[vertex, :2] = flat[k]
        if free.sum() == before:
            break
    return Kept(points, planes)


def _corners(
    points: Floats, sides: Any, normals: Floats, spacing: float, holds: Holds, crossing: Crossing
) -> tuple[Floats, Floats]:
    """Corners (c, 3) [m] where three surfaces near an outer point meet, and normals (c, 3, 3) of these nearby."""
    threes = [three for kinds in _kinds(points, sides, normals) for three in combinations(sorted(kinds), 3)]
    some = np.array(sorted(set(threes)), dtype=np.int64).reshape(-1, 3)
    some = some[np.abs(np.linalg.det(normals[some])) > LEAST_CORNER]
    planes, at = normals[some], points[some]
    heights = np.einsum("mki,mki->mk", planes, at)
    places = np.linalg.solve(planes, heights[..., None])[..., 0]
    close = np.linalg.norm(places - at.mean(axis=1), axis=1) < 2.0 * spacing
    planes, at, places = planes[close], at[close], places[close]
    middles, ways = at.mean(axis=1), convex(at, planes)
    flat, places = places, onto_crease(places, planes, ways, spacing, holds, crossing)
    # Tangent planes of strongly curved surfaces meet too far outside: try again from halfway to their points.
    left = np.isnan(places[:, 0])
    nearer = 0.5 * (flat + middles)[left]
    places[left] = onto_crease(nearer, planes[left], ways[left], spacing, holds, crossing)
    met = np.linalg.norm(places - middles, axis=1) < 2.0 * spacing
    found: list[int] = []
    for k in np.flatnonzero(met).tolist():
        if all(np.linalg.norm(places[k] - places[other]) > BESIDE * spacing for other in found):
            found.append(k)
    return places[found], planes[found]


def _kinds(points: Floats, sides: Any, normals: Floats) -> list[list[int]]:
    """Of each outer point the nearest ones, up to two edges away, whose tangent planes differ, at most MOST_KINDS."""
    from scipy.sparse import csr_array

    outer, ends = np.unique(sides, return_inverse=True)
    one, two = ends.reshape(-1, 2).T
    both = np.concatenate([one, two]), np.concatenate([two, one])
    beside = csr_array((np.ones(2 * len(one)), both), shape=(len(outer),) * 2)
    near = (beside + beside @ beside).tocoo()
    of, other = outer[near.row], outer[near.col]
    known = ~np.isnan(normals[other, 0])
    of, other = of[known], other[known]
    order = np.lexsort((other, np.linalg.norm(points[other] - points[of], axis=1), of))
    of, other = of[order], other[order]
    first = np.flatnonzero(np.diff(of, prepend=-1))
    counts = np.diff(first, append=len(of))
    kinds = np.full((len(first), MOST_KINDS), -1, dtype=np.int64)
    found = np.zeros(len(first), dtype=np.int64)
    for k in range(int(counts.max(initial=0))):
        rows = np.flatnonzero((counts > k) & (found < MOST_KINDS))
        one = other[first[rows] + k]
        alike = np.einsum("nki,ni->nk", normals[kinds[rows]], normals[one]) >= CREASE
        rows, one = (part[~(alike & (kinds[rows] >= 0)).any(axis=1)] for part in (rows, one))
        kinds[rows, found[rows]] = one
        found[rows] += 1
    return [row[:count] for row, count in zip(kinds.tolist(), found.tolist(), strict=True) if count > 2]


def _nearest(points: Floats, corners: Floats, spacing: float) -> list[tuple[int, int]]:
    """Pairs (point, corner) within FARTHEST_CORNER of each other, the nearest first."""
    away = np.linalg.norm(points[:, None] - corners[None], axis=2)
    pairs = np.argwhere(away <= FARTHEST_CORNER * spacing)
    order = np.argsort(away[tuple(pairs.T)], kind="stable")
    return [(int(a), int(b)) for a, b in pairs[order]]


def _normals(points: Floats, faces: Any, spacing: float, holds: Holds, crossing: Crossing) -> Floats:
    """Outward unit normals (n, 3) of the object at vertices of outer faces (f, 3); NaN for others, and near creases."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    normals = np.zeros_like(points)
    for k in range(3):
        np.add.at(normals, faces[:, k], across)
    outer = np.unique(faces)
    way = normals[outer] / np.maximum(np.linalg.norm(normals[outer], axis=1, keepdims=True), 1e-300)
    one = np.cross(way, np.eye(3)[np.argmin(np.abs(way), axis=1)])
    one /= np.maximum(np.linalg.norm(one, axis=1, keepdims=True), 1e-300)
    two = np.cross(way, one)
    met, sure = [], np.ones(len(outer), dtype=bool)
    for aside in (one, two, -one, -two):
        middle = points[outer] + BESIDE * spacing * aside
        inner, beyond = middle - REACH * spacing * way, middle + REACH * spacing * way
        crosses = np.asarray(holds(inner)) & ~np.asarray(holds(beyond))
        share = np.zeros(len(outer))
        if crosses.any():
            share[crosses] = crossing(inner[crosses], beyond[crosses])
        met.append(inner + share[:, None] * (beyond - inner))
        sure &= crosses
    for a, b in ((0, 2), (1, 3)):
        bow = np.einsum("ni,ni->n", met[a] + met[b] - 2.0 * points[outer], way)
        sure &= np.abs(bow) < FLAT * BESIDE * spacing
    found = np.cross(met[2] - met[0], met[3] - met[1])
    length = np.linalg.norm(found, axis=1, keepdims=True)
    planes = np.full_like(points, np.nan)
    planes[outer[sure]] = (found / np.maximum(length, 1e-300))[sure]
    return planes


def around(tetrahedra: Ints, count: int) -> tuple[Any, Any]:
    """Numbers of the tetrahedra around each of ``count`` points, and the starts of each point's (CSR)."""
    flat = tetrahedra.ravel()
    starts = np.concatenate([[0], np.cumsum(np.bincount(flat, minlength=count))])
    return np.argsort(flat, kind="stable") // 4, starts


def _targets(points: Floats, normals: Floats, sides: Any) -> Any:
    """(m, 3) numbers of a point that may move onto a crease, and of the two points whose tangent planes meet there.

    The two are the point itself and a neighbor, for the nearest crease; for a point without a normal, which is already
    almost on a crease, two of its neighbors. ``sides`` (s, 2): outer edges.
    """
    beside: dict[int, list[int]] = {}
    for a, b in sides.tolist():
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    found = []
    bent = np.isnan(normals[:, 0])
    bent[sides[~(np.einsum("si,si->s", normals[sides[:, 0]], normals[sides[:, 1]]) >= CREASE)]] = True
    for vertex, ring in beside.items():
        if not bent[vertex]:
            continue
        known = [other for other in ring if not np.isnan(normals[other, 0])]
        pairs = list(combinations(known, 2)) if np.isnan(normals[vertex, 0]) else [(vertex, other) for other in known]
        some = np.array(pairs, dtype=np.int64).reshape(-1, 2)
        some = some[np.einsum("si,si->s", normals[some[:, 0]], normals[some[:, 1]]) < CREASE]
        if len(some):
            moves = onto_planes(np.repeat(points[vertex][None], len(some), axis=0), points[some], normals[some])
            found.append((vertex, *some[np.argmin(np.linalg.norm(moves, axis=1))]))
    return np.array(found, dtype=np.int64).reshape(-1, 3)


def onto_planes(points: Floats, through: Floats, normals: Floats) -> Floats:
    """Shortest moves (m, 3) of points (m, 3) onto k planes each, through places (m, k, 3) with normals (m, k, 3)."""
    heights = np.einsum("mki,mki->mk", through - points[:, None], normals)
    moves: Floats = np.einsum("mik,mk->mi", np.linalg.pinv(normals), heights)
    return moves


def convex(at: Floats, planes: Floats) -> Floats:
    """Unit directions (m, k, 3) from the intersection of k planes along each plane, to the object's side of it.

    Planes through places ``at`` (m, k, 3) with normals (m, k, 3); whether an edge is convex or concave is decided by
    the places.
    """
    sides = np.zeros_like(planes)
    for i in range(planes.shape[1]):
        for j in range(planes.shape[1]):
            if i != j:
                beyond = np.einsum("mi,mi->m", at[:, j] - at[:, i], planes[:, i] - planes[:, j])
                flat = planes[:, j] - np.einsum("mi,mi->m", planes[:, j], planes[:, i])[:, None] * planes[:, i]
                sides[:, i] += np.where(beyond < 0.0, -1.0, 1.0)[:, None] * flat
    sides /= np.maximum(np.linalg.norm(sides, axis=2, keepdims=True), 1e-300)
    return sides


def onto_crease(
    places: Floats, normals: Floats, sides: Floats, spacing: float, holds: Holds, crossing: Crossing
) -> Floats:
    """Places (m, 3) moved onto creases or corners, where k surfaces with normals near (m, k, 3) meet; NaN if not found.

    ``sides`` (m, k, 3): unit directions from the crease into each surface. Newton's method on planes through three
    points of each surface beside the crease, which approach it as the method converges.
    """
    found = np.full_like(places, np.nan)
    for first in FIRST:
        left = np.isnan(found[:, 0])
        if left.any():
            found[left] = _by_newton(places[left], normals[left], sides[left], first, spacing, holds, crossing)
    return found


def _by_newton(
    places: Floats, normals: Floats, sides: Floats, first: float, spacing: float, holds: Holds, crossing: Crossing
) -> Floats:
    """As `onto_crease`, with surface points at first ``first`` spacings beside the crease."""
    found, normals, sides = places.copy(), normals.copy(), sides.copy()
    beside = np.full(len(places), first)
    whole = np.ones(len(places), dtype=bool)
    for _ in range(STEPS):
        some = np.flatnonzero(whole & (beside > 0.0))
        if not len(some):
            break
        planes, hits, crosses = _beside(found[some], normals[some], sides[some], beside[some], spacing, holds, crossing)
        heights = np.einsum("mki,mki->mk", planes, hits - found[some][:, None])
        move = np.einsum("mik,mk->mi", np.linalg.pinv(planes), heights)
        far = np.linalg.norm(move, axis=1) / (beside[some] * spacing)
        # A missed surface, or too long a step: halve the distance beside the crease and try again.
        missed = ~crosses | (far > FARTHEST_STEP)
        beside[some[missed]] *= 0.5
        whole[some[missed & (beside[some] < LAST_MISSED)]] = False
        fine = some[~missed]
        found[fine] += move[~missed]
        normals[fine] = planes[~missed]
        sides[fine] = _tangent(sides[fine], normals[fine])
        last = beside[fine] <= LAST
        beside[fine] = np.where(last, 0.0, np.maximum(LAST, beside[fine] * np.clip(far[~missed], *NEARER)))
    whole &= beside == 0.0
    turned = np.einsum("mki,mli->mkl", normals, normals)
    turned[:, *np.diag_indices(normals.shape[1])] = -1.0
    whole &= (turned < CREASE).all(axis=(1, 2))
    found[~whole] = np.nan
    return found


def _beside(
    places: Floats, normals: Floats, sides: Floats, beside: Floats, spacing: float, holds: Holds, crossing: Crossing
) -> tuple[Floats, Floats, Any]:
    """Planes of surfaces beside creases: normals (m, k, 3), points (m, k, 3) on them, (m,) whether all were found."""
    apart = (beside * spacing)[:, None, None]
    across = np.cross(normals, sides)
    met = []
    crosses = np.ones(len(places), dtype=bool)
    for along, aside in ((0.6, 0.0), (1.0, -0.4), (1.0, 0.4)):
        start = (places[:, None] + apart * (along * sides + aside * across)).reshape(-1, 3)
        hits, open_ = start.copy(), np.ones(len(start), dtype=bool)
        for within in WITHIN:
            reach = (np.minimum(FARTHEST_MET, within * beside)[:, None, None] * spacing * normals).reshape(-1, 3)
            cuts = open_.copy()
            cuts[open_] = np.asarray(holds((start - reach)[open_])) & ~np.asarray(holds((start + reach)[open_]))
            if cuts.any():
                inner, outer = (start - reach)[cuts], (start + reach)[cuts]
                hits[cuts] = inner + crossing(inner, outer)[:, None] * (outer - inner)
            open_ &= ~cuts
            if not open_.any():
                break
        crosses &= ~open_.reshape(normals.shape[:2]).any(axis=1)
        met.append(hits.reshape(normals.shape))
    planes = np.cross(met[2] - met[0], met[1] - met[0])
    planes /= np.maximum(np.linalg.norm(planes, axis=2, keepdims=True), 1e-300)
    planes *= np.sign(np.einsum("mki,mki->mk", planes, normals))[..., None]
    crosses &= (np.einsum("mki,mki->mk", planes, normals) > LEAST_TURNED).all(axis=1)
    return planes, met[0], crosses


def _tangent(sides: Floats, normals: Floats) -> Floats:
    """Unit vectors (..., 3): directions projected onto the tangent planes of normals (..., 3)."""
    found: Floats = sides - np.sum(sides * normals, axis=-1, keepdims=True) * normals
    found /= np.maximum(np.linalg.norm(found, axis=-1, keepdims=True), 1e-300)
    return found


def keeps_shape(points: Floats, own: Ints, vertex: int, place: Floats) -> bool:
    """Whether the tetrahedra ``own`` (t, 4) around a vertex keep their shape when it moves to ``place`` (3,)."""
    before = points[own]
    after = np.where((own == vertex)[:, :, None], place, before)
    old, new = shapes(before), shapes(after)
    return bool((new >= np.minimum(LEAST_SHAPE, LEAST_LEFT * old)).all())


def shapes(corners: Floats) -> Floats:
    """Shapes (t,) of tetrahedra (t, 4, 3): volume over a regular one's of the same rms edge; negative if inverted."""
    a, b, c, d = (corners[:, k] for k in range(4))
    held = np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a)) / 6.0
    i, j = np.array(ENDS).T
    side = np.sqrt(np.mean(np.sum((corners[:, i] - corners[:, j]) ** 2, axis=2), axis=1))
    found: Floats = held * 6.0 * np.sqrt(2.0) / np.maximum(side, 1e-300) ** 3
    return found
