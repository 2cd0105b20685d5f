"""Contact points on implicit surfaces: of the smooth surface, and of its edges and corners.

Imports numpy: to be imported by the method that runs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.island.start import Start
from sceneql.mesh.measures import area, volume
from sceneql.shapes.of_contents import OfContents
from sceneql.shapes.solid import field_in_box

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape
    from sceneql.kinds import Collider
    from sceneql.mesh.bounded import Corner
    from sceneql.system import Assembly

CELLS = 20
"""Initial number of cells along the longest side."""
MOST_CELLS = 160
THIN = 2.0
"""Least number of cells in the mean thickness of the solid."""
SHARP = 0.9
"""Cosine of the angle between normals of neighboring triangles below which an edge is sharp."""
TURNS = 8
"""Newton steps that move corners and points of edges onto their faces."""

Found = tuple["Floats", "Floats", float, float]


def points_of_field(kind: Any, collider: Collider, assembly: Assembly) -> Found:
    """Records (n, 12) of edges and corners, (m, 12) of the smooth surface; spacing, and half the solid's thickness [m].

    Raises TypeError for an unbounded object, ValueError for an empty one.
    """
    start: Any = Start(assembly)
    found = field_in_box(kind, "it", np.eye(3, 4), start, "collided with")
    if found is None:
        raise ValueError("it is empty")
    tape, low, high = found
    of = tape.code, tape.constants, tape.parts, np.array([*low, *high])
    return _KNOWN.get(of, lambda: _of_tape(tape, low, high))


_KNOWN: OfContents[Found] = OfContents(64)


def _of_tape(tape: Tape, low: Corner, high: Corner) -> Found:
    from sceneql.mesh.dual.sharp import polygonise_sharp

    side = max(np.subtract(high, low))
    cells = CELLS
    while True:
        cell = side / cells
        mesh = polygonise_sharp(tape, low, high, cell)
        if not len(mesh.triangles):
            thick = 0.0
        else:
            thick = 2.0 * abs(volume(mesh.vertices, mesh.triangles)) / area(mesh.vertices, mesh.triangles)
        if thick >= THIN * cell or 2 * cells > MOST_CELLS:
            break
        cells *= 2
    if thick == 0.0:
        raise ValueError(f"it is empty, or smaller than cells of {cell:.3g} m")
    edges, smooth = _split(tape, mesh.vertices, mesh.triangles, cell)
    return edges, smooth, cell, 0.5 * thick


def _slopes(tape: Tape, points: Floats) -> tuple[Floats, Floats]:
    """Field over the size of its gradient (n,) [m], and unit gradient (n, 3), at points (n, 3) [m]."""
    from sceneql.contacts.distance.skin_slopes_kernels import slopes
    from sceneql.field.tape.tape_ops import SCRATCH_COLUMNS, scratch_rows

    found = np.zeros((len(points), 4))
    scratch = np.zeros((scratch_rows(len(tape.code), len(tape.parts)), SCRATCH_COLUMNS))
    slopes(tape.code, tape.constants, tape.parts, scratch, np.ascontiguousarray(points), found)
    size = np.linalg.norm(found[:, 1:], axis=1)
    size[~(size > 0)] = np.inf
    return found[:, 0] / size, found[:, 1:] / size[:, None]


def _split(tape: Tape, vertices: Floats, triangles: Ints, cell: float) -> tuple[Floats, Floats]:
    """Records (n, 12) of edges and corners, and (m, 12) of the smooth rest."""
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1)
    normals /= np.where(length > 0, length, 1.0)[:, None]
    # Normals of triangles are the field's gradients at their centers, projected onto the surface.
    middles = (a + b + c) / 3
    for _ in range(2):
        away, up = _slopes(tape, middles)
        middles = middles - np.clip(away, -0.3 * cell, 0.3 * cell)[:, None] * up
    up = _slopes(tape, middles)[1]
    sides = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).astype(np.int64)
    owner = np.repeat(np.arange(len(triangles)), 3)
    keys = sides.min(axis=1) * len(vertices) + sides.max(axis=1)
    order = np.argsort(keys, kind="stable")
    keys, owner = keys[order], owner[order]
    twins = np.flatnonzero(keys[1:] == keys[:-1])
    one, other = owner[twins], owner[twins + 1]
    ends = np.stack(np.divmod(keys[twins], len(vertices)), axis=1)
    sharp = np.einsum("ij,ij->i", up[one], up[other]) < SHARP
    # Concave edges never touch first.
    out = np.einsum("ij,ij->i", middles[other] - middles[one], up[one]) < 0.0
    chosen = sharp & out
    on = np.zeros(len(vertices), dtype=bool)
    on[ends[sharp].ravel()] = True
    places = _on_surface(tape, vertices[~on], cell)
    smooth = np.zeros((len(places), 12))
    smooth[:, :3], smooth[:, 3:6] = places, _slopes(tape, places)[1]
    edges = _creases(tape, vertices, ends[chosen], triangles, middles, cell)
    return edges, smooth


def _on_surface(tape: Tape, points: Floats, cell: float) -> Floats:
    for _ in range(TURNS):
        away, up = _slopes(tape, points)
        points = points - np.clip(away, -cell, cell)[:, None] * up
    return points


def _creases(
    tape: Tape, vertices: Floats, ends: NDArray[int64], triangles: Ints, middles: Floats, cell: float
) -> Floats:
    """Records (n, 12) of points on sharp edges, each on the faces that meet there, with the edge's curvature."""
    beside: dict[int, list[int]] = {}
    for i, j in ends.tolist():
        beside.setdefault(i, []).append(j)
        beside.setdefault(j, []).append(i)
    names = sorted(beside)
    if not names:
        return np.zeros((0, 12))
    around: dict[int, list[int]] = {name: [] for name in names}
    for number, corners in enumerate(triangles.tolist()):
        for corner in corners:
            if corner in around:
                around[corner].append(number)
    place = {name: _at_corner(tape, vertices[name], middles[around[name]], cell) for name in names}
    records = []
    for name in names:
        p, others = place[name], [place[other] for other in beside[name]]
        record = np.zeros(12)
        record[:3] = p
        if len(others) == 2:
            u, v = p - others[0], others[1] - p
            lu, lv = np.linalg.norm(u), np.linalg.norm(v)
            if min(lu, lv) > 1e-6 * cell and u @ v > 0.7 * lu * lv:
                bend = np.cross(u, v)
                square = float(bend @ bend)
                tangent = u * lv / lu + v * lu / lv
                tangent /= np.linalg.norm(tangent)
                # A little more than half way to both neighbors, so that no gap remains between points.
                record[6:9] = 0.55 * max(lu, lv) * tangent
                if square > (1e-9 * lu * lv) ** 2:
                    # The circle through the three points.
                    w = u + v
                    radius = lu * lv * np.linalg.norm(w) / (2 * np.sqrt(square))
                    inwards = np.cross(bend, tangent)
                    record[9:12] = -radius * inwards / np.linalg.norm(inwards)
        records.append(record)
    return np.array(records)


def _at_corner(tape: Tape, p: Floats, middles: Floats, cell: float) -> Floats:
    """Point (3,) near p in which the tangent planes of the faces around it meet; least displacement (Newton)."""
    start, part = p.copy(), 0.2
    for _ in range(TURNS):
        toward = middles - p
        size = np.linalg.norm(toward, axis=1)
        toward = toward[size > 0] / size[size > 0, None]
        looked = p + part * cell * toward
        for _ in range(2):
            away, up = _slopes(tape, looked)
            looked = looked - np.clip(away, -part * cell, part * cell)[:, None] * up
        away, up = _slopes(tape, looked)
        heights = np.einsum("ij,ij->i", up, looked - p) - away
        moved = np.linalg.lstsq(up, heights, rcond=0.05)[0]
        if not np.linalg.norm(p + moved - start) < cell:
            return start
        # The error of curved faces is quadratic in the distance sampled around the corner.
        p, part = p + moved, 0.15 * part
    return p
