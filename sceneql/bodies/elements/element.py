"""What an element is: its nodes, its functions, and the points at which its strain is looked at."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from sceneql.bodies.elements.named import named

if TYPE_CHECKING:
    from sceneql.frame import Floats

Rule = tuple[tuple[tuple[float, ...], ...], tuple[float, ...]]
"""Places by their barycentric coordinates, and weights of sum 1."""


class Element:
    """A tetrahedron with functions by which places between its nodes follow these.

    Nodes are first the corners, then those on the edges in the order of filling.tetrahedra.ENDS.
    """

    edges: ClassVar[bool] = False
    """Whether a node stands on each edge."""
    mean: ClassVar[bool] = False
    """Whether its dilatation is one number, the mean over the element."""
    rule: ClassVar[Rule]
    """The points at which the strain is looked at."""

    @classmethod
    def nodes(cls) -> int:
        """How many it has."""
        return 10 if cls.edges else 4

    @classmethod
    def functions(cls, places: Any) -> Floats:
        """(q, nodes) the functions at barycentric places (q, 4)."""
        raise NotImplementedError

    @classmethod
    def slopes(cls, places: Any) -> Floats:
        """(q, nodes, 4) their derivatives by the barycentric coordinates."""
        raise NotImplementedError


def elements() -> dict[str, type[Element]]:
    """All of them by name."""
    return named("sceneql.bodies.elements", "Element")
