"""Volume, center and second moments of implicit solids, of high order where they are smooth. Imports numpy.

The moments of marching cubes' polyhedron, plus those of the gaps between its triangles and the surface. Over a triangle
the gap consists of the points p + t d, t from 0 to s: p on the triangle, d the interpolated vertex normal at p, s the
root of the field along d, found at the nodes of a quadrature rule. Neighboring triangles have the same d along their
common edge, so gaps of neighbors fit together.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.field.tape.tape_solid import field_values
from sceneql.mesh.bounded import Corner, bounded
from sceneql.mesh.cubes.polygonise import polygonise
from sceneql.mesh.polyhedra import PAIRS, about, integrals

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints, Tape
    from sceneql.kinds import VolumeMoments

    Bools = NDArray[np.bool_]

FIRST, SECOND = 0.470142064105115, 0.101286507323456
PLACES = np.array(
    [[1 / 3, 1 / 3, 1 / 3]] + [np.roll([1.0 - 2.0 * c, c, c], k) for c in (FIRST, SECOND) for k in range(3)]
)
"""(7, 3) barycentric coordinates of the nodes of the rule of degree 5 on a triangle (Radon 1948)."""
WEIGHTS = np.repeat([0.225, 0.132394152788506, 0.125939180544827], [1, 3, 3])
SQUARES = (PLACES**2).sum(axis=1)
LOWER = np.concatenate([[0.0], np.linalg.solve([[3.0, 3.0], 3.0 * SQUARES[[1, 4]]], [1.0, 0.5]).repeat(3)])
"""(7,) weights at Radon's nodes of a rule of degree 2, which leaves out the center; WEIGHTS are Radon's."""
DEPTHS, SHARES = (0.5 + 0.5 * np.polynomial.legendre.leggauss(3)[0]), 0.5 * np.polynomial.legendre.leggauss(3)[1]
"""Nodes and weights of Gauss's rule of degree 5 on 0..1, exact along d for all second moments."""
SPANS = (1 / 16, 1 / 4, 1.0, 2.0)
"""Distances [cells] from a triangle within which the surface is searched, one after the other."""
MOST = 60
"""Most steps of a root search."""
NEAR = 1e-12
"""Length [cells] of a root search's last step."""
ROUGH, ROUGH_PART = 3e-4, 3e-5
"""Difference between the two rules' mean distance to the surface, relative to a triangle's size, above which a triangle
and a part of one are quartered: the case where an edge of the solid crosses it."""
TURN = 0.8
"""Cosine of 37 degrees: a triangle with a larger angle between the gradients at two corners is quartered, too."""
DEEPEST = 3
"""Most quarterings of a triangle."""
MANY, FEW = 1024, 0.125
"""A CHUNK in which more than MANY triangles plus the share FEW would be quartered has cells too coarse: none is."""
CHUNK = 1 << 13
"""Triangles of one batch."""


def curved_moments(tape: Tape, low: Corner, high: Corner, cell: float) -> VolumeMoments | None:
    """Moments of the solid {tape < 0} clipped at the box low..high, from cells with side ``cell`` [m].

    None where no cell meets the surface. The error is of order 4 or more in ``cell`` where the surface is smooth; along
    edges and corners of the solid triangles are quartered to an eighth of a cell. Raises ValueError as ``polygonise``.
    """
    found = polygonise(tape, low, high, cell)
    if not len(found.triangles):
        return None
    middle = found.vertices.mean(axis=0)
    corners = (found.vertices - middle)[found.triangles]
    ways = _normals(found.vertices, found.triangles)[found.triangles]
    slopes = found.normals[found.triangles]
    turned = ((slopes * np.roll(slopes, 1, axis=1)).sum(axis=2) < TURN).any(axis=1)
    whole = integrals(found.vertices, found.triangles, middle)
    solid = bounded(tape, low, high)
    for start in range(0, len(corners), CHUNK):
        some = slice(start, start + CHUNK)
        whole += _beyond(solid, middle, cell, corners[some], ways[some], turned[some])
    return about(whole, middle) if whole[0] > 0.0 else None


def _normals(vertices: Floats, triangles: Ints) -> Floats:
    """(v, 3) unit vertex normals: the area-weighted means of the adjacent triangles' normals.

    Unlike gradients of the field, they do not jump from one vertex to the next across an edge of the solid.
    """
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    across = np.cross(b - a, c - a)
    total = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(total, triangles[:, k], across)
    found: Floats = total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-300)
    return found


def _beyond(solid: Tape, middle: Floats, cell: float, corners: Floats, ways: Floats, turned: Bools) -> Floats:
    """(10,) integrals, as of ``polyhedra.integrals``, over the gaps between triangles and the surface.

    ``corners`` (t, 3, 3) [m] relative to ``middle``, ``ways`` (t, 3, 3) vertex normals there. Triangles of ``turned``
    (t,), and those over which the two quadrature rules disagree, are quartered.
    """
    whole = np.zeros(10)
    for level in range(DEEPEST + 1):
        # By einsum: the order of BLAS's sums may depend on the number of threads.
        feet, normals = (np.einsum("qk,tkj->tqj", PLACES, some) for some in (corners, ways))
        lengths = _roots(solid, (feet + middle).reshape(-1, 3), normals.reshape(-1, 3), cell).reshape(feet.shape[:2])
        first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        size = np.sqrt(0.5 * np.linalg.norm(np.cross(first, second), axis=1))
        off = np.abs(np.einsum("tq,q->t", lengths, WEIGHTS - LOWER))
        rough = off > ROUGH_PART * size if level else turned | (off > ROUGH * size)
        last = level == DEEPEST or (level == 0 and np.count_nonzero(rough) > MANY + FEW * len(rough))
        done = np.ones_like(rough) if last else ~rough
        turns = ways[done, 1:] - ways[done, :1]
        whole += _between(first[done], second[done], turns, feet[done], normals[done], lengths[done])
        if done.all():
            break
        corners, ways = _quartered(corners[~done]), _quartered(ways[~done])
    return whole


def _between(first: Floats, second: Floats, turns: Floats, feet: Floats, normals: Floats, lengths: Floats) -> Floats:
    """(10,) integrals over the points p + s d, 0 <= s <= ``lengths`` (t, 7); ``feet`` p and ``normals`` d (t, 7, 3).

    ``first``, ``second`` (t, 3): derivatives of p along two sides of the triangle; ``turns`` (t, 2, 3): those of d.
    """
    whole = np.zeros(10)
    for depth, share in zip(DEPTHS, SHARES, strict=True):
        away = (depth * lengths)[..., None]
        along = first[:, None] + away * turns[:, None, 0]
        across = second[:, None] + away * turns[:, None, 1]
        room = 0.5 * share * WEIGHTS * lengths * (np.cross(along, across) * normals).sum(axis=2)
        x = feet + away * normals
        whole[0] += room.sum()
        for k in range(3):
            whole[1 + k] += (room * x[..., k]).sum()
        for k, (i, j) in enumerate(PAIRS):
            whole[4 + k] += (room * x[..., i] * x[..., j]).sum()
    return whole


def _quartered(corners: Floats) -> Floats:
    """(4 t, 3, 3) the triangles (t, 3, 3), each cut into four by the midpoints of its sides."""
    a, b, c = corners.transpose(1, 0, 2)
    ab, bc, ca = 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)
    return np.concatenate([np.stack(part, axis=1) for part in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])


def _roots(solid: Tape, feet: Floats, normals: Floats, cell: float) -> Floats:
    """(n,) signed distances s from ``feet`` (n, 3) along ``normals`` (n, 3) at which the field changes its sign.

    The search goes outward from a foot inside the solid, inward from one outside, over SPANS; s is 0 where the sign
    does not change. By false position in the Illinois variant (Dowell & Jarratt 1971), each sixth step a bisection.
    """
    found = np.zeros(len(feet))
    here = field_values(solid, feet)
    way = np.where(here < 0.0, cell, -cell)
    which, a, fa = np.arange(len(feet)), found.copy(), here
    brackets = []
    for span in SPANS:
        b = span * way[which]
        fb = field_values(solid, feet[which] + b[:, None] * normals[which])
        met = (fb < 0.0) != (here[which] < 0.0)
        brackets.append((which[met], a[met], fa[met], b[met], fb[met]))
        which, a, fa = which[~met], b[~met], fb[~met]
    which, a, fa, b, fb = (np.concatenate(parts) for parts in zip(*brackets, strict=True))
    for step in range(MOST):
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            s = b - fb * ((b - a) / (fb - fa))
        halve = ~((s - a) * (s - b) <= 0.0) | (step % 6 == 5)
        s = np.where(halve, 0.5 * (a + b), s)
        fs = field_values(solid, feet[which] + s[:, None] * normals[which])
        found[which] = s
        going = ~((np.abs(s - b) <= NEAR * cell) | (np.abs(s - a) <= NEAR * cell) | (fs == 0.0))
        same = (fs < 0.0) == (fb < 0.0)
        fa, a = np.where(same, 0.5 * fa, fb), np.where(same, a, b)
        which, a, fa, b, fb = which[going], a[going], fa[going], s[going], fs[going]
        if not len(which):
            break
    return found
