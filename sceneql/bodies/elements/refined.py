"""Meshes made finer: where a script asks for it, and in hollows that turn much along an edge. Imports numpy."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from sceneql.bodies.elements.element import elements
from sceneql.bodies.elements.element_mesh import (
    Creases,
    ElementMesh,
    Onto,
    across_faces,
    meshed,
    onto_object,
    unit,
)
from sceneql.bodies.filling.bisection import bisected
from sceneql.bodies.filling.kept_creases import shapes
from sceneql.bodies.filling.tetrahedra import ENDS, boundary, edges

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

Lengths = Callable[["Floats"], "Floats"]
"""The longest edges (k,) [m] that are wanted at places (k, 3)."""
GROWTH = 1.0
"""How much the length that a hollow asks for grows by the distance."""
LEAST_TURN = 0.05
"""Angle [rad] from which on the turn of an edge is believed."""
LEAST_PART = 0.25
"""Of the spacing: edges are not asked to be shorter for that."""
ALIKE = 8
"""Lengths within 2^(1/8) of each other are looked up together, as the shortest of them."""
LEAST_LEFT = 0.4
"""Part of its shape that a tetrahedron keeps where its new corners move onto the object."""


def hollows(points: Floats, tetrahedra: Ints, onto: Onto, spacing: float, most: float) -> Lengths | None:
    """Edges along which the surface turns by ``most`` [rad] in hollows, where these are below the spacing; else None.

    Stress rises beside holes and in fillets within a part of their radius, which ten nodes follow over half a radian.
    """
    straight = meshed(elements()["p2"], points, tetrahedra)
    bow = onto_object(straight, onto)[0] - straight.points
    faces = straight.faces
    outwards = np.zeros_like(bow)
    for k in range(3, 6):
        np.add.at(outwards, faces[:, k], across_faces(points, faces))
    ends, _ = edges(tetrahedra)
    length = np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1)
    bow, outwards, middles = (one[straight.corners :] for one in (bow, outwards, straight.points))
    turn = 8.0 * np.linalg.norm(bow, axis=1) / length
    asked = np.maximum(most / np.maximum(turn, LEAST_TURN) * length, LEAST_PART * spacing)
    some = (np.einsum("ki,ki->k", bow, outwards) < 0.0) & (asked < spacing)
    return _grown(middles[some], asked[some], 0.5 * length[some]) if some.any() else None


def _grown(places: Floats, lengths: Floats, within: Floats) -> Lengths:
    """Lengths (k,) within distances (k,) of places (k, 3), from there on longer."""
    from scipy.spatial import cKDTree

    # A ball of a length is one of a shorter length that begins earlier: each place has the length at its middle.
    middle = lengths - GROWTH * within
    kinds = np.floor(ALIKE * np.log2(lengths)).astype(int)
    trees = []
    for kind in np.unique(kinds).tolist():
        own = kinds == kind
        trees.append((cKDTree(places[own]), float(middle[own].min()), float(lengths[own].min())))

    def asked(wanted: Floats) -> Floats:
        found = np.full(len(wanted), np.inf)
        for tree, start, least in trees:
            away, _ = tree.query(wanted)
            found = np.minimum(found, np.maximum(start + GROWTH * away, least))
        return found

    return asked


def refined(
    points: Floats, tetrahedra: Ints, wanted: Lengths, onto: Onto | None, bounded: Callable[[float], None]
) -> tuple[Floats, Ints]:
    """Points (n, 3) and tetrahedra (t, 4), none with longer edges than are wanted at its middle.

    New corners of outer edges stand on the object where no tetrahedron is spoilt by it, else on the curved elements
    that they are parts of. ``bounded`` raises where there are too many tetrahedra.
    """
    straight, cells, parents = bisected(points, tetrahedra, wanted, bounded)
    if onto is None:
        return straight, cells
    start = _bent(meshed(elements()["p2"], points, tetrahedra, onto), straight, cells, parents)
    settled = _settled(start, straight, cells, len(points), onto)
    shape = shapes(start[cells])
    for _ in range(len(points)):
        spoilt = shapes(settled[cells]) < LEAST_LEFT * shape
        back = np.unique(cells[spoilt])
        back = back[(settled[back] != start[back]).any(axis=1)]
        if not len(back):
            break
        settled[back] = start[back]
    return settled, cells


def _bent(coarse: ElementMesh, straight: Floats, cells: Ints, parents: NDArray[int64]) -> Floats:
    """(n, 3) where corners of parts (t, 4) of elements numbered ``parents`` (t,) stand when these are bent.

    ``straight`` (n, 3): where they stand in elements with straight edges.
    """
    nodes, first = np.unique(cells, return_index=True)
    own = parents[first // 4]
    corners = coarse.points[coarse.cells[own, :4]]
    sides = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
    local = np.linalg.solve(sides, (straight[nodes] - corners[:, 0])[..., None])[..., 0]
    shares = coarse.element.functions(np.concatenate([1.0 - local.sum(axis=1, keepdims=True), local], axis=1))
    a, b = np.array(ENDS).T
    flat = np.concatenate([corners, 0.5 * (corners[:, a] + corners[:, b])], axis=1)
    bent = straight.copy()
    bent[nodes] += np.einsum("nk,nkj->nj", shares, coarse.points[coarse.cells[own]] - flat)
    return bent


def _settled(start: Floats, straight: Floats, cells: Ints, old: int, onto: Onto) -> Floats:
    """Points (n, 3), of which those from number ``old`` on are moved onto the surface, and creases, of the object."""
    flat = meshed(elements()["p2"], straight, cells)
    creases = Creases.of(flat.points, flat.faces)
    faces = boundary(cells).astype(np.int64)
    normals = np.zeros_like(start)
    for k in range(3):
        np.add.at(normals, faces[:, k], across_faces(start, faces))
    ends, which = np.unique(creases.ends, return_index=True)
    new = ends >= old
    ends, which = ends[new], which[new] // 2
    outer = np.setdiff1d(np.unique(faces), creases.ends)
    outer = outer[outer >= old]
    settled = start.copy()
    settled[outer] = onto.surface(start[outer], unit(normals[outer]))
    if len(ends):
        found = onto.crease(start[ends], creases.normals[which], creases.sides[which])
        met = ~np.isnan(found).any(axis=1)
        settled[ends[met]] = found[met]
    return settled
