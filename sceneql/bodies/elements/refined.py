"""Local refinement of tetrahedral meshes: where a script asks for it, and at concave curved surfaces. Imports numpy."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

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
"""A size function: longest wanted edges (k,) [m] at places (k, 3) [m]."""
GROWTH = 1.0
"""Growth of the wanted edge length with the distance from a concave surface [m/m]."""
LEAST_TURN = 0.05
"""Angle [rad] below which the turn of the surface along an edge is not resolved."""
LEAST_PART = 0.25
"""Shortest edge wanted for a concave surface, relative to the spacing."""
ALIKE = 8
"""Wanted lengths within a factor of 2^(1/8) are searched in one tree, as the shortest of them."""
LEAST_LEFT = 0.4
"""Least shape of a tetrahedron whose new corners move onto the object, relative to its shape before."""


def hollows(points: Floats, tetrahedra: Ints, onto: Onto, spacing: float, most: float) -> Lengths | None:
    """The size function by which concave surfaces turn at most ``most`` [rad] along an edge; None if all edges comply.

    Stress concentrates beside holes and in fillets within a fraction of their radius; ten-node elements follow it where
    they span about half a radian.
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
    """The size function with lengths (k,) [m] within distances (k,) of places (k, 3), growing by GROWTH beyond."""
    from scipy.spatial import cKDTree

    # The cone of lengths outside each ball, extended to the ball's center, has the value ``middle`` there.
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
    """Points (n, 3) and tetrahedra (t, 4) refined until no edge is longer than wanted at the tetrahedron's center.

    New corners on outer edges are moved onto the object where no tetrahedron loses its shape (LEAST_LEFT), else onto
    the curved element that they divide. ``bounded`` raises where the tetrahedra are too many.
    """
    straight, cells, parents = bisected(points, tetrahedra, wanted, bounded)
    if onto is None:
        return straight, cells
    start = bent(meshed(elements()["p2"], points, tetrahedra, onto), straight, cells, parents)
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


def bent(coarse: ElementMesh, straight: Floats, cells: Ints, parents: NDArray[int64]) -> Floats:
    """Positions (n, 3) [m] in the curved elements ``coarse`` of points ``straight`` (n, 3) in the straight ones.

    ``cells`` (t, nodes): elements between these points; ``parents`` (t,): the coarse element that each is a part of.
    """
    nodes, first = np.unique(cells, return_index=True)
    bent = straight.copy()
    bent[nodes] = in_curved(coarse, straight[nodes], parents[first // cells.shape[1]])
    return bent


def in_curved(coarse: ElementMesh, straight: Floats, own: Any) -> Floats:
    """Places (k, 3) [m] in the curved elements ``own`` (k,) of places (k, 3) in the straight ones."""
    corners = coarse.points[coarse.cells[own, :4]]
    sides = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
    local = np.linalg.solve(sides, (straight - corners[:, 0])[..., None])[..., 0]
    shares = coarse.element.functions(np.concatenate([1.0 - local.sum(axis=1, keepdims=True), local], axis=1))
    a, b = np.array(ENDS).T
    flat = np.concatenate([corners, 0.5 * (corners[:, a] + corners[:, b])], axis=1)
    bent: Floats = straight + np.einsum("nk,nkj->nj", shares, coarse.points[coarse.cells[own]] - flat)
    return bent


def _settled(start: Floats, straight: Floats, cells: Ints, old: int, onto: Onto) -> Floats:
    """Points (n, 3) with the outer ones from number ``old`` on moved onto the object's surface or its creases."""
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
