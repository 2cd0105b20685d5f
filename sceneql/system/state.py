"""The state of an island as words see it: the offsets of its masses, and a model's view at an instant."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from sceneql.frame import Floats
    from sceneql.system.fields import Membrane


@dataclass(frozen=True, slots=True)
class Turning:
    """Orientation and inertia of rigid bodies, as offsets.

    Body k has the quaternion y[rotation_at + 4k : +4], [w, x, y, z], which rotates body axes to world axes. Only its
    direction counts; its length may drift.
    """

    rotation_at: int
    momentum_at: int
    """y[momentum_at + 3k : +3]: angular momentum about the center of mass, in world axes [kg m^2/s]."""
    inverse_at: int
    """floats[inverse_at + 6k : +6]: inverse inertia tensor about the center of mass in body axes, components xx, yy,
    zz, yz, xz, xy [1/(kg m^2)]; 0 for a fixed body."""
    principal_at: int
    """floats[principal_at + 7k : +7]: principal moments of inertia [kg m^2], then the quaternion from principal to body
    axes; the moments are 0 for a body that does not move freely."""


@dataclass(frozen=True, slots=True, eq=False)
class Skin:
    """The triangulated surface of a solid, whose vertices are masses; contacts let nothing pass through it."""

    triangles: Any
    """(k, 3) int: vertices of the triangles as numbers of bodies, counterclockwise from outside."""
    held: Any
    """(bodies, 3) bool: components of the position that do not move freely."""
    stiffness: float
    """The elastic modulus of what it covers [Pa]: about the pressure at which a barrier closes half its gap."""


@dataclass(frozen=True, slots=True, eq=False)
class Springs:
    """Springs between masses at the start."""

    ends: Any
    """(m, 2) int: the bodies at their ends."""
    strength: Any
    """(2, m): stiffness [N/m] and damping [N s/m] of each spring."""
    period: float
    """Lower bound of the oscillation periods [s]."""
    faces: Callable[[], Skin] | None = None
    """The surface of their net, for contacts by a barrier; None without."""


@dataclass(frozen=True, slots=True)
class Immersed:
    """Masses that a flow carries."""

    points: Membrane
    """These masses as points that move with the fluid, for contacts."""
    excess_at: int
    """floats[excess_at + k]: mass minus that of the displaced fluid [kg], on which gravity acts."""


@dataclass(frozen=True, slots=True)
class Bodies:
    """Masses in an island's state, as offsets: body k has its center of mass at y[position_at + 3k : +3] [m]."""

    model: str
    count: int
    position_at: int
    velocity_at: int
    """y[velocity_at + 3k : +3] [m/s]."""
    work_at: int
    """y[work_at]: energy [J] dissipated so far by drag, damping and impacts."""
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
    """Their surface, where they are vertices of a solid; None for masses alone."""
    immersed: Immersed | None = None
    """These masses as carried by a flow, whose velocity at their positions is theirs; None where no flow carries
    them."""

    @property
    def weighed_at(self) -> int:
        """floats[weighed_at + k]: mass on which gravity acts [kg]; in a flow, less that of the displaced fluid."""
        return self.mass_at if self.immersed is None else self.immersed.excess_at


@dataclass(frozen=True, slots=True)
class Place:
    """Point of application of a force: a mass, or a point of a rigid body."""

    bodies: Bodies
    body: int
    """Index of the mass or body in ``bodies``."""
    arm_at: int = -1
    """floats[arm_at : +3]: the point relative to the center of mass in body axes [m]; -1: the center of mass itself."""

    @property
    def ints(self) -> tuple[int, int, int, int, int, int, int, int]:
        """Offsets for kernels (bodies/rigid/place_kernels.py), eight in all.

        Position, velocity and work in y, inverse mass in the floats; then quaternion and angular momentum in y, inverse
        inertia and arm in the floats, each -1 where there is none.
        """
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
    """(n,) state of the whole island."""
    rate: Floats
    """(n,) dy/dt."""
    floats: Floats
    bodies: Bodies | None
    ints: tuple[int, ...]
    """The integers that the word has stored by `Assembly.remember`."""
    potential: float = 0.0
    """Potential energy [J] of the model in the forces that act on it."""
