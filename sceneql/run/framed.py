"""A run as cameras see it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.graph import SimulationGraph


class Framed(Protocol):
    """A run as cameras see it: the boxes of its parts over the film."""

    graph: SimulationGraph

    def boxes(self) -> Mapping[str, tuple[Floats, Floats]]:
        """Low and high corner (3,) [m] of each part over the whole run."""

    def bounds(self, names: Iterable[str]) -> tuple[Floats, Floats] | None:
        """Low and high corner (3,) [m] of what the parts draw over the whole run; without names of all that stays."""

    def outline(self) -> Floats:
        """Points (n, 3) [m] whose hull encloses all that is drawn and stays, over the whole run."""

    def standing(self) -> Floats:
        """Points (n, 3) [m] whose hull encloses all that does not change."""

    def moving(self, window: float | None) -> Floats:
        """Instants [s] and points [m], rows (n, 1 + 3), whose hull at each encloses all that moves and stays.

        ``window``: for how long at once a camera shows it [s], with all that stands; None: a camera shows it alone.
        """
