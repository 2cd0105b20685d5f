"""Quality of triangle meshes: measures, Delaunay flips, and smoothing of vertices. Imports numpy."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.galerkin.plane_stuffing import sides_of

if TYPE_CHECKING:
    from sceneql.frame import Floats

PASSES, IDLE = 60, 4
"""Largest number of passes over the vertices, and number of successive passes with few moves that ends them."""
FEW = 0.05
"""Fraction of the tried vertices that counts as few."""
GOOD = 0.9
"""Quality above which triangles are left unchanged."""
ENOUGH = 1e-3
"""Least gain of quality for which a vertex moves."""
STEPS = (1.0, 0.5, 0.25)
"""Fractions of the way to the target that are tried."""

Onto = Callable[["Floats", "Floats", "Floats"], "Floats"]
"""Function: points (k, 2) on the outline from given points (k, 2), unit directions (k, 2) and largest distances (k,)
[m]; NaN for points with none."""


def qualities(points: Floats, triangles: Any) -> Floats:
    """Qualities (t,): 4 sqrt(3) area / sum of squared sides; 1 if equilateral, negative if inverted."""
    a, b, c = (points[triangles[..., k]] for k in range(3))
    u, v, w = b - a, c - a, c - b
    area = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    squares = (u**2).sum(axis=-1) + (v**2).sum(axis=-1) + (w**2).sum(axis=-1)
    found: Floats = 2.0 * 3.0**0.5 * area / np.maximum(squares, 1e-300)
    return found


def angles(points: Floats, triangles: Any) -> tuple[float, float]:
    """Least and largest angle [rad] of triangles."""
    least, largest = np.pi, 0.0
    for k in range(3):
        angle = _angle(*(points[triangles[:, (k + m) % 3]] for m in range(3)))
        least, largest = min(least, float(angle.min())), max(largest, float(angle.max()))
    return least, largest


def outer_sides(triangles: Any) -> tuple[Any, Any]:
    """Sides that belong to one triangle alone: (s, 2) triangle and opposite corner; (s, 2) ends, counterclockwise
    around the inside."""
    _, which = sides_of(triangles)
    lone = np.bincount(which.ravel())[which] == 1
    own = np.argwhere(lone)
    turned = np.array([[1, 2], [2, 0], [0, 1]])[own[:, 1]]
    return own, np.take_along_axis(triangles[own[:, 0]], turned, axis=1)


def delaunay(points: Floats, triangles: Any) -> Any:
    """Triangles with inner sides flipped until all are locally Delaunay (Lawson 1977); sides of the boundary stay.

    The matrix of diffusion then has no positive entry between the vertices of an inner side.
    """
    triangles = triangles.copy()
    for _ in range(PASSES):
        _, which = sides_of(triangles)
        order = np.argsort(which.ravel(), kind="stable")
        twice = np.bincount(which.ravel())[which.ravel()[order]] == 2
        pairs = order[twice].reshape(-1, 2)
        (t, u), (i, j) = (pairs // 3).T, (pairs % 3).T
        a, d = triangles[t, i], triangles[u, j]
        b, c = triangles[t, (i + 1) % 3], triangles[t, (i + 2) % 3]
        one, two = (_angle(points[end], points[b], points[c]) for end in (a, d))
        after = np.stack([np.stack([a, b, d], axis=1), np.stack([a, d, c], axis=1)], axis=1)
        wrong = one + two > np.pi + 1e-9
        wrong &= (qualities(points, after) > 0.0).all(axis=1)
        found = np.flatnonzero(wrong)
        if not len(found):
            break
        # Of flips that share a triangle, one is done at a time: that with the largest sum of angles.
        found = found[np.argsort(-(one + two)[found], kind="stable")]
        rank = np.full(len(triangles), len(pairs))
        for own in (t, u):
            np.minimum.at(rank, own[found], np.arange(len(found)))
        first = np.arange(len(found))
        chosen = found[(rank[t[found]] == first) & (rank[u[found]] == first)]
        triangles[t[chosen]], triangles[u[chosen]] = after[chosen, 0], after[chosen, 1]
    return triangles


def _angle(corner: Floats, one: Floats, other: Floats) -> Floats:
    """Angles (k,) [rad] at corners (k, 2) between the directions to two points."""
    u, v = one - corner, other - corner
    found: Floats = np.arctan2(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]), (u * v).sum(axis=1))
    return found


def smoothed(points: Floats, triangles: Any, fixed: Any, onto: Onto) -> Floats:
    """Points (n, 2) after smoothing: a vertex of a poor triangle moves if the worst quality around it improves.

    Vertices of the outline move along it, except ``fixed`` (k,) ones. Neighbors never move in the same pass.
    """
    points = points.copy()
    ends = sides_of(triangles)[0]
    count = len(points)
    both = np.concatenate([ends, ends[:, ::-1]])
    degree = np.bincount(both[:, 0], minlength=count)
    _, outer = outer_sides(triangles)
    edge = np.zeros(count, dtype=bool)
    edge[outer] = True
    held = np.zeros(count, dtype=bool)
    held[fixed] = True
    held |= edge & (np.bincount(outer.ravel(), minlength=count) != 2)
    after, before = np.arange(count), np.arange(count)
    after[outer[:, 0]], before[outer[:, 1]] = outer[:, 1], outer[:, 0]
    rank = np.random.Generator(np.random.Philox(5)).permutation(count)
    corner, idle = triangles.ravel().astype(np.int64), 0
    for _ in range(PASSES):
        quality = qualities(points, triangles)
        worst = np.full(count, 2.0)
        np.minimum.at(worst, corner, np.repeat(quality, 3))
        wanting = (worst < GOOD) & ~held
        rank = np.roll(rank, 1)
        top = np.full(count, -1)
        np.maximum.at(top, both[:, 0], np.where(wanting[both[:, 1]], rank[both[:, 1]], -1))
        moving = np.flatnonzero(wanting & (rank > top))
        if not len(moving):
            if not wanting.any():
                break
            continue
        sums = np.zeros((count, 2))
        np.add.at(sums, both[:, 0], points[both[:, 1]])
        target = sums[moving] / degree[moving][:, None]
        here = edge[moving]
        left, right = points[before[moving[here]]], points[after[moving[here]]]
        way = right - left
        length = np.linalg.norm(way, axis=1)
        normal = np.stack([way[:, 1], -way[:, 0]], axis=1) / np.maximum(length, 1e-300)[:, None]
        target[here] = 0.5 * (left + right)
        start, done = points[moving].copy(), np.zeros(len(moving), dtype=bool)
        rows = np.isin(corner, moving).reshape(-1, 3).any(axis=1)
        mine = triangles[rows]
        number = np.full(count, -1)
        number[moving] = np.arange(len(moving))
        owner = number[mine].max(axis=1)
        for step in STEPS:
            trial = start + step * (target - start)
            trial[here] = onto(trial[here], normal, 0.5 * length)
            trial = np.where(np.isfinite(trial) & ~done[:, None], trial, points[moving])
            moved = points.copy()
            moved[moving] = trial
            least = np.full(len(moving), 2.0)
            np.minimum.at(least, owner, qualities(moved, mine))
            better = ~done & (least > worst[moving] + ENOUGH)
            points[moving[better]] = trial[better]
            done |= better
        idle = 0 if done.mean() > FEW else idle + 1
        if idle == IDLE:
            break
    return points
