"""Solvers: what marches an island in time."""

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
    """What marches an island: a method to begin with, and those that may take its place during the run."""

    solver: Solver = dataclasses.field(compare=False)
    """The word whose methods these are, and, without ``bounded_by``, whose `growth` tells their stability."""
    first: Stepper
    stiff: Stepper | None = None
    """What the march goes to, and back from, where stability holds the steps of ``first`` (Method.stability)."""
    otherwise: Stepper | None = None
    """What takes over for good from the first step of a given length on that ``first`` finds no solution of."""
    remark: str = ""
    """When it takes over, for `explain`."""
    bounded_by: Solver | None = dataclasses.field(default=None, compare=False)
    """The word whose `growth` tells the stability of ``first``, where that is not ``solver``'s."""

    @property
    def bounding(self) -> Solver:
        """The word whose `growth` tells the stability of ``first``."""
        return self.bounded_by or self.solver


class Solver(Kind):
    """Marches a system in time. Sees only its rate, its Jacobian, its invariants and its events."""

    family: ClassVar[str] = "solvers"
    marches: ClassVar[Literal["anything", "a field", "a flow", "several fluids"]] = "anything"
    """What it is for: islands of any kind, those that are one field on a grid, those with a flow, or of several."""
    static: ClassVar[bool] = False
    """Whether it finds rests, without motion in time."""
    refuses_ties: ClassVar[str] = ""
    """Why it does not march bodies that ties hold; empty where it does."""

    on: tuple[ModelRef, ...] | None = field("The models it marches; by default all.", None)

    def explanation(self) -> str:
        """What it chose to do and why, where it chooses a method by itself."""
        return ""

    def measure(self) -> str:
        """What its tolerance is a part of, for `explain`, where that chooses its steps."""
        tolerance, absolute = (getattr(self, name, None) for name in ("tolerance", "absolute"))
        if tolerance is None or "absolute" not in type(self).model_fields:
            return ""
        return f"of an entry plus {tolerance if absolute is None else absolute} in SI units"

    def stepper(self) -> Stepper:
        """Its compiled step and control."""
        raise NotImplementedError

    def choose(self, island: IslandFacts) -> Methods:
        """What marches an island: its own step, unless that depends on the island."""
        return Methods(self, self.stepper())

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """Largest growth factor of a step of the linear system y' = jacobian y (its spectral radius).

        ``partner`` (n,) int: for a position entry of y the index of its velocity, else -1. Raises Unsuitable for a
        word that does not tell it.
        """
        word = type(self).__module__.rpartition(".")[2]
        raise Unsuitable(f"`{word}` does not tell its growth, so nothing is known of its stable step")

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float | None:
        """Growth factor of a fixed step on x'' = -frequency^2 x - (decay - i turn) x', in plain Python for `check`.

        None where no bound is told before the run: implicit methods, and those whose steps follow a tolerance.
        """
        return None
