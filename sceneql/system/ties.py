"""Ties between two bodies, as their words hand them to an island."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from sceneql.system.state import Place

if TYPE_CHECKING:
    from sceneql.kinds.values import Value
    from sceneql.quantities.span import Span

Triple = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Led:
    """A part that moves by itself, as offsets of its values in the floats."""

    position_at: int
    rotation_at: int
    velocity_at: int
    spin_at: int
    acceleration_at: int
    twist_at: int
    """Angular acceleration."""


Mover = Place | Led | None
"""A body that is solved (its arm does not count), a part that is led, or the world."""


@dataclass(frozen=True, slots=True)
class TieRow:
    """A condition between two movers a and b, whose vectors are fixed in the axes of one of them.

    `point`: n_b . (x_a + r_a - x_b - r_b) = 0, its vectors r_a, r_b, n_b; `angle`: u_a . w_b = constant, its vectors
    u_a, w_b; `distance`: |x_a + r_a - x_b - r_b| = constant, its vectors r_a, r_b; `gear`: the angles of both about
    axes of the world, times the constants, sum to full turns; its vectors are, of each, the axis, a direction across it
    at the start, and that direction in its own axes. Places are from the movers' positions [m].
    """

    kind: Literal["point", "angle", "distance", "gear"]
    vectors: tuple[Triple, ...]
    constants: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Drive:
    """Stops, a motor and dry friction along the one motion that a tie leaves, as offsets in the floats (-1: none)."""

    along: tuple[int, ...]
    """Integers of the motion (bodies/rigid/drive_kernels.py)."""
    limits_at: int
    """The least and the greatest that the motion goes [m or rad]."""
    restitution_at: int
    follows: Literal["nothing", "speed", "place"]
    target: Value | None
    """What the motor follows."""
    target_at: int
    most_at: int
    """Its largest force or torque."""
    settling_at: int
    """The time in which it takes an error of the place away [s]."""
    reached_at: int
    """The place that it followed last."""
    friction_at: int
    """Largest force or torque of the friction."""
    effort_at: int
    """What all of these do along the motion, on the first body; the steps in which that was not found exactly; the
    energy that the motor gave; whether they are found with exact contacts (1), or by steps of velocities."""

    @property
    def always(self) -> bool:
        """Whether it acts in every step, and not at stops alone."""
        return self.follows != "nothing" or self.friction_at >= 0


@dataclass(frozen=True, slots=True)
class Tied:
    """The rows of a tie."""

    movers: tuple[Mover, Mover]
    rows: tuple[TieRow, ...]
    scratch_at: int
    """Offset in the floats of what its rows write there (bodies/rigid/tie_rows_kernels.py)."""
    holds_at: int
    """floats[holds_at]: 1 while it holds, 0 once it is broken."""
    drive: Drive | None = None
    """What acts along the motion that it leaves in bounds, found by the step."""
    name: str = ""
    span: Span | None = None
