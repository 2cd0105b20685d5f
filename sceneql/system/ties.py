"""Ties between two bodies, as their words hand them to an island."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from sceneql.system.state import Place

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
class Tied:
    """The rows of a tie."""

    movers: tuple[Mover, Mover]
    rows: tuple[TieRow, ...]
    scratch_at: int
    """Offset in the floats of what its rows write there (bodies/rigid/tie_rows_kernels.py)."""
    holds_at: int
    """floats[holds_at]: 1 while it holds, 0 once it is broken."""
