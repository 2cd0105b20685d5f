"""Triangles subdivided along sharp edges and corners of a solid, without a change of topology. Imports numpy and numba.

A side whose ends lie on two faces of the solid gets a vertex where the faces meet; a triangle with three such sides
gets one at the corner (Attene, Falcidieno, Rossignac & Spagnuolo 2003). Faces are told apart by the gradients at the
vertices.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from sceneql.field.tape.tape_solid import field_values, many_gradients
from sceneql.mesh.dual.planes import onto_planes
from sceneql.mesh.polygons import Polygons, touched
from sceneql.mesh.repair.flips import facing
from sceneql.mesh.repair.folds import folds

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Tape

    Rows = NDArray[np.int64]
    Mask = NDArray[np.bool_]

ALIKE = 0.9
"""Cosine of 26 degrees: normals with a smaller angle belong to one face."""
OFF = 1.0e-3
"""Largest distance from the surface, relative to the side, of a cut's vertex. Where a smooth surface only bends, its
tangent planes meet farther away from it."""
REACH = 1.0
"""Largest distance of a cut's vertex from the midpoint of its side, relative to the side."""
ROUNDS = 16
WIDENED = 2
"""Rounds after which the cuts one ring of triangles farther away are undone too."""


class Cuts(NamedTuple):
    """Vertices to be inserted on sides and in triangles."""

    side_of: Rows
    """(t, 3) number of the side from vertex k to vertex k + 1 of each triangle."""
    cut: Mask
    """(s,) which sides get a vertex."""
    places: Floats
    """(s, 3) [m] positions of these vertices."""
    corner: Mask
    """(t,) which triangles get a vertex at a corner of the solid; all their sides get one, too."""
    corners: Floats
    """(t, 3) [m] positions of these vertices."""


def sharpened(tape: Tape, polygons: Polygons) -> Polygons:
    """The mesh with vertices inserted on the solid's edges and corners; insertions that would fold it are left out.

    The topology stays the same, so a closed 2-manifold remains one. New vertices have normals of zero.
    """
    import numpy as np

    cuts, before = _cuts(tape, polygons), folds(tape, polygons)
    for turn in range(ROUNDS):
        made, parents = _made(polygons, cuts)
        worse = parents[np.union1d(folds(tape, made), _turned(tape, made, parents, cuts))]
        worse = np.setdiff1d(worse, before[~cuts.cut[cuts.side_of[before]].any(axis=1)])
        if not len(worse):
            return made
        near = np.zeros(len(polygons.vertices), dtype=bool)
        near[polygons.triangles[worse]] = True
        for _ in range(turn // WIDENED):
            near[polygons.triangles[touched(near, polygons.triangles)]] = True
        cuts.cut[cuts.side_of[touched(near, polygons.triangles)]] = False
        cuts.corner[~cuts.cut[cuts.side_of].all(axis=1)] = False
    return polygons


def _turned(tape: Tape, made: Polygons, parents: Rows, cuts: Cuts) -> Rows:
    """(n,) rows of those parts of subdivided triangles that face against the gradient at their center."""
    import numpy as np

    some = cuts.cut[cuts.side_of].sum(axis=1) > 0
    rows = np.flatnonzero(some[parents])
    found: Rows = rows[facing(tape, made.vertices[made.triangles[rows]]) < 0.0]
    return found


def _cuts(tape: Tape, polygons: Polygons) -> Cuts:
    """The vertices to insert: on sides whose ends have normals of two faces, and in triangles with three such sides."""
    import numpy as np

    vertices, normals, triangles = polygons.vertices, polygons.normals, polygons.triangles.astype(np.int64)
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    _, first, side_of = np.unique(
        ends.min(axis=1) * len(vertices) + ends.max(axis=1), return_index=True, return_inverse=True
    )
    side_of = side_of.reshape(-1, 3)
    ends = np.sort(ends[first], axis=1)
    known: Mask = (normals != 0.0).any(axis=1)
    cut: Mask = (np.einsum("sj,sj->s", *normals[ends].transpose(1, 0, 2)) < ALIKE) & known[ends].all(axis=1)
    places = np.zeros((len(ends), 3))
    rows = np.flatnonzero(cut)
    places[rows], met = _met(tape, vertices[ends[rows]], normals[ends[rows]])
    cut[rows[~met]] = False
    corner, corners = np.zeros(len(triangles), dtype=bool), np.zeros((len(triangles), 3))
    rows = np.flatnonzero(cut[side_of].all(axis=1))
    corners[rows], corner[rows] = _met(tape, vertices[triangles[rows]], normals[triangles[rows]])
    return Cuts(side_of, cut, places, corner, corners)


def _met(tape: Tape, points: Floats, normals: Floats) -> tuple[Floats, Mask]:
    """(n, 3) [m] where the tangent planes at points (n, k, 3) with unit normals meet, and (n,) whether near the points.

    Near: within REACH of the points' mean and within OFF of the surface.
    """
    import numpy as np

    if not len(points):
        return np.zeros((0, 3)), np.zeros(0, dtype=bool)
    middles = points.mean(axis=1)
    found = onto_planes(tape, middles, np.ones(points.shape[:2], dtype=bool), points, normals)
    size = np.linalg.norm(points - np.roll(points, 1, axis=1), axis=2).max(axis=1)
    with np.errstate(all="ignore"):
        off = np.abs(field_values(tape, found)) / np.linalg.norm(many_gradients(tape, found), axis=1)
        met = (np.linalg.norm(found - middles, axis=1) < REACH * size) & (off < OFF * size)
    return np.where(met[:, None], found, middles), met


def _made(polygons: Polygons, cuts: Cuts) -> tuple[Polygons, Rows]:
    """The mesh with the vertices inserted, and for each of its triangles (n,) the original one that it is a part of."""
    import numpy as np

    triangles = polygons.triangles.astype(np.int64)
    count = len(polygons.vertices)
    on_side = np.where(cuts.cut, count + np.cumsum(cuts.cut) - 1, -1)
    inner = count + int(cuts.cut.sum()) + np.cumsum(cuts.corner) - 1
    given = cuts.cut[cuts.side_of]
    number = given.sum(axis=1)
    parts, parents = [triangles[number == 0]], [np.flatnonzero(number == 0)]

    def add(rows: Rows, *corners: tuple[Rows, Rows, Rows]) -> None:
        parts.extend(np.stack(part, axis=1) for part in corners)
        parents.extend([rows] * len(corners))

    for k in range(3):
        # One cut, on the side from a to b.
        rows = np.flatnonzero((number == 1) & given[:, k])
        a, b, c = (triangles[rows, (k + j) % 3] for j in range(3))
        p = on_side[cuts.side_of[rows, k]]
        add(rows, (a, p, c), (p, b, c))
        # Two cuts, p from a to b and q from c to a: a lies on another face than b and c.
        rows = np.flatnonzero((number == 2) & ~given[:, (k + 1) % 3])
        a, b, c = (triangles[rows, (k + j) % 3] for j in range(3))
        p, q = (on_side[cuts.side_of[rows, (k + j) % 3]] for j in (0, 2))
        places = np.concatenate([polygons.vertices, cuts.places[cuts.cut]])
        short = np.linalg.norm(places[p] - places[c], axis=1) < np.linalg.norm(places[q] - places[b], axis=1)
        add(rows, (a, p, q))
        add(rows[short], (p[short], b[short], c[short]), (p[short], c[short], q[short]))
        long = ~short
        add(rows[long], (p[long], b[long], q[long]), (b[long], c[long], q[long]))
    rows = np.flatnonzero((number == 3) & cuts.corner)
    a, b, c = triangles[rows].T
    p, q, r = (on_side[cuts.side_of[rows, k]] for k in range(3))
    m = inner[rows]
    add(rows, (a, p, m), (p, b, m), (b, q, m), (q, c, m), (c, r, m), (r, a, m))
    rows = np.flatnonzero((number == 3) & ~cuts.corner)
    a, b, c = triangles[rows].T
    p, q, r = (on_side[cuts.side_of[rows, k]] for k in range(3))
    add(rows, (a, p, r), (p, b, q), (q, c, r), (p, q, r))
    vertices = np.concatenate([polygons.vertices, cuts.places[cuts.cut], cuts.corners[cuts.corner]])
    normals = np.concatenate([polygons.normals, np.zeros((len(vertices) - count, 3))])
    return Polygons(vertices, np.concatenate(parts).astype(np.int32), normals), np.concatenate(parents)
