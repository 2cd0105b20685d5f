"""Surface of an object as a closed sheet of triangles of about equal size."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sceneql.failure import LimitRefused
from sceneql.grids.domain.domain import inside
from sceneql.island.start import Start
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.skins.closed_line import SKINS
from sceneql.skins.onto_level import onto

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.kinds import Ref
    from sceneql.system import Assembly

MOST = 20_000_000
"""Largest number of lattice points at which a level is evaluated."""
SMOOTHED = 12
"""Rounds of smoothing: vertices move half the way to the mean of their neighbors, then back onto the surface."""
SQUARES = tuple(
    (axis, np.eye(3, dtype=np.int64)[[(axis + 1) % 3, (axis + 2) % 3]]) for axis in range(3)
)  # for lattice edges along each axis: steps to the four cells around them


def closed_surface(ref: Ref, spacing: float, assembly: Assembly) -> tuple[Floats, NDArray[int64]]:
    """Vertices (n, 3) [m] about ``spacing`` [m] apart, and triangles (m, 3), counterclockwise from outside.

    Raises ScriptError for an object without an inside, in several pieces, or with parts finer than the spacing, and
    LimitRefused for too many lattice points.
    """
    try:
        level, low, high, _ = inside(ref, False, cast("Any", Start(assembly)))
        if getattr(level, "flat", False):
            raise ValueError("it is flat, and its flow is not")
        points, triangles = _nets(level, low, high, spacing, assembly)
    except (TypeError, ValueError) as error:
        text = f"'{ref.name}' cannot be a skin: {error}"
        raise ScriptError([Diagnostic("no-domain", text, ref.span, SKINS)]) from error
    why = wrong(len(points), triangles)
    if why:
        help = "take a smaller `spacing`, or a `cell` that goes with it"
        raise ScriptError([Diagnostic("no-domain", f"'{ref.name}' cannot be a skin: {why}", ref.span, help)])
    size = float((high - low).max())
    for _ in range(SMOOTHED):
        points = onto(level, size, 0.5 * (points + _means(points, triangles)))
    return points, triangles


def wrong(count: int, triangles: NDArray[int64]) -> str:
    """Reason why triangles (m, 3) with ``count`` vertices are not one closed sheet; empty if they are."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if len(triangles) == 0:
        return "nothing of it is as large as the spacing"
    a, b = _sides(triangles)
    codes = a * count + b
    if len(np.unique(codes)) < len(codes) or not np.isin(b * count + a, codes).all():
        return "parts of it are closer than the spacing"
    pieces, _ = connected_components(coo_array((np.ones(len(a)), (a, b)), shape=(count, count)))
    return f"it has {pieces} surfaces, and a skin is one" if pieces > 1 else ""


def _sides(triangles: NDArray[int64]) -> tuple[NDArray[int64], NDArray[int64]]:
    """First and second vertices, (3 m,) each, of the directed sides of triangles (m, 3)."""
    return triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()


def _means(points: Floats, triangles: NDArray[int64]) -> Floats:
    """Mean (n, 3) of the neighbors of each vertex."""
    a, b = _sides(triangles)
    sums = np.column_stack([np.bincount(a, points[b, k], len(points)) for k in range(3)])
    found: Floats = sums / np.bincount(a, minlength=len(points))[:, None]
    return found


def _nets(level: Any, low: Floats, high: Floats, spacing: float, assembly: Assembly) -> tuple[Floats, NDArray[int64]]:
    """Surface nets: one vertex in each lattice cell that the surface crosses, two triangles for each crossed edge.

    Gibson 1998, MICCAI 1998, 888-898.
    """
    begin = low - 2.3 * spacing
    counts = np.ceil((high - low) / spacing).astype(np.int64) + 6
    if float(np.prod(counts.astype(float))) > MOST:
        text = f"{np.prod(counts.astype(float)):.3g} places: an object is looked at, at {MOST:,} at most"
        raise LimitRefused(text, assembly.line(), "take a larger `spacing`, or a larger `cell` of the flow")
    index = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1)
    values = level.values((begin + spacing * index).reshape(-1, 3)).reshape(tuple(counts))
    within = values < 0.0
    sums, hits = np.zeros((*counts, 3)), np.zeros(tuple(counts))
    quads = []
    for axis, steps in SQUARES:
        ahead = np.roll(within, -1, axis=axis)
        ends = np.argwhere(within != ahead)  # none at the last place: the lattice's rim is outside
        first = values[tuple(ends.T)]
        part = first / (first - np.roll(values, -1, axis=axis)[tuple(ends.T)])
        crossing = ends + part[:, None] * np.eye(3)[axis]
        around = [ends - i * steps[0] - j * steps[1] for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
        for cells in around:
            np.add.at(sums, tuple(cells.T), crossing)
            np.add.at(hits, tuple(cells.T), 1.0)
        numbers = np.stack([np.ravel_multi_index(tuple(cells.T), tuple(counts)) for cells in around], axis=1)
        outward = within[tuple(ends.T)]
        quads.append(np.where(outward[:, None], numbers, numbers[:, ::-1]))
    used = np.flatnonzero(hits.ravel())
    points = begin + spacing * sums.reshape(-1, 3)[used] / hits.ravel()[used, None]
    corners = np.searchsorted(used, np.concatenate(quads))
    return points, _halves(points, corners)


def _halves(points: Floats, quads: NDArray[int64]) -> NDArray[int64]:
    """Triangles (2 k, 3) of quadrilaterals (k, 4), each split along its shorter diagonal."""
    a, b, c, d = quads.T
    across = ((points[a] - points[c]) ** 2).sum(axis=1) <= ((points[b] - points[d]) ** 2).sum(axis=1)
    one = np.where(across[:, None], np.column_stack([a, b, c]), np.column_stack([a, b, d]))
    other = np.where(across[:, None], np.column_stack([a, c, d]), np.column_stack([b, c, d]))
    return np.concatenate([one, other])
