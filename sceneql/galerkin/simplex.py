"""Linear and quadratic functions on triangles and tetrahedra, and quadrature rules. Imports numpy."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import permutations
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.elements.element_mesh import fine_rule
from sceneql.bodies.filling.tetrahedra import ENDS, FACES

if TYPE_CHECKING:
    from sceneql.frame import Floats

TRIANGLE_ENDS = ((0, 1), (1, 2), (2, 0))
"""Corners of a triangle's edges, in the order of the nodes on them."""
TRIANGLE_SIDES = ((1, 2), (2, 0), (0, 1))
"""Corners of a triangle's sides, counterclockwise; side k is opposite to corner k."""
INNER = ((0.445948490915965, 0.223381589678011), (0.091576213509771, 0.109951743655322))
"""Coordinate and weight of the two orbits of the six-point rule in a triangle, exact to degree 4 (Dunavant 1985)."""
GAUSS = (0.5 * (1.0 - 0.6**0.5), 0.5, 0.5 * (1.0 + 0.6**0.5))
"""Points of the three-point Gauss rule on a side, exact to degree 5."""


@dataclass(frozen=True, slots=True)
class Simplex:
    """Triangles (2 dimensions) or tetrahedra (3) with nodes at corners (degree 1), and on edges too (degree 2)."""

    dimension: int
    degree: int

    @property
    def ends(self) -> tuple[tuple[int, int], ...]:
        """Corners of each edge, in the order of the nodes on them."""
        return TRIANGLE_ENDS if self.dimension == 2 else ENDS

    @property
    def sides(self) -> tuple[tuple[int, ...], ...]:
        """Corners of each side, counterclockwise from outside; side k is opposite to corner k."""
        return TRIANGLE_SIDES if self.dimension == 2 else FACES

    @property
    def nodes(self) -> int:
        """Number of nodes of an element."""
        return self.dimension + 1 + (len(self.ends) if self.degree == 2 else 0)

    def functions(self, places: Any) -> Floats:
        """Values (q, nodes) of the functions at barycentric places (q, corners).

        Degree 1: L. Degree 2: L (2 L - 1) of corners, 4 L M of edges.
        """
        at = np.asarray(places, dtype=float)
        if self.degree == 1:
            return at
        a, b = np.array(self.ends).T
        return np.concatenate([at * (2.0 * at - 1.0), 4.0 * at[..., a] * at[..., b]], axis=-1)

    def slopes(self, places: Any) -> Floats:
        """Derivatives (q, nodes, corners) of the functions by the barycentric coordinates."""
        at = np.asarray(places, dtype=float)
        corners = self.dimension + 1
        found = np.zeros((*at.shape[:-1], self.nodes, corners))
        for k in range(corners):
            found[..., k, k] = 1.0 if self.degree == 1 else 4.0 * at[..., k] - 1.0
        for k, (a, b) in enumerate(self.ends if self.degree == 2 else (), corners):
            found[..., k, a], found[..., k, b] = 4.0 * at[..., b], 4.0 * at[..., a]
        return found

    @property
    def steepness(self) -> float:
        """Constant C of: integral of |grad u|^2 over a side <= C side/volume times that over the element.

        Warburton & Hesthaven 2003.
        """
        p, d = self.degree, self.dimension
        return p * (p + d - 1) / d

    @property
    def rule(self) -> tuple[Floats, Floats]:
        """Points (q, corners) and weights (q,), which sum to 1: exact to order 2 for degree 1, to 4 for degree 2."""
        return _rule(self.dimension, self.degree)

    @property
    def coarse_rule(self) -> tuple[Floats, Floats]:
        """Rule exact to order 2: enough for loads and stiffness of either degree (Ciarlet 1978, section 4.1)."""
        return _rule(self.dimension, 1)

    def side_rule(self) -> tuple[Floats, Floats]:
        """Points (sides, q, corners) on each side, and weights (q,), which sum to 1."""
        if self.dimension == 2:
            at = np.array(GAUSS)
            inner, weights = np.stack([1.0 - at, at], axis=1), np.array([5.0, 8.0, 5.0]) / 18.0
        else:
            inner, weights = _rule(2, self.degree)
        found = np.zeros((len(self.sides), len(weights), self.dimension + 1))
        for k, corners in enumerate(self.sides):
            found[k][:, corners] = inner
        return found, weights

    def side_nodes(self) -> list[list[int]]:
        """Nodes of each side: its corners, then the nodes on its edges."""
        corners = self.dimension + 1
        return [
            [*side, *(k for k, ends in enumerate(self.ends, corners) if self.degree == 2 and set(ends) <= set(side))]
            for side in self.sides
        ]


@cache
def _rule(dimension: int, degree: int) -> tuple[Floats, Floats]:
    if dimension == 3:
        if degree == 2:
            return fine_rule()
        near, far = (5.0 + 3.0 * 5.0**0.5) / 20.0, (5.0 - 5.0**0.5) / 20.0  # Hammer & Stroud 1956
        return np.full((4, 4), far) + (near - far) * np.eye(4), np.full(4, 0.25)
    if degree == 1:
        return np.full((3, 3), 1.0 / 6.0) + 0.5 * np.eye(3), np.full(3, 1.0 / 3.0)
    places, weights = [], []
    for one, weight in INNER:
        some = sorted(set(permutations((one, one, 1.0 - 2.0 * one))))
        places += some
        weights += [weight] * len(some)
    return np.array(places), np.array(weights)
