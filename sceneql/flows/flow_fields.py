"""Protocol of the word `flow`: the script fields that its assembly reads."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from sceneql.flows.parts import Side, Start
    from sceneql.kinds import Formula, Ref


class Model(Protocol):
    """The script fields of the word `flow` that its assembly reads."""

    @property
    def boundary(self) -> Mapping[str, Side]:
        """Boundary conditions by name of the side, part or solid."""

    @property
    def density(self) -> float:
        """Density [kg/m^3] of the fluid."""

    @property
    def viscosity(self) -> Formula:
        """Dynamic viscosity [Pa s]."""

    @property
    def initial(self) -> Start | None:
        """Velocity or stream function at the start; None: at rest."""

    @property
    def advection(self) -> str:
        """Name of the advection scheme (assembly.SCHEMES)."""

    @property
    def around(self) -> tuple[Ref, ...]:
        """Solids that the fluid flows around."""

    @property
    def domain(self) -> Ref | None:
        """The object whose inside the fluid fills, in place of a box."""

    @property
    def edges(self) -> str:
        """How cells meet solids: cut_cell or staircase."""

    @property
    def pressure(self) -> str:
        """Name of the linear solver of the pressure equation."""

    @property
    def force(self) -> Formula | None:
        """Force density [N/m^3]."""
