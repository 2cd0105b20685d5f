"""p1: four nodes, and one strain in all of the element."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.bodies.elements.element import Element

if TYPE_CHECKING:
    from sceneql.frame import Floats


class P1(Element):
    """Linear functions: places are those of the corners in proportion (Turner, Clough, Martin & Topp 1956)."""

    fastest = (2.9, 2.2)
    rule = (((0.25, 0.25, 0.25, 0.25),), (1.0,))

    @classmethod
    def functions(cls, places: Any) -> Floats:
        """The shape functions (q, 4): the barycentric coordinates themselves."""
        import numpy as np

        return np.asarray(places, dtype=float)

    @classmethod
    def slopes(cls, places: Any) -> Floats:
        """Derivatives (q, 4, 4): identity matrices."""
        import numpy as np

        return np.broadcast_to(np.eye(4), (len(places), 4, 4)).copy()
