"""p2_mean: ten nodes and one mean dilatation, for solids that hardly change their volume."""

from __future__ import annotations

from sceneql.bodies.elements.element import Element
from sceneql.bodies.elements.p2 import P2


class P2Mean(Element):
    """As p2, but its dilatation is that of the element as a whole (Nagtegaal, Parks & Rice 1974): it does not lock."""

    edges = True
    mean = True
    fastest = (8.4, 6.9)
    rule = P2.rule
    functions = P2.functions
    slopes = P2.slopes
