"""p2: ten nodes, quadratic in between, with strains at four points."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.bodies.elements.element import Element

if TYPE_CHECKING:
    from sceneql.frame import Floats

NEAR, FAR = 0.5854101966249685, 0.1381966011250105
"""(5 + 3 sqrt(5))/20 and (5 - sqrt(5))/20, barycentric coordinates of a rule of degree 2 (Hammer & Stroud 1956)."""


class P2(Element):
    """Quadratic functions: L (2 L - 1) at corners, 4 L M on the edge of L and M (Zienkiewicz & Taylor 2000, 8.8)."""

    edges = True
    fastest = (10.5, 9.0)
    rule = (((NEAR, FAR, FAR, FAR), (FAR, NEAR, FAR, FAR), (FAR, FAR, NEAR, FAR), (FAR, FAR, FAR, NEAR)), (0.25,) * 4)

    @classmethod
    def functions(cls, places: Any) -> Floats:
        """The shape functions (q, 10) at barycentric points (q, 4): of corners, then of edges."""
        import numpy as np

        from sceneql.bodies.filling.tetrahedra import ENDS

        at = np.asarray(places, dtype=float)
        a, b = np.array(ENDS).T
        return np.concatenate([at * (2.0 * at - 1.0), 4.0 * at[:, a] * at[:, b]], axis=1)

    @classmethod
    def slopes(cls, places: Any) -> Floats:
        """Derivatives (q, 10, 4): of corners by their own barycentric coordinate, of edges by those of both ends."""
        import numpy as np

        from sceneql.bodies.filling.tetrahedra import ENDS

        at = np.asarray(places, dtype=float)
        found = np.zeros((len(at), 10, 4))
        for k in range(4):
            found[:, k, k] = 4.0 * at[:, k] - 1.0
        for k, (a, b) in enumerate(ENDS, 4):
            found[:, k, a], found[:, k, b] = 4.0 * at[:, b], 4.0 * at[:, a]
        return found
