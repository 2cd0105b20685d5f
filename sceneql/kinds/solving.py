"""The family of solvers, which integrate islands in time."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from sceneql.failure import Unsuitable
from sceneql.kinds.types import ModelRef
from sceneql.kinds.word import Kind, field

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import IslandFacts, Stepper


@dataclasses.dataclass(frozen=True, slots=True)
class Methods:
    """The methods for one island: the first one, and those that may replace it during the run."""

    solver: Solver = dataclasses.field(compare=False)
    """The solver whose methods these are; without ``bounded_by`` its `growth` also gives their stability."""
    first: Stepper
    stiff: Stepper | None = None
    """A stiff method to which the march switches, and back, where stability limits the steps of ``first``
    (Method.stability)."""
    stiff_cost: float | None = None
    """Cost of a step of ``stiff``, in explicit steps of six rates; None: by the number of unknowns."""
    otherwise: Stepper | None = None
    """A method that replaces ``first`` for good at the first step of given length for which ``first`` finds no
    solution."""
    remark: str = ""
    """When ``otherwise`` takes over, as text for `explain`."""
    bounded_by: Solver | None = dataclasses.field(default=None, compare=False)
    """The solver whose `growth` gives the stability of ``first``, where it is not ``solver``'s."""

    @property
    def bounding(self) -> Solver:
        """The solver whose `growth` gives the stability of ``first``."""
        return self.bounded_by or self.solver


class Solver(Kind):
    """Integrates a system in time. It sees only the rate, Jacobian, invariants and events of the system."""

    family: ClassVar[str] = "solvers"
    marches: ClassVar[Literal["anything", "a field", "a flow", "several fluids"]] = "anything"
    """Kind of island that it solves: any, one field on a grid, one with a flow, or one with several fluids."""
    static: ClassVar[bool] = False
    """Whether it finds static equilibria, without motion in time."""
    refuses_contacts: ClassVar[str] = ""
    """Why it marches no models that collide; empty: it does."""
    refuses_ties: ClassVar[str] = ""
    """Why it refuses bodies held by ties; empty where it does not."""

    on: tuple[ModelRef, ...] | None = field("The models it marches; by default all.", None)

    def explanation(self) -> str:
        """Text on the chosen method and the reason; empty if it makes no choice."""
        return ""

    def measure(self) -> str:
        """The scale that its tolerance is relative to, as text for `explain`.

        Empty where no tolerance controls its steps.
        """
        tolerance, absolute = (getattr(self, name, None) for name in ("tolerance", "absolute"))
        if tolerance is None or "absolute" not in type(self).model_fields:
            return ""
        return f"of an entry plus {tolerance if absolute is None else absolute} in SI units"

    def stepper(self) -> Stepper:
        """Its compiled step and control."""
        raise NotImplementedError

    def choose(self, island: IslandFacts) -> Methods:
        """The methods for an island: its own stepper, unless that depends on the island."""
        return Methods(self, self.stepper())

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """Spectral radius of one step [s] on the linear system y' = jacobian y: its largest growth factor.

        ``partner`` (n,) int: for a position entry of y the index of its velocity, else -1. Raises Unsuitable where the
        solver does not define it.
        """
        word = type(self).__module__.rpartition(".")[2]
        raise Unsuitable(f"`{word}` does not tell its growth, so nothing is known of its stable step")

    def solves_tensions(self) -> bool:
        """Whether it marches the tensions of flat skins implicitly beyond their bound."""
        return False

    def explicit_by_tolerance(self) -> bool:
        """Whether it is explicit, its steps by a tolerance: stiffness then costs steps, of which `check` warns."""
        return False

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float | None:
        """Growth factor of a fixed step on x'' = -frequency^2 x - (decay - i turn) x', in plain Python for `check`.

        None where no bound is known before the run: implicit methods, and steps that follow a tolerance.
        """
        return None
