"""The state of an island as words see it: the offsets of its masses, and a model's view at an instant."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system.fields import Membrane


@dataclass(frozen=True, slots=True)
class Turning:
    """How rigid bodies turn, as offsets: body k has the quaternion y[rotation_at + 4k : +4], [w, x, y, z].

    It turns the body's axes to the world's; only its direction counts.
    """

    rotation_at: int
    momentum_at: int
    """y[momentum_at + 3k : +3]: angular momentum about the center of mass, in the world's axes [kg m^2/s]."""
    inverse_at: int
    """floats[inverse_at + 6k : +6]: inverse of the inertia about the center of mass, in the body's axes, its xx, yy,
    zz, yz, xz, xy [1/(kg m^2)]; 0 for a fixed body."""
    principal_at: int
    """floats[principal_at + 7k : +7]: principal moments of inertia [kg m^2], then the quaternion that turns their axes
    to the body's; the moments of a body without a free motion of its own are 0."""


@dataclass(frozen=True, slots=True, eq=False)
class Skin:
    """The surface of a solid between its masses, which nothing passes."""

    triangles: Any
    """(k, 3) int: bodies, counterclockwise from outside."""
    held: Any
    """(bodies, 3) bool: components that do not move freely."""
    stiffness: float
    """Its elastic modulus [Pa]: the pressure at which a barrier lets through half a gap or so."""


@dataclass(frozen=True, slots=True, eq=False)
class Springs:
    """Springs between masses at the start."""

    ends: Any
    """(m, 2) int: the bodies at their ends."""
    strength: Any
    """(2, m): stiffness [N/m], and damping [N s/m]."""
    period: float
    """Lower bound of the periods of oscillations [s]."""


@dataclass(frozen=True, slots=True)
class Immersed:
    """Masses that a flow carries."""

    points: Membrane
    """What moves as the flow does, for contacts."""
    excess_at: int
    """floats[excess_at + k]: mass less that of the fluid whose place it takes [kg], which it weighs."""


@dataclass(frozen=True, slots=True)
class Bodies:
    """Masses in an island's state, as offsets: body k has its center of mass at y[position_at + 3k : +3] [m]."""

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
    springs: Springs | None = None
    """The springs between them; None without."""
    turning: Turning | None = None
    """How they turn; None for point masses."""
    skin: Skin | None = None
    """The surface that they span; None for masses alone."""
    immersed: Immersed | None = None
    """What a flow carries of them, whose velocities then are the flow's there; None where none does."""

    @property
    def weighed_at(self) -> int:
        """floats[weighed_at + k]: what gravity acts on [kg]."""
        return self.mass_at if self.immersed is None else self.immersed.excess_at


@dataclass(frozen=True, slots=True)
class Place:
    """Where a force acts: a mass, or a place on a rigid body."""

    bodies: Bodies
    body: int
    """Its number among these."""
    arm_at: int = -1
    """floats[arm_at : +3]: the place in the body's axes, from the center of mass [m]; -1: the center itself."""

    @property
    def ints(self) -> tuple[int, int, int, int, int, int, int, int]:
        """For kernels (bodies/rigid/place_kernels.py): offsets of position and velocity in y, of the work in y, of the
        inverse mass; of the quaternion and the angular momentum in y, of the inverse inertia, of the arm: or -1."""
        bodies, k, turning = self.bodies, self.body, self.bodies.turning
        center = (bodies.position_at + 3 * k, bodies.velocity_at + 3 * k, bodies.work_at, bodies.inverse_at + k)
        if turning is None:
            return (*center, -1, -1, -1, -1)
        turns = (turning.rotation_at + 4 * k, turning.momentum_at + 3 * k, turning.inverse_at + 6 * k)
        return (*center, *turns, self.arm_at)


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
