"""The state of an island as words see it: the offsets of its point masses, and a model's view at an instant."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sceneql.frame import Floats


@dataclass(frozen=True, slots=True)
class Bodies:
    """Point masses in an island's state, as offsets: body k has position y[position_at + 3k : +3] [m]."""

    model: str
    count: int
    position_at: int
    velocity_at: int
    """y[velocity_at + 3k : +3] [m/s]."""
    work_at: int
    """y[work_at]: energy [J] that drag, damping and impacts have taken out so far."""
    mass_at: int
    """floats[mass_at + k] [kg]."""
    inverse_at: int
    """floats[inverse_at + k]: 1/mass; 0 for a fixed body."""
    radius_at: int
    """floats[radius_at + k]: collision radius [m]."""
    period: float = float("inf")
    """Lower bound of the periods of the springs' oscillations at the start [s]; infinite without springs."""
    tied: Any = None
    """(m, 2) int: the bodies at the ends of these springs; None without springs."""


@dataclass(frozen=True, slots=True)
class ModelState:
    """A model's view of its island at an instant."""

    t: float
    y: Floats
    """(n,) the whole island."""
    rate: Floats
    """(n,) dy/dt."""
    floats: Floats
    bodies: Bodies | None
    ints: tuple[int, ...]
    """The integers that the word has stored by `Assembly.remember`."""
    potential: float = 0.0
    """Potential energy [J] of the model in the forces that act on it."""
