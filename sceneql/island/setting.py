"""The part of the scene that an island's assembly reads."""

from __future__ import annotations

from typing import Protocol

from sceneql.kinds import Object, Ref
from sceneql.quantities.expression import Expr, Link


class Setting(Protocol):
    """The part of the scene that an assembly reads."""

    @property
    def end(self) -> float:
        """End of the run [s]."""

    def object(self, ref: Ref) -> Object:
        """The kind of an object of the script."""

    def holder(self, ref: Ref) -> tuple[str, Object] | None:
        """The group that an object of the script is a member of, and its kind; None where it is in none."""

    def fluids(self, flow: str) -> tuple[tuple[float, float], ...]:
        """Density [kg/m^3] and viscosity [Pa s] of each other fluid that skins in a flow enclose (Model.fluid)."""

    def carrier(self, model: str) -> str | None:
        """The name of the flow that carries a model by a force; None where none does."""

    def laden(self, flow: str) -> bool:
        """Whether masses carried by a flow add to its inertia or reduce it (Model.burdens)."""

    def formula(self, link: Link) -> Expr | None:
        """A linked output as an expression of time; None for one of a model that is solved."""
