"""Surfaces between which a barrier acts: of elastic solids, cloth and rigid bodies. Imports numpy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.system import Assembly, Bodies, Skin

FIXED = -1


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Triangulated surface of an elastic solid, a net of springs or a rigid body."""

    model: str
    number: int
    """Number of the model: 0 or more if elastic or cloth, FIXED for fixed rigid bodies, less for those that move."""
    places: NDArray[int64]
    """(n, 8): system.Place.ints of the vertices."""
    held: NDArray[int64]
    """(n, 3): 1 for components that do not move freely."""
    at: Floats
    """(n, 3) [m]: positions of the vertices at the start."""
    triangles: NDArray[int64]
    """(m, 3): vertices, counterclockwise from outside."""
    stiffness: float
    """[Pa], as in system.Skin; infinite for a rigid body."""

    @property
    def rigid(self) -> bool:
        """Whether this is the surface of a rigid body."""
        return self.number < 0


def soft_skin(bodies: Bodies) -> Skin | None:
    """The skin of an elastic solid, or the faces of a net of springs; None for other masses and rigid bodies."""
    if bodies.skin is None and bodies.springs is not None:
        return None if bodies.springs.faces is None else bodies.springs.faces()
    return bodies.skin


def soft_surfaces(everyone: Sequence[Bodies], assembly: Assembly) -> list[Surface]:
    """Surfaces of elastic solids, and of nets of springs that have faces."""
    found = []
    for number, bodies in enumerate(everyone):
        skin = soft_skin(bodies)
        assert skin is not None
        nodes, which = np.unique(skin.triangles, return_inverse=True)
        places = np.full((len(nodes), 8), -1, dtype=np.int64)
        places[:, 0], places[:, 1] = bodies.position_at + 3 * nodes, bodies.velocity_at + 3 * nodes
        places[:, 2], places[:, 3] = bodies.work_at, bodies.inverse_at + nodes
        held = np.asarray(skin.held[nodes], dtype=np.int64)
        at = assembly.start()[bodies.position_at :][: 3 * bodies.count].reshape(-1, 3)[nodes]
        triangles = which.reshape(-1, 3).astype(np.int64)
        found.append(Surface(bodies.model, number, places, held, at, triangles, skin.stiffness))
    return found


def rigid_surfaces(everyone: Sequence[Bodies], side: float, assembly: Assembly) -> list[Surface]:
    """Surfaces of rigid bodies, with edges of not much more than ``side`` [m].

    Raises ScriptError for a body without a surface, and for one with ties.
    """
    from sceneql.contacts.barrier.rigid_triangles import triangles_of
    from sceneql.contacts.colliders import must_be_free
    from sceneql.kinds import Ref
    from sceneql.shapes.placement import rotation_matrix
    from sceneql.system import Place

    found = []
    moving, start, numbers = 0, assembly.start(), assembly.numbers()
    for bodies in everyone:
        turning = bodies.turning
        assert turning is not None
        must_be_free(bodies.model, assembly)
        model: Any = assembly.object(Ref(bodies.model))
        for k, (ref, center) in enumerate(model.solids()):
            points, triangles = triangles_of(ref, np.asarray(center), side, assembly)
            fixed = numbers[bodies.inverse_at + k] == 0.0
            moving += not fixed
            arms = assembly.floats(points)
            places = np.array([Place(bodies, k, arms + 3 * i).ints for i in range(len(points))], dtype=np.int64)
            held = np.full((len(points), 3), int(fixed), dtype=np.int64)
            x = start[bodies.position_at + 3 * k :][:3]
            turn = rotation_matrix(start[turning.rotation_at + 4 * k :][:4])
            at = x + points @ turn.T
            found.append(Surface(bodies.model, FIXED - moving * (not fixed), places, held, at, triangles, np.inf))
    return found
