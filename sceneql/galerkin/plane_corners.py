"""Vertices of a triangle mesh at the corners of its outline: moved there or inserted. Imports numpy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.galerkin.plane_quality import outer_sides, qualities
from sceneql.galerkin.plane_stuffing import Triangles, Values

if TYPE_CHECKING:
    from sceneql.frame import Floats

SHARP = 0.5
"""Least angle [rad] between the normals at a side's ends for which a corner is sought between them."""
BESIDE = 0.4
"""Distance from an end, relative to the side, within which this end moves to the corner."""
OFF = 1e-3
"""Largest distance of a corner from the outline, relative to the side."""
POOR = 0.02
"""Least quality of the resulting triangles."""


def slopes(values: Values, points: Floats, step: float) -> Floats:
    """Gradient (k, 2) of a level at points (k, 2), by central differences with ``step`` [m]."""
    ways = step * np.eye(2)
    found: Floats = np.stack([(values(points + way) - values(points - way)) / (2.0 * step) for way in ways], axis=1)
    return found


def corners_of(mesh: Triangles, values: Values, spacing: float) -> Floats:
    """Corners (k, 2) [m] of the outline that outer sides cut off: the tangents at a side's ends meet there."""
    _, outer = outer_sides(mesh.triangles)
    ends = mesh.points[outer]
    normal = slopes(values, ends.reshape(-1, 2), 1e-4 * spacing).reshape(-1, 2, 2)
    size = np.linalg.norm(normal, axis=2, keepdims=True)
    normal = normal / np.maximum(size, 1e-300)
    one, two = normal[:, 0], normal[:, 1]
    turn = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    bent = (np.abs(turn) > np.sin(SHARP)) | ((one * two).sum(axis=1) < 0.0)
    bent &= np.abs(turn) > 1e-3
    ends, one, two, turn, size = (part[bent] for part in (ends, one, two, turn, size))
    reach, far = (one * ends[:, 0]).sum(axis=1), (two * ends[:, 1]).sum(axis=1)
    place = np.stack([reach * two[:, 1] - far * one[:, 1], far * one[:, 0] - reach * two[:, 0]], axis=1)
    place /= turn[:, None]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    near = np.linalg.norm(place - ends.mean(axis=1), axis=1) < 1.5 * length
    off = np.abs(values(place)) / np.maximum(size[:, 0, 0], 1e-300)
    found: Floats = place[near & (off < OFF * length)]
    return found


def kept(mesh: Triangles, corners: Floats, spacing: float) -> tuple[Triangles, Any]:
    """Mesh with vertices at corners (k, 2) of its outline, and the indices of these vertices.

    A corner too sharp for the spacing is left out.
    """
    points, triangles = list(mesh.points), [tuple(three) for three in mesh.triangles.tolist()]
    fixed: dict[int, int] = {}
    _, outer = outer_sides(mesh.triangles)
    ends = mesh.points[outer]
    sides = {tuple(pair) for pair in outer.tolist()}
    around: dict[int, set[int]] = {}
    for number, three in enumerate(triangles):
        for vertex in three:
            around.setdefault(vertex, set()).add(number)
    for which, corner in enumerate(corners):
        close = np.flatnonzero((np.abs(ends - corner) < 2.0 * spacing).all(axis=2).any(axis=1))
        nearest = [tuple(outer[k].tolist()) for k in close]
        nearest += [pair for pair in sides if pair[0] >= len(mesh.points) or pair[1] >= len(mesh.points)]
        found = sorted((_apart(corner, points[a], points[b]), a, b) for a, b in nearest if (a, b) in sides)
        for (away, share), a, b in found[:3]:
            if away < spacing and _placed(points, triangles, around, sides, fixed, which, corner, (share, a, b)):
                break
    return Triangles(np.array(points), np.array(triangles, dtype=np.int32)), np.array(sorted(fixed), dtype=np.int64)


def _apart(corner: Floats, a: Floats, b: Floats) -> tuple[float, float]:
    """Distance [m] of a corner from a side, and the fraction of the side at the nearest point."""
    way = b - a
    share = float(np.clip((corner - a) @ way / max(float(way @ way), 1e-300), 0.0, 1.0))
    return float(np.linalg.norm(corner - a - share * way)), share


def _placed(
    points: list[Any], triangles: list[Any], around: Any, sides: Any, fixed: Any, which: int, corner: Any, at: Any
) -> bool:
    """Move an end of a side to a corner, or divide the side there; False if triangles became too poor."""
    share, a, b = at
    end = a if share < BESIDE else b if share > 1.0 - BESIDE else -1
    if end >= 0 and end not in fixed:
        own = np.array([triangles[k] for k in around[end]])
        moved = np.array([corner if v == end else points[v] for v in own.ravel()])
        if qualities(moved, np.arange(own.size).reshape(own.shape)).min() > POOR:
            points[end], fixed[end] = corner, which
            return True
    number = next(k for k in around[a] & around[b])
    three = triangles[number]
    c = next(v for v in three if v not in (a, b))
    new = len(points)
    halves = [(a, new, c), (new, b, c)]
    tried = np.array([points[a], points[b], points[c], corner])
    local = {a: 0, b: 1, c: 2, new: 3}
    if qualities(tried, np.array([[local[v] for v in half] for half in halves])).min() < POOR:
        return False
    points.append(corner)
    fixed[new] = which
    triangles[number] = halves[0]
    triangles.append(halves[1])
    around[b].discard(number)
    around[b].add(len(triangles) - 1)
    around[c].add(len(triangles) - 1)
    around[new] = {number, len(triangles) - 1}
    sides.discard((a, b))
    sides.update({(a, new), (new, b)})
    return True
