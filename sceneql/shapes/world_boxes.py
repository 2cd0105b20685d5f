"""Axis-aligned boxes of a frame's shapes in world coordinates."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from sceneql.frame import Grid, Implicit, Mesh, Mist, Points, Quadric, Segments, Shape
from sceneql.shapes.placement import inverse, mapped_box

if TYPE_CHECKING:
    from sceneql.frame import Floats


def box_of(shape: Shape) -> tuple[Floats, Floats]:
    """Low and high corner (3,) [m]; infinite for an unbounded shape, inverted (inf, -inf) for an empty one."""
    match shape:
        case Mesh(vertices=points):
            return _around(points, 0.0)
        case Points(centers=points, radii=radii):
            return _around(points, radii[:, None])
        case Segments(ends=ends, radii=radii):
            return _around(ends.reshape(-1, 3), np.repeat(radii, 2)[:, None])
        case Implicit(low=low, high=high):
            return np.array(low), np.array(high)
        case Grid(to_nodes=to_nodes, low=low, high=high):
            return mapped_box(inverse(to_nodes), low, high)
        case Mist(to_cells=to_cells, low=low, high=high):
            return mapped_box(inverse(to_cells), low, high)
        case Quadric():
            return _quadric(shape)


FINE = 32
"""Cells of the sampling lattice along each side of a field's box."""
MOST_PARTS = 64
"""Most parts of a skeleton whose field is sampled."""


def surface_box(shape: Shape) -> tuple[Floats, Floats]:
    """As ``box_of``, but of an implicit solid the box around the samples inside it, one step wider on each side.

    The box that a script gives an implicit solid may be far larger than the solid.
    """
    low, high = box_of(shape)
    found = inside_samples(shape)
    if found is None:
        return low, high
    met, step = found
    return np.maximum(low, met.min(axis=0) - step), np.minimum(high, met.max(axis=0) + step)


def inside_samples(shape: Shape) -> tuple[Floats, Floats] | None:
    """Lattice points (n, 3) [m] inside an implicit solid, among them all outermost, and the lattice's steps (3,) [m].

    A second, finer lattice is used where the points fill less than half of a side. None for other shapes, infinite
    boxes, skeletons of more than MOST_PARTS parts, and where no point lies inside.
    """
    if not isinstance(shape, Implicit) or shape.within is not None or len(shape.tape.parts) > MOST_PARTS:
        return None
    low, high = box_of(shape)
    if not np.isfinite(low).all():
        return None
    met, step = _sampled(shape, low, high)
    if len(met) == 0:
        return None
    near = np.maximum(low, met.min(axis=0) - step), np.minimum(high, met.max(axis=0) + step)
    return _sampled(shape, *near) if ((near[1] - near[0]) < 0.5 * (high - low)).any() else (met, step)


def _sampled(shape: Implicit, low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Points (n, 3) inside the solid of a lattice that fills a box, and the lattice's steps (3,) [m].

    Points between two others of their row along x are left out: none of these is outermost.
    """
    from sceneql.field.tape.tape_solid import field_values

    step = (high - low) / FINE
    axes = [low[k] + step[k] * np.arange(FINE + 1) for k in range(3)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    inside = (field_values(shape.tape, points) < 0).reshape(FINE + 1, -1)
    inside[1:-1] &= ~(inside[:-2] & inside[2:])
    return points[inside.ravel()], step


def _around(points: Floats, radii: Floats | float) -> tuple[Floats, Floats]:
    if len(points) == 0:
        return np.full(3, np.inf), np.full(3, -np.inf)
    return (points - radii).min(axis=0), (points + radii).max(axis=0)


def _quadric(shape: Quadric) -> tuple[Floats, Floats]:
    """World box of a quadric: its local box, tightened along each axis with a square term, then mapped."""
    low, high = np.array(shape.low), np.array(shape.high)
    for k in range(3):
        # Necessary: a p^2 + b p + c <= 0, with the terms of the other axes at their minima in c.
        a, b = shape.squares[k], shape.linear[k]
        others = sum(_least(shape.squares[j], shape.linear[j], low[j], high[j]) for j in range(3) if j != k)
        c = shape.constant + others
        if a > 0 and np.isfinite(c):
            root = np.sqrt(max(b * b - 4 * a * c, 0.0))
            low[k], high[k] = max(low[k], (-b - root) / (2 * a)), min(high[k], (-b + root) / (2 * a))
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        return np.full(3, -np.inf), np.full(3, np.inf)
    to_world = np.linalg.inv(np.vstack([shape.to_local, [0, 0, 0, 1]]))
    corners = np.array([[*corner, 1.0] for corner in product(*zip(low, high, strict=True))]) @ to_world.T
    if np.allclose(shape.squares, shape.squares[0]) and shape.squares[0] > 0 and not any(shape.linear):
        # A sphere in local coordinates: an ellipsoid in the world, whose box is tighter than its corners'.
        reach = np.sqrt(-shape.constant / shape.squares[0]) * np.linalg.norm(to_world[:3, :3], axis=1)
        center = to_world[:3, 3]
        return np.maximum(center - reach, corners[:, :3].min(0)), np.minimum(center + reach, corners[:, :3].max(0))
    return corners[:, :3].min(axis=0), corners[:, :3].max(axis=0)


def _least(a: float, b: float, low: float, high: float) -> float:
    """Minimum of a p^2 + b p, a >= 0, over low..high."""
    if a == 0:
        return 0.0 if b == 0 else b * (low if b > 0 else high)
    at = min(max(-b / (2 * a), low), high)
    return a * at * at + b * at
