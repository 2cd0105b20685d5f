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
    """An object whose motion is prescribed, as offsets of its values in the floats."""

    position_at: int
    rotation_at: int
    velocity_at: int
    spin_at: int
    acceleration_at: int
    twist_at: int
    """Angular acceleration (3,) [rad/s^2]."""


Mover = Place | Led | None
"""A body of the state (its arm does not count), an object with a prescribed motion, or None for the world."""


@dataclass(frozen=True, slots=True)
class TieRow:
    """A scalar constraint between two movers a and b, with constant vectors in the axes of one of them.

    `point`: n_b . (x_a + r_a - x_b - r_b) = 0 with vectors r_a, r_b, n_b; `angle`: u_a . w_b = constant with vectors
    u_a, w_b; `ball`: x_a + r_a = x_b + r_b with vectors r_a, r_b, in three rows, of which two are `written` with the
    first; `distance`: |x_a + r_a - x_b - r_b| = constant with vectors r_a, r_b; `gear`: the rotation angles of both
    about axes of the world, times the constants, sum to full turns; the vectors are, for each mover, the axis, a
    direction across it at the start, and that direction in its own axes, then the axles r_a, r_b and the line from the
    one to the other at the start, against which both turn, with its length as the third constant (0: they turn against
    the world); `carried`: the same with axes n_a, n_b that the movers carry, each against what both axles are in, with
    vectors n_a, n_b, what the wheels count from at the start, the axles r_a, r_b, and the line's length as the third
    constant (0: each counts against the axis of the other). r are relative to the movers' positions [m].
    """

    kind: Literal["point", "angle", "distance", "gear", "ball", "written", "carried"]
    vectors: tuple[Triple, ...] = ()
    constants: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Drive:
    """Stops, motor and dry friction along the one motion that a tie leaves, as offsets in the floats (-1: none)."""

    along: tuple[int, ...]
    """Integers of the degree of freedom (bodies/rigid/drive_kernels.py)."""
    limits_at: int
    """Its lower and upper limit [m or rad]."""
    restitution_at: int
    follows: Literal["nothing", "speed", "place"]
    target: Value | None
    """The set point of the motor: a speed or a place."""
    target_at: int
    most_at: int
    """Largest force [N] or torque [N m] of the motor."""
    settling_at: int
    """Time constant with which the motor corrects an error of the place [s]."""
    reached_at: int
    """The set point of the place in the previous step."""
    friction_at: int
    """Largest force [N] or torque [N m] of the friction."""
    effort_at: int
    """Four numbers: the resultant of stops, motor and friction on the first body; in how many steps it was not found
    exactly; the energy that the motor gave [J]; whether it is solved with exact contacts (1), or by steps of
    velocities."""

    @property
    def always(self) -> bool:
        """Whether the drive acts in every step, and not only at stops."""
        return self.follows != "nothing" or self.friction_at >= 0


@dataclass(frozen=True, slots=True)
class Tied:
    """A tie: its two movers, its constraint rows and its drive."""

    movers: tuple[Mover, Mover]
    rows: tuple[TieRow, ...]
    scratch_at: int
    """Offset in the floats of the rows' scratch (bodies/rigid/tie_rows_kernels.py)."""
    holds_at: int
    """floats[holds_at]: 1 while it holds, 0 once it is broken."""
    drive: Drive | None = None
    """Stops, motor and friction along its degree of freedom, solved within the step; None: none of these."""
    name: str = ""
    span: Span | None = None
