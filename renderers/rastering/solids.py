"""Triangle meshes of simple solids: points (n, 3), unit normals (n, 3), triangles (m, 3), counterclockwise in front."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints

    Solid = tuple[Floats, Floats, Ints]

AROUND = 96
"""Number of sides of the prism that represents a round column."""
AROUND_ROD = ((500, 48), (5_000, 24), (50_000, 12), (math.inf, 6))
"""Pairs (largest number of rods, number of sides of each)."""


@cache
def unit_ball(detail: int) -> tuple[Floats, Ints]:
    """Unit vectors (n, 3) and triangles (m, 3) of an icosahedron whose faces are divided ``detail`` times into four."""
    from trimesh.creation import icosphere

    ball = icosphere(subdivisions=detail)
    return np.asarray(ball.vertices, dtype=float), np.asarray(ball.faces, dtype=np.int32)


def ellipsoid(middle: Floats, radii: Floats) -> Solid:
    """Ellipsoid with half axes ``radii`` (3,) along the axes."""
    directions, order = unit_ball(5)
    normals = directions / radii
    return middle + directions * radii, normals / np.linalg.norm(normals, axis=1, keepdims=True), order


def faces(low: Floats, high: Floats) -> Solid:
    """Block between two corners (3,); each face has its own vertices, with its normal."""
    points: list[Floats] = []
    normals: list[Floats] = []
    order: list[list[int]] = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side, end in ((-1.0, low), (1.0, high)):
            face = np.empty((4, 3))
            face[:, axis] = end[axis]
            face[:, u] = np.array([low, high, high, low])[:, u]
            face[:, v] = np.array([low, low, high, high])[:, v]
            normal = np.zeros(3)
            normal[axis] = side
            first = 4 * len(points)
            turns = [[0, 1, 2], [0, 2, 3]] if side > 0 else [[0, 2, 1], [0, 3, 2]]
            order += [[first + k for k in turn] for turn in turns]
            points.append(face)
            normals.append(np.tile(normal, (4, 1)))
    return np.concatenate(points), np.concatenate(normals), np.array(order, dtype=np.int32)


def round_column(axis: int, middle: Floats, radii: Floats, low: float, high: float) -> Solid:
    """Column of elliptic section along an axis, from ``low`` to ``high``, with caps."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    angle = 2 * np.pi * np.arange(AROUND) / AROUND
    ring = np.tile(middle, (AROUND, 1))
    ring[:, u] += radii[u] * np.cos(angle)
    ring[:, v] += radii[v] * np.sin(angle)
    out = np.zeros((AROUND, 3))
    out[:, u], out[:, v] = np.cos(angle) / radii[u], np.sin(angle) / radii[v]
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    up = np.zeros(3)
    up[axis] = 1.0
    lower, upper = ring.copy(), ring.copy()
    lower[:, axis], upper[:, axis] = low, high
    ends = np.tile(middle, (2, 1))
    ends[:, axis] = low, high
    points = np.concatenate([lower, upper, lower, upper, ends])
    normals = np.concatenate([out, out, np.tile(-up, (AROUND, 1)), np.tile(up, (AROUND, 1)), [-up, up]])
    k, n = np.arange(AROUND), AROUND
    following = (k + 1) % n
    order = np.concatenate(
        [
            np.stack([k, following, n + following], axis=1),
            np.stack([k, n + following, n + k], axis=1),
            np.stack([2 * n + following, 2 * n + k, np.full(n, 4 * n)], axis=1),
            np.stack([3 * n + k, 3 * n + following, np.full(n, 4 * n + 1)], axis=1),
        ]
    )
    return points, normals, order.astype(np.int32)


def capsule_sides(ends: Floats, radii: Floats) -> Solid:
    """Lateral surfaces of rods between ``ends`` (n, 2, 3), without the balls at their ends."""
    n = next(sides for most, sides in AROUND_ROD if len(ends) <= most)
    along = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.where(length > 0, along / np.maximum(length, 1e-300), [0.0, 1.0, 0.0])
    helper = np.eye(3)[np.argmin(np.abs(along), axis=1)]
    u = np.cross(along, helper)
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    v = np.cross(along, u)
    angle = 2 * np.pi * np.arange(n) / n
    out = np.cos(angle)[:, None] * u[:, None] + np.sin(angle)[:, None] * v[:, None]
    points = ends[:, :, None] + (radii[:, None, None] * out)[:, None]
    k = np.arange(n)
    following = (k + 1) % n
    one = np.concatenate([np.stack([k, following, n + following], axis=1), np.stack([k, n + following, n + k], axis=1)])
    starts = 2 * n * np.arange(len(ends))
    order = (one[None] + starts[:, None, None]).reshape(-1, 3)
    normals = np.repeat(out[:, None], 2, axis=1).reshape(-1, 3)
    return points.reshape(-1, 3), normals, order.astype(np.int32)
