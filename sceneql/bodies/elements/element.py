"""Base class of finite elements: nodes, shape functions, and integration points."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from sceneql.bodies.elements.named import named

if TYPE_CHECKING:
    from sceneql.frame import Floats

Rule = tuple[tuple[tuple[float, ...], ...], tuple[float, ...]]
"""A quadrature rule: points by their barycentric coordinates, and weights of sum 1."""


class Element:
    """A tetrahedral element with shape functions.

    Its nodes are first the corners, then one on each edge in the order of filling.tetrahedra.ENDS, if there are any.
    """

    edges: ClassVar[bool] = False
    """Whether each edge has a node."""
    mean: ClassVar[bool] = False
    """Whether the dilatation is replaced by its mean over the element."""
    fastest: ClassVar[tuple[float, float]]
    """Least fastest angular frequency, over speed of pressure waves by spacing, in objects and in blocks: measured, for
    Poisson ratios from -0.5 to 0.49, in objects of 24 elements on and cells to 10:1; fine ones swing twice as fast."""
    rule: ClassVar[Rule]
    """The integration points, at which strain and stress are evaluated, and their weights."""

    @classmethod
    def nodes(cls) -> int:
        """Number of nodes."""
        return 10 if cls.edges else 4

    @classmethod
    def functions(cls, places: Any) -> Floats:
        """Values (q, nodes) of the shape functions at points with barycentric coordinates (q, 4)."""
        raise NotImplementedError

    @classmethod
    def slopes(cls, places: Any) -> Floats:
        """Derivatives (q, nodes, 4) of the shape functions by the barycentric coordinates, at points (q, 4)."""
        raise NotImplementedError


def elements() -> dict[str, type[Element]]:
    """All kinds of elements, by name."""
    return named("sceneql.bodies.elements", "Element")
