"""Creases and corners of an object kept in the tetrahedra that fill it. Imports numpy.

Stuffing puts the outer corners of tetrahedra on the surface, wherever the lattice cuts that, so an edge of the object
is cut off between them. Here those next to an edge move onto it: onto the line in which the planes of the surface at
the two ends of an outer edge meet, or the point of three, as in dual contouring (Ju, Losasso, Schaefer & Warren 2002).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.filling.tetrahedra import ENDS, boundary

if TYPE_CHECKING:
    from numpy import bool_
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

CREASE = 0.77
"""Cosine of the angle [40 degrees] between planes from which on their line is a crease."""
FARTHEST = 0.6
"""Spacings that a corner may move."""
BESIDE, REACH = 1e-3, 0.25
"""Spacings from a corner at which the surface is met again to know its plane, and from there along its normal."""
ON = 0.05
"""A place is on the surface where so many spacings inward lie inside and outward do not."""
LEAST_SHAPE, LEAST_LEFT = 0.06, 0.4
"""A tetrahedron keeps this shape, volume over that of the regular one of its mean side, or this part of its own."""
LEAST_CORNER = 0.3
"""Of the volume that three normals span, from which on their planes meet in a corner."""
PASSES = 4
CLOSER = (0.1, 0.02, 4e-3, 1e-3, 2e-4, 4e-5, 1e-5, 1e-5)
"""Spacings beside a crease at which its surfaces are met, pass by pass: each comes as near as to a tenth of that."""
WITHIN = 10.0
"""How many times that far, at most, they are looked for along their normals."""
STEEP = 0.33
"""Height over distance of a surface beside a crease in the last pass, from which on it is round there."""

Holds = Callable[["Floats"], "NDArray[bool_]"]
Crossing = Callable[["Floats", "Floats"], "Floats"]


@dataclass(frozen=True, slots=True, eq=False)
class Kept:
    """Points of which some have moved onto creases."""

    points: Floats
    """(n, 3)."""
    normals: Floats
    """(n, 3, 3) of the surfaces that a point is on, of which a corner has three; NaN for others, and where unsure."""


def creases_kept(points: Floats, tetrahedra: Ints, spacing: float, holds: Holds, crossing: Crossing) -> Kept:
    """The points, of which those near creases have moved onto these where no tetrahedron is spoilt by it.

    ``holds`` and ``crossing`` as of ``stuffed``.
    """
    faces = boundary(tetrahedra).astype(np.int64)
    sides = np.unique(np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0)
    normals = _normals(points, faces, spacing, holds, crossing)
    points, free = points.copy(), ~np.isnan(normals[:, 0])
    planes = np.full((len(points), 3, 3), np.nan)
    planes[:, 0] = normals
    cells, starts = around(tetrahedra, len(points))
    corners: list[Floats] = []
    for _ in range(PASSES):
        across = sides[free[sides].all(axis=1)]
        across = across[np.einsum("si,si->s", normals[across[:, 0]], normals[across[:, 1]]) < CREASE]
        if not len(across):
            break
        found = _targets(points, normals, across, spacing)
        places, ways = np.array([one[2] for one in found]), np.array([one[3] for one in found])
        there = holds(places - ON * spacing * ways) & ~holds(places + ON * spacing * ways)
        places = _met(found, points, normals, spacing, holds, crossing)
        moves = np.linalg.norm(places - points[[one[0] for one in found]], axis=1)
        ranks = np.array([len(one[1]) for one in found])
        before = int(free.sum())
        for k in np.lexsort([moves, -ranks]):
            (vertex, others, _, _), place = found[k], places[k]
            known = len(others) == 2 and any(np.linalg.norm(place - one) < BESIDE * spacing for one in corners)
            if not there[k] or not free[vertex] or not free[list(others)].all() or known:
                continue
            own = tetrahedra[cells[starts[vertex] : starts[vertex + 1]]]
            if moves[k] <= FARTHEST * spacing and _bear(points, own, vertex, place):
                points[vertex], free[vertex] = place, False
                planes[vertex, : len(others) + 1] = normals[[vertex, *others]]
                if len(others) == 2:
                    corners.append(place)
        if free.sum() == before:
            break
    return Kept(points, planes)


def _normals(points: Floats, faces: Any, spacing: float, holds: Holds, crossing: Crossing) -> Floats:
    """(n, 3) outward normals of the surface at the points of its triangles (f, 3); NaN for others, and where unsure."""
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
    for turn in (0.0, 2.0 * np.pi / 3.0, 4.0 * np.pi / 3.0):
        middle = points[outer] + BESIDE * spacing * (np.cos(turn) * one + np.sin(turn) * two)
        inner, beyond = middle - REACH * spacing * way, middle + REACH * spacing * way
        crosses = np.asarray(holds(inner)) & ~np.asarray(holds(beyond))
        share = np.zeros(len(outer))
        if crosses.any():
            share[crosses] = crossing(inner[crosses], beyond[crosses])
        met.append(inner + share[:, None] * (beyond - inner))
        sure &= crosses
    found = np.cross(met[1] - met[0], met[2] - met[0])
    length = np.linalg.norm(found, axis=1, keepdims=True)
    planes = np.full_like(points, np.nan)
    planes[outer[sure]] = (found / np.maximum(length, 1e-300))[sure]
    return planes


def around(tetrahedra: Ints, count: int) -> tuple[Any, Any]:
    """The tetrahedra around points, one after another, and where those of each of ``count`` points begin."""
    flat = tetrahedra.ravel()
    starts = np.concatenate([[0], np.cumsum(np.bincount(flat, minlength=count))])
    return np.argsort(flat, kind="stable") // 4, starts


def _targets(points: Floats, normals: Floats, across: Any, spacing: float) -> list[tuple[int, Any, Floats, Floats]]:
    """Where points may move: (point, those beyond creases whose planes it takes, place, a way outward there).

    ``across`` (s, 2): outer edges over which the surface turns.
    """
    beyond: dict[int, list[int]] = {}
    for a, b in across.tolist():
        beyond.setdefault(a, []).append(b)
        beyond.setdefault(b, []).append(a)
    found: list[tuple[int, Any, Floats, Floats]] = []
    for vertex, others in beyond.items():
        best: tuple[float, Any] = (np.inf, None)
        for other in others:
            move = onto_planes(points[vertex], points[[vertex, other]], normals[[vertex, other]])
            size = float(np.linalg.norm(move))
            if size < best[0]:
                best = size, (vertex, (other,), points[vertex] + move, _unit(normals[vertex] + normals[other]))
        if best[1] is not None:
            found.append(best[1])
        most: tuple[float, Any] = (LEAST_CORNER, None)
        for k, one in enumerate(others):
            for two in others[:k]:
                three = normals[[vertex, one, two]]
                size = abs(float(np.linalg.det(three)))
                if size > most[0] and normals[one] @ normals[two] < CREASE:
                    most = size, (one, two)
        if most[1] is not None:
            some = [vertex, *most[1]]
            place = points[vertex] + onto_planes(points[vertex], points[some], normals[some])
            found.append((vertex, most[1], place, _unit(normals[some].sum(axis=0))))
    return found


def _met(
    found: list[tuple[int, Any, Floats, Floats]],
    points: Floats,
    normals: Floats,
    spacing: float,
    holds: Holds,
    crossing: Crossing,
) -> Floats:
    """(m, 3) the places of targets, moved to where the surfaces themselves meet that their planes stand for."""
    places = np.array([one[2] for one in found])
    for rank in (2, 3):
        which = [k for k, one in enumerate(found) if len(one[1]) == rank - 1]
        if not which:
            continue
        some = np.array([[found[k][0], *found[k][1]] for k in which])
        planes, at = normals[some], points[some]
        places[which] = onto_crease(places[which], planes, convex(at, planes), spacing, holds, crossing)
    return places


def convex(at: Floats, planes: Floats) -> Floats:
    """(m, k, 3) unit directions from where planes with normals (m, k, 3) through places (m, k, 3) meet, along each.

    They point to where the object has its surface: away from the planes that lie below it, else into them.
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
    """(m, 3) places near creases, moved onto these: where surfaces of about the normals (m, k, 3) meet.

    ``sides`` (m, k, 3): unit directions from the crease into each surface. What is not met stays as it is.
    """
    found = places.copy()
    whole = np.ones(len(places), dtype=bool)
    for beside in CLOSER:
        start = found[:, None] + beside * spacing * sides
        reach = min(REACH, WITHIN * beside) * spacing
        inner, outer = start - reach * normals, start + reach * normals
        flat = inner.reshape(-1, 3), outer.reshape(-1, 3)
        crosses = np.asarray(holds(flat[0])) & ~np.asarray(holds(flat[1]))
        whole &= crosses.reshape(normals.shape[:2]).all(axis=1)
        if not whole.any():
            break
        some = np.repeat(whole, normals.shape[1])
        share = crossing(flat[0][some], flat[1][some]).reshape(-1, normals.shape[1])
        heights = (2.0 * share - 1.0) * reach
        steepest = np.abs(heights).max(axis=1) / (beside * spacing)
        found[whole] += np.einsum("mik,mk->mi", np.linalg.pinv(normals[whole]), heights)
    if whole.any():
        whole[np.flatnonzero(whole)[steepest > STEEP]] = False
    found[~whole] = places[~whole]
    return found


def onto_planes(point: Floats, through: Floats, normals: Floats) -> Floats:
    """The shortest move (3,) of a point onto planes through places (k, 3) with normals (k, 3)."""
    heights = np.einsum("ki,ki->k", through - point, normals)
    move: Floats = np.linalg.lstsq(normals, heights, rcond=None)[0]
    return move


def _unit(vector: Floats) -> Floats:
    found: Floats = vector / max(float(np.linalg.norm(vector)), 1e-300)
    return found


def _bear(points: Floats, own: Ints, vertex: int, place: Floats) -> bool:
    """Whether the tetrahedra ``own`` (t, 4) around a point keep a good shape where it moves to a place."""
    before = points[own]
    after = np.where((own == vertex)[:, :, None], place, before)
    old, new = shapes(before), shapes(after)
    return bool((new >= np.minimum(LEAST_SHAPE, LEAST_LEFT * old)).all())


def shapes(corners: Floats) -> Floats:
    """(t,) volume of tetrahedra (t, 4, 3) over that of the regular one of their mean side; below 0 where turned."""
    a, b, c, d = (corners[:, k] for k in range(4))
    held = np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a)) / 6.0
    i, j = np.array(ENDS).T
    side = np.sqrt(np.mean(np.sum((corners[:, i] - corners[:, j]) ** 2, axis=2), axis=1))
    found: Floats = held * 6.0 * np.sqrt(2.0) / np.maximum(side, 1e-300) ** 3
    return found
