"""Surface of a rigid body as triangles in its axes, small enough for contacts. Imports numpy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.failure import RunFailure
from sceneql.island.start import Start
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.contacts.distance.convex import Convex
    from sceneql.frame import Floats
    from sceneql.kinds import Ref
    from sceneql.system import Assembly

MOST = 4000
"""Approximate limit of triangles per body; beyond it they stay larger than requested."""
ROUND = 0.2
"""Longest edge on a ball, relative to its radius: its triangles are then within 0.5 % of the radius."""
CELLS, MOST_CELLS = 12.0, 40.0
"""Least and largest number of cells along the longest side of a shape that is no polyhedron."""

Triangles = tuple["Floats", "NDArray[int64]"]


def triangles_of(ref: Ref | None, center: Floats, side: float, assembly: Assembly) -> Triangles:
    """Vertices (n, 3) [m] from the center of mass and triangles (m, 3), counterclockwise from outside.

    ``center`` (3,) [m]: in the axes of the body's object; ``side`` [m]: longest edge.
    Raises ScriptError for an object without a surface, or with one that varies in time.
    """
    if ref is None:
        message = "a body without an object has no shape to touch with"
        raise ScriptError([Diagnostic("no-collider", message, assembly.line())])
    from sceneql.contacts.shapes import implicit
    from sceneql.shapes.placement import UPRIGHT, Placed

    kind: Any = assembly.object(ref)
    if isinstance(kind, Placed):
        kind = kind.model_copy(update={"position": implicit.ORIGIN, "rotation": UPRIGHT})
    try:
        if implicit.changes(kind, assembly):
            raise ValueError("it changes its shape in time")
        points, triangles = _surface(kind, side, assembly)
    except (TypeError, ValueError, RunFailure) as error:
        message = f"'{ref.name}' does not collide with elastic solids: {error}"
        help = f"name under `between` what may touch, without '{ref.name}'"
        raise ScriptError([Diagnostic("no-collider", message, ref.span, help)]) from None
    a, b, c = points[triangles].transpose(1, 0, 2)
    area = 0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
    # Equilateral triangles have an area of 0.43 side^2.
    points, triangles = refined(points, triangles, max(side, float(np.sqrt(area / (0.43 * MOST)))))
    return points - center, triangles


def _surface(kind: Any, side: float, assembly: Assembly) -> Triangles:
    """Vertices and triangles in the axes of the object."""
    from sceneql.contacts.distance import convex

    start: Any = Start(assembly)
    if getattr(kind, "triangles_at", None) is not None:
        from sceneql.contacts.shapes.closed_mesh import closed
        from sceneql.mesh.holes import welded

        corners = kind.triangles_at(start)
        made = closed(corners.reshape(-1, 3), np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3))
        every = np.arange(3 * len(made.corners), dtype=np.int32).reshape(-1, 3)
        points, triangles = welded(made.corners.reshape(-1, 3), every)
        return points, triangles.astype(np.int64)
    try:
        shape = kind.convex(start, np.zeros(3))
    except (TypeError, ValueError):
        shape = None
    if shape is not None and shape.kind == convex.CORE:
        if shape.radius == 0.0 and shape.ints[1] > 0:
            return _polyhedron(shape)
        if len(shape.vertices) == 1:
            return _ball(shape.radius, shape.vertices[0], side)
    return _of_field(kind, side, start)


def _polyhedron(shape: Convex) -> Triangles:
    f, loops = (int(number) for number in (shape.ints[1], shape.ints[3]))
    starts, ring = shape.ints[4 : 5 + f], shape.ints[5 + f : 5 + f + loops]
    fans = []
    for k in range(f):
        loop = ring[starts[k] : starts[k + 1]]
        fans += [(loop[0], loop[i], loop[i + 1]) for i in range(1, len(loop) - 1)]
    return shape.vertices.copy(), np.array(fans, dtype=np.int64)


def _ball(radius: float, center: Floats, side: float) -> Triangles:
    """Icosahedron with triangles refined and projected until they are small."""
    from scipy.spatial import ConvexHull

    golden = 0.5 * (1.0 + np.sqrt(5.0))
    signs = np.array([(i, j) for i in (-1.0, 1.0) for j in (-1.0, 1.0)])
    flat = np.column_stack([np.zeros(4), signs[:, 0], golden * signs[:, 1]])
    points = np.concatenate([np.roll(flat, k, axis=1) for k in range(3)])
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    triangles = ConvexHull(points).simplices.astype(np.int64)
    a, b, c = points[triangles].transpose(1, 0, 2)
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0.0
    triangles[inward] = triangles[inward][:, ::-1]
    longest = 2.0 / np.sqrt(1.0 + golden * golden)
    while longest > min(ROUND, side / radius) and 4 * len(triangles) <= 2 * MOST:
        points, triangles = refined(points, triangles, 0.75 * longest)
        points /= np.linalg.norm(points, axis=1, keepdims=True)
        longest = _longest(points, triangles)
    return center + radius * points, triangles


def _longest(points: Floats, triangles: NDArray[int64]) -> float:
    corners = points[triangles]
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max())


def _of_field(kind: Any, side: float, start: Any) -> Triangles:
    from sceneql.mesh.dual.sharp import polygonise_sharp
    from sceneql.shapes.solid import field_in_box

    found = field_in_box(kind, "it", np.eye(3, 4), start, "collided with")
    if found is None:
        raise ValueError("it is empty")
    tape, low, high = found
    size = float(max(np.subtract(high, low)))
    mesh = polygonise_sharp(tape, low, high, min(max(0.7 * side, size / MOST_CELLS), size / CELLS))
    if not len(mesh.triangles):
        raise ValueError("it is empty, or smaller than cells")
    return mesh.vertices, mesh.triangles.astype(np.int64)


def refined(points: Floats, triangles: NDArray[int64], longest: float) -> Triangles:
    """Triangles with edges halved, consistently on both sides, until none is longer than ``longest`` [m]."""
    while True:
        sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        edges, which = np.unique(sides, axis=0, return_inverse=True)
        long = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1) > longest
        if not long.any():
            return points, triangles
        middle = np.full(len(edges), -1, dtype=np.int64)
        middle[long] = len(points) + np.arange(long.sum())
        points = np.concatenate([points, 0.5 * (points[edges[long, 0]] + points[edges[long, 1]])])
        halved = middle[which.reshape(-1, 3)]
        triangles = np.concatenate([_cut(triangles, halved, pattern) for pattern in range(8)])


def _cut(triangles: NDArray[int64], middles: NDArray[int64], pattern: int) -> NDArray[int64]:
    """Pieces of the triangles with halved sides k, from corner k to the next, for the set bits of ``pattern``."""
    mine = ((middles >= 0) @ np.array([1, 2, 4])) == pattern
    (a, b, c), (d, e, f) = triangles[mine].T, middles[mine].T
    match pattern.bit_count():
        case 0:
            pieces = [(a, b, c)]
        case 3:
            pieces = [(a, d, f), (d, b, e), (f, e, c), (d, e, f)]
        case 1:  # rotated so that the halved side is the first
            turn = pattern.bit_length() - 1
            (a, b, c), d = np.roll((a, b, c), -turn, axis=0), (d, e, f)[turn]
            pieces = [(a, d, c), (d, b, c)]
        case _:  # rotated so that the last side is not halved
            turn = {3: 0, 6: 1, 5: 2}[pattern]
            (a, b, c), (d, e, _) = np.roll((a, b, c), -turn, axis=0), np.roll((d, e, f), -turn, axis=0)
            pieces = [(d, b, e), (a, d, e), (a, e, c)]
    return np.concatenate([np.column_stack(piece) for piece in pieces])
