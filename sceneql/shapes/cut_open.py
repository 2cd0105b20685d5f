"""Deformed solids cut open by planes: the skin clipped, and the cross sections triangulated. Imports numpy."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.frame import Mesh

if TYPE_CHECKING:
    from sceneql.frame import Floats

ON_PLANE = 1e-9
"""Height above a plane, relative to the solid's size, that points on the plane are given."""
SAME = 1e-6
"""Distance, relative to the solid's size, below which two points of an outline are merged."""
TIMES = 5
"""Rounds of triangulation, after each of which the outline's sides that are no edge of it are halved."""
INNER, APART = 1.5, 0.6
"""Spacing of the points inside an outline, and their least distance from it, in median lengths of its sides."""
ROUNDING = 1e-12

Inside = Callable[["Floats"], tuple["Floats", "Floats"]]
"""Maps deformed positions (k, 3) [m] to rest positions (k, 3) [m] and shown values (k, 1), or (k, 0) without any."""
Corners = Any
"""(m, 3, c) data of triangles' corners: deformed position (3), normal (3), rest position (3), shown value if any."""


@dataclass(frozen=True, slots=True)
class Plane:
    """A plane by a point and its unit normal; the normal points to the side that may be cut away."""

    through: Floats
    normal: Floats

    def heights(self, places: Floats) -> Floats:
        """Signed distances (...) [m] of positions (..., 3), positive on the side of the normal."""
        found: Floats = (places - self.through) @ self.normal
        return found


def cut_open(skin: Mesh, values: Floats | None, inside: Inside, planes: Sequence[Plane]) -> Iterator[tuple[Mesh, Any]]:
    """Meshes of the solid without the part that lies before all planes at once, with the values at their vertices.

    First the clipped skin, then the cross section of each plane. ``skin``: the closed skin, with normals and rest
    positions; ``values`` (v,): a quantity shown at its vertices, or None.
    """
    assert skin.normals is not None
    assert skin.rest is not None
    told = [skin.vertices, skin.normals, skin.rest, *([] if values is None else [values[:, None]])]
    whole = np.concatenate(told, axis=1)[skin.triangles]
    size = float(np.ptp(skin.vertices, axis=0).max())
    left, kept = whole, []
    for plane in planes:
        heights = _off(plane.heights(left[..., :3]), size)
        kept.append(clipped(left, heights))
        left = clipped(left, -heights)
    faces = []
    for k, plane in enumerate(planes):
        face = _face(whole[..., :3], plane, inside, size)
        for other in (*planes[:k], *planes[k + 1 :]):
            face = clipped(face, -_off(other.heights(face[..., :3]), size))
        faces.append(face)
    for corners in (np.concatenate(kept), *faces):
        if len(corners):
            flat = corners.reshape(-1, corners.shape[2])
            normals = flat[:, 3:6] / np.maximum(np.linalg.norm(flat[:, 3:6], axis=1, keepdims=True), 1e-300)
            order = np.arange(len(flat), dtype=np.int32).reshape(-1, 3)
            parts = (np.ascontiguousarray(part) for part in (flat[:, :3], normals, flat[:, 6:9]))
            vertices, normals, rest = parts
            yield (
                replace(skin, vertices=vertices, triangles=order, normals=normals, rest=rest),
                None if values is None else flat[:, 9],
            )


def _off(heights: Floats, size: float) -> Floats:
    """The heights with those nearer to 0 than ON_PLANE times the size replaced by that positive value."""
    return np.where(np.abs(heights) < ON_PLANE * size, ON_PLANE * size, heights)


def clipped(corners: Corners, heights: Floats) -> Corners:
    """Triangles (n, 3, c) of the part of triangles (m, 3, c) where the linear heights, (m, 3) at corners, are <= 0."""
    above = heights > 0.0
    count = above.sum(axis=1)
    found = [corners[count == 0]]
    for some, odd in ((count == 1, above), (count == 2, ~above)):
        turn = (np.argmax(odd[some], axis=1)[:, None] + np.arange(3)) % 3
        rows = np.flatnonzero(some)[:, None]
        p, h = corners[rows, turn], heights[rows, turn]
        one, two = (_crossing(p[:, 0], p[:, k], h[:, 0], h[:, k]) for k in (1, 2))
        if odd is above:
            found += [np.stack([one, p[:, 1], p[:, 2]], axis=1), np.stack([one, p[:, 2], two], axis=1)]
        else:
            found.append(np.stack([p[:, 0], one, two], axis=1))
    return np.concatenate(found)


def _crossing(p: Floats, q: Floats, at_p: Floats, at_q: Floats) -> Floats:
    share = (at_p / (at_p - at_q))[:, None]
    found: Floats = p + share * (q - p)
    return found


def _face(triangles: Floats, plane: Plane, inside: Inside, size: float) -> Corners:
    """Triangulated cross section (m, 3, c) of a solid by a plane; ``triangles`` (t, 3, 3) are its closed skin.

    A Delaunay triangulation of the outline and of a lattice inside it; sides of the outline that are no edge of the
    triangulation are halved until they are, at most TIMES times.
    """
    from scipy.spatial import Delaunay, cKDTree

    width = 9 + inside(plane.through[None])[1].shape[1]
    across = np.linalg.svd(plane.normal[None])[2][1:]
    if np.cross(across[0], across[1]) @ plane.normal < 0.0:
        across = across[::-1]
    sides = _outline(triangles, _off(plane.heights(triangles), size)) - plane.through
    flat = sides @ across.T
    long = np.linalg.norm(flat[:, 1] - flat[:, 0], axis=1) > SAME * size
    flat = flat[long]
    if len(flat) < 3:
        return np.empty((0, 3, width))
    step = float(np.median(np.linalg.norm(flat[:, 1] - flat[:, 0], axis=1)))
    grid = _grid(flat.reshape(-1, 2), INNER * step)
    grid = grid[_holds(flat, grid)]
    away, _ = cKDTree(flat.reshape(-1, 2)).query(grid)
    grid = grid[away > APART * step]
    outline = flat
    for _ in range(TIMES):
        points, which = _distinct(np.concatenate([outline.reshape(-1, 2), grid]), SAME * size)
        made = Delaunay(points).simplices.astype(np.int64)
        ends = np.sort(which[: 2 * len(outline)].reshape(-1, 2), axis=1)
        there = np.sort(np.concatenate([made[:, [0, 1]], made[:, [1, 2]], made[:, [2, 0]]]), axis=1)
        lost = ~np.isin(ends @ (len(points), 1), there @ (len(points), 1)) & (ends[:, 0] != ends[:, 1])
        if not lost.any():
            break
        middle = outline[lost].mean(axis=1)
        halves = [np.stack([outline[lost, 0], middle], axis=1), np.stack([middle, outline[lost, 1]], axis=1)]
        outline = np.concatenate([outline[~lost], *halves])
    made = made[_holds(flat, points[made].mean(axis=1))]
    a, b, c = (points[made[:, k]] for k in range(3))
    turned = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) < (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    made[turned] = made[turned][:, ::-1]
    places = plane.through + points @ across
    rest, values = inside(places)
    told = [places, np.broadcast_to(plane.normal, places.shape), rest, values]
    return np.concatenate(told, axis=1)[made]


def _outline(triangles: Floats, heights: Floats) -> Floats:
    """Segments (s, 2, 3) in which a plane cuts triangles (m, 3, 3); heights (m, 3) of their corners above the plane."""
    above = heights > 0.0
    count = above.sum(axis=1)
    some = (count == 1) | (count == 2)
    odd = np.where((count == 1)[:, None], above, ~above)[some]
    turn = (np.argmax(odd, axis=1)[:, None] + np.arange(3)) % 3
    rows = np.flatnonzero(some)[:, None]
    p, h = triangles[rows, turn], heights[rows, turn]
    return np.stack([_crossing(p[:, 0], p[:, k], h[:, 0], h[:, k]) for k in (1, 2)], axis=1)


def _grid(points: Floats, step: float) -> Floats:
    """Points (k, 2) of a triangular lattice with spacing ``step`` that covers the bounding box of points (n, 2)."""
    low, high = points.min(axis=0), points.max(axis=0)
    x = np.arange(low[0], high[0], step)
    y = np.arange(low[1], high[1], step * 0.75**0.5)
    across = x[None, :] + 0.5 * step * (np.arange(len(y)) % 2)[:, None]
    return np.stack([across.ravel(), np.repeat(y, len(x))], axis=1)


def _holds(outline: Floats, points: Floats) -> Any:
    """(k,) whether points (k, 2) lie inside a closed outline of sides (s, 2, 2), by the even-odd rule."""
    found = np.zeros(len(points), dtype=bool)
    for k in range(0, len(points), 4096):
        x, y = points[k : k + 4096, 0, None], points[k : k + 4096, 1, None]
        (ax, ay), (bx, by) = outline[:, 0].T, outline[:, 1].T
        spans = (ay > y) != (by > y)
        right = x < ax + (y - ay) * (bx - ax) / np.where(by == ay, ROUNDING, by - ay)
        found[k : k + 4096] = np.count_nonzero(spans & right, axis=1) % 2 == 1
    return found


def _distinct(points: Floats, apart: float) -> tuple[Floats, Any]:
    """Points (d, 2) that differ when rounded to multiples of ``apart``, and the row among them of each point (k,)."""
    _, first, which = np.unique(np.round(points / apart), axis=0, return_index=True, return_inverse=True)
    return points[first], which.ravel()


def planes_of(sections: Iterable[Any], place: Floats) -> list[Plane]:
    """Planes of `Section` records in world coordinates; ``place`` (3, 4) maps the object's coordinates to the world."""
    turn = np.linalg.inv(np.asarray(place)[:, :3]).T
    found = []
    for one in sections:
        normal = turn @ np.asarray(one.normal, dtype=float)
        through = np.asarray(place) @ (*one.through, 1.0)
        found.append(Plane(through, normal / np.linalg.norm(normal)))
    return found
