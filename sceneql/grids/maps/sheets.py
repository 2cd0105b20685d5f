"""Triangulated sheets on which a field is drawn, their clipping, and contour lines on them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints

POLISH = 6
"""Root finding steps for a point on a curved boundary."""

Side = Callable[["Floats"], "Floats"]
"""A clipping function: maps points (k, 3) to numbers (k,), negative on the side that is kept."""


@dataclass(frozen=True, slots=True, eq=False)
class Sheet:
    """A triangle mesh, with arrays as of frame.Mesh."""

    vertices: Floats
    """(n, 3) [m]."""
    triangles: Ints
    """(m, 3)."""
    normals: Floats | None = None
    """(n, 3) unit vertex normals, if any."""


def lattice(corner: Any, along: Any, across: Any, counts: tuple[int, int]) -> Sheet:
    """A parallelogram with a corner (3,) and two sides (3,), divided into ``counts`` steps; faces along x across."""
    n, m = counts
    s, t = np.meshgrid(np.arange(n + 1) / n, np.arange(m + 1) / m)
    vertices = np.asarray(corner, dtype=float) + s.ravel()[:, None] * along + t.ravel()[:, None] * across
    i, j = (index.ravel() for index in np.meshgrid(np.arange(n), np.arange(m)))
    a = i + (n + 1) * j
    b, c, d = a + 1, a + n + 2, a + n + 1
    even = ((i + j) % 2 == 0)[:, None]  # diagonals in turn: no direction is preferred
    first = np.where(even, np.stack([a, b, c], axis=1), np.stack([a, b, d], axis=1))
    second = np.where(even, np.stack([a, c, d], axis=1), np.stack([b, c, d], axis=1))
    return Sheet(vertices, np.concatenate([first, second]).astype(np.int32))


def joined(sheets: list[Sheet]) -> Sheet:
    """All sheets as one, with normals if every sheet has them. An empty sheet for an empty list."""
    if not sheets:
        return Sheet(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int32))
    starts = np.cumsum([0, *(len(sheet.vertices) for sheet in sheets)])
    normals = [sheet.normals for sheet in sheets if sheet.normals is not None]
    return Sheet(
        np.concatenate([sheet.vertices for sheet in sheets]),
        np.concatenate([sheet.triangles + start for sheet, start in zip(sheets, starts, strict=False)]).astype(
            np.int32
        ),
        np.concatenate(normals) if len(normals) == len(sheets) else None,
    )


def flat_normals(sheet: Sheet) -> Sheet:
    """The sheet with separate vertices for each triangle's corners, and the triangles' normals."""
    corners = sheet.vertices[sheet.triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-300)
    triangles = np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3)
    return Sheet(corners.reshape(-1, 3), triangles, np.repeat(across, 3, axis=0))


def raised(sheet: Sheet, heights: Floats) -> Sheet:
    """A sheet with its vertices raised along z by heights (n,) [m], with smooth normals."""
    from sceneql.bodies.spring_look import vertex_normals

    vertices = sheet.vertices.copy()
    vertices[:, 2] += heights
    return Sheet(vertices, sheet.triangles, vertex_normals(vertices, sheet.triangles))


def kept(sheet: Sheet, side: Side) -> Sheet:
    """The part of a sheet where ``side`` is negative; on crossed edges the root of ``side`` is found."""
    if not len(sheet.triangles):
        return sheet
    value = side(sheet.vertices)
    inside = value < 0.0
    count = inside[sheet.triangles].sum(axis=1)
    if not ((count > 0) & (count < 3)).any():
        return _tidy(Sheet(sheet.vertices, sheet.triangles[count == 3], sheet.normals))
    whole = sheet.triangles[count == 3]
    one, two = (_turned(sheet.triangles[count == k], inside, k) for k in (1, 2))
    ends = np.concatenate([one[:, [0, 1]], one[:, [0, 2]], two[:, [0, 2]], two[:, [1, 2]]])
    unique, which = np.unique(ends, axis=0, return_inverse=True)  # inside end first: each edge has one direction
    places, shares = _crossings(sheet.vertices, value, unique, side)
    n = len(sheet.vertices)
    ab, ac, p, q = np.split(n + which.ravel(), np.cumsum([len(one), len(one), len(two)]))
    triangles = np.concatenate(
        [
            whole,
            np.stack([one[:, 0], ab, ac], axis=1),
            np.stack([two[:, 0], two[:, 1], q], axis=1),
            np.stack([two[:, 0], q, p], axis=1),
        ]
    )
    normals = None
    if sheet.normals is not None:
        bent = (1.0 - shares) * sheet.normals[unique[:, 0]] + shares * sheet.normals[unique[:, 1]]
        bent /= np.maximum(np.linalg.norm(bent, axis=1, keepdims=True), 1e-300)
        normals = np.concatenate([sheet.normals, bent])
    return _tidy(Sheet(np.concatenate([sheet.vertices, places]), triangles.astype(np.int32), normals))


def _turned(triangles: Ints, inside: Any, count: int) -> Ints:
    """Triangles with ``count`` (1 or 2) corners inside, rotated so that these come first."""
    flags = inside[triangles]
    lone = np.argmax(flags, axis=1) if count == 1 else (np.argmin(flags, axis=1) + 1) % 3
    return np.take_along_axis(triangles, (lone[:, None] + np.arange(3)) % 3, axis=1)


def _crossings(vertices: Floats, value: Floats, ends: Ints, side: Side) -> tuple[Floats, Floats]:
    """Roots (k, 3) of ``side`` on edges (k, 2) from inside to outside, and their parameters (k, 1) on the edges."""
    a, b = vertices[ends[:, 0]], vertices[ends[:, 1]]
    low, high = np.zeros(len(ends)), np.ones(len(ends))
    below, above = value[ends[:, 0]], value[ends[:, 1]]
    share = below / (below - above)
    for _ in range(POLISH):
        found = side(a + share[:, None] * (b - a))
        inner = found < 0.0
        low, below = np.where(inner, share, low), np.where(inner, found, below)
        high, above = np.where(inner, high, share), np.where(inner, above, found)
        rise = np.where(above > below, above - below, 1.0)
        share = np.where(above > below, low - below * (high - low) / rise, 0.5 * (low + high))
    share = share[:, None]
    return a + share * (b - a), share


def _tidy(sheet: Sheet) -> Sheet:
    """The sheet without unused vertices."""
    used = np.unique(sheet.triangles)
    number = np.zeros(len(sheet.vertices), dtype=np.int32)
    number[used] = np.arange(len(used))
    normals = None if sheet.normals is None else sheet.normals[used]
    return Sheet(sheet.vertices[used], number[sheet.triangles], normals)


def contour(sheet: Sheet, values: Floats, level: float) -> Floats:
    """Segments (k, 2, 3) of the contour line of values (n,) at the vertices, interpolated linearly, at a level."""
    above = values >= level
    count = above[sheet.triangles].sum(axis=1)
    pieces = []
    for k in (1, 2):
        corners = _turned(sheet.triangles[count == k], above, k)
        pairs = corners[:, [[0, 1], [0, 2]]] if k == 1 else corners[:, [[0, 2], [1, 2]]]
        a, b = values[pairs[..., 0]], values[pairs[..., 1]]
        share = ((a - level) / (a - b))[..., None]
        pieces.append((1.0 - share) * sheet.vertices[pairs[..., 0]] + share * sheet.vertices[pairs[..., 1]])
    lines = np.concatenate(pieces)
    real: Floats = lines[np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1) > 0.0]
    return real
