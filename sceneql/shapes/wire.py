"""Wires: chains of straight pieces as fields, and helices swept to meshes."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

from sceneql.shapes.solid import length, less

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints
    from sceneql.kinds import FieldBuilder

SIDES = 10
"""Sides of the polygon that approximates the wire's round section."""


def chain(build: FieldBuilder, path: Floats, radius: float, x: int, y: int, z: int) -> int:
    """Register of the signed distance to the capsules (n - 1) between the points (n, 3) of a path."""
    total = None
    for a, b in pairwise(path):
        value = less(build, _distance(build, a, b, (x, y, z)), radius)
        total = value if total is None else build.op("min", total, value)
    if total is None:
        raise ValueError("a path has at least two points")
    return total


def _distance(build: FieldBuilder, a: Floats, b: Floats, point: tuple[int, int, int]) -> int:
    """Register of the distance to the segment from a to b: to its nearest point a + q (b - a), 0 <= q <= 1."""
    away = [less(build, register, float(c)) for register, c in zip(point, a, strict=True)]
    along = b - a
    squared = float(along @ along)
    if squared > 0:
        terms = [build.op("mul", w, build.constant(float(c) / squared)) for w, c in zip(away, along, strict=True)]
        q = build.op("add", build.op("add", terms[0], terms[1]), terms[2])
        q = build.op("min", build.op("max", q, build.constant(0.0)), build.constant(1.0))
        away = [
            build.op("sub", w, build.op("mul", q, build.constant(float(c)))) for w, c in zip(away, along, strict=True)
        ]
    return length(build, *away)


def helix(start: Any, end: Any, radius: float, turns: float, lead: float, pieces: int) -> tuple[Floats, Floats]:
    """Middle line (n, 3) of a coil spring from start to end (3,), and vectors (n, 3) across it that turn with it.

    ``lead``: share of the length that is straight at either end; ``pieces``: segments of a turn. The radius grows from
    0 and falls to 0 smoothly within half a turn.
    """
    import numpy as np

    start, end = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    along = end - start
    far = float(np.linalg.norm(along))
    along = along / far if far > 0 else np.array([0.0, 1.0, 0.0])
    across = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    across /= np.linalg.norm(across)
    other = np.cross(along, across)
    s = np.linspace(0.0, 1.0, int(np.ceil(turns * pieces)) + 1)
    angle = 2 * np.pi * turns * s
    opening = np.clip(2 * turns * np.minimum(s, 1 - s), 0.0, 1.0)
    wide = radius * opening * opening * (3 - 2 * opening)
    outward = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * other
    middle = start + far * (lead + (1 - 2 * lead) * s)[:, None] * along + wide[:, None] * outward
    if lead > 0 and far > 0:
        middle = np.concatenate([[start], middle, [end]])
        outward = np.concatenate([outward[:1], outward, outward[-1:]])
    else:
        middle[0], middle[-1] = start, end
    return middle, outward


def swept(path: Floats, outward: Floats, radius: float) -> tuple[Floats, Floats, Ints]:
    """Vertices, unit normals and triangles of a round wire along a path (n, 3), closed by flat ends.

    ``outward`` (n, 3): vectors never parallel to the path, which vary smoothly along it.
    """
    import numpy as np

    tangent = np.gradient(path, axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-300)
    first = outward - np.sum(outward * tangent, axis=1, keepdims=True) * tangent
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-300)
    second = np.cross(tangent, first)
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    normals = np.cos(angle)[:, None] * first[:, None] + np.sin(angle)[:, None] * second[:, None]
    vertices = path[:, None] + radius * normals
    n = len(path)
    ring, side = np.meshgrid(np.arange(n - 1) * SIDES, np.arange(SIDES), indexing="ij")
    a, b = ring + side, ring + (side + 1) % SIDES
    quads = np.stack([a, b, b + SIDES, a, b + SIDES, a + SIDES], axis=-1).reshape(-1, 3)
    around = np.arange(1, SIDES - 1)
    fan = np.column_stack([np.zeros_like(around), around, around + 1])
    caps = np.concatenate([fan[:, ::-1] + n * SIDES, fan + (n + 1) * SIDES])
    ends = [np.tile(-tangent[0], (SIDES, 1)), np.tile(tangent[-1], (SIDES, 1))]
    return (
        np.concatenate([vertices.reshape(-1, 3), vertices[0], vertices[-1]]),
        np.concatenate([normals.reshape(-1, 3), *ends]),
        np.concatenate([quads, caps]).astype(np.int32),
    )
