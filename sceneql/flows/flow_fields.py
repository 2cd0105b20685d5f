"""The fields of the word `flow` that its terms are made by."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from sceneql.flows.parts import Side, Start
    from sceneql.kinds import Formula, Ref


class Model(Protocol):
    """The fields of the word `flow` that its terms are made by."""

    @property
    def boundary(self) -> Mapping[str, Side]:
        """What holds on its sides."""

    @property
    def density(self) -> float:
        """[kg/m^3]"""

    @property
    def viscosity(self) -> Formula:
        """[Pa s]"""

    @property
    def initial(self) -> Start | None:
        """The flow at the start."""

    @property
    def advection(self) -> str:
        """A name of SCHEMES."""

    @property
    def around(self) -> tuple[Ref, ...]:
        """Solids in it."""

    @property
    def domain(self) -> Ref | None:
        """The object that it fills, where it is no box."""

    @property
    def edges(self) -> str:
        """How cells meet these."""

    @property
    def pressure(self) -> str:
        """How it is solved for."""

    @property
    def force(self) -> Formula | None:
        """On each cubic meter [N/m^3]."""
