"""Rotation of rigid bodies: its state, terms and outputs."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Assembly, Bodies, ModelState, Turning

KERNELS = "sceneql.bodies.rigid.rigid_kernels"


def reserve(assembly: Assembly, bodies: Bodies, rotations: Floats, spins: Floats, inertias: Floats) -> Bodies:
    """Add rotation to bodies: quaternions and angular momenta in the state, their closing term, exact free motion.

    ``rotations`` (n, 4): unit quaternions that map the bodies' axes to the world's; ``spins`` (n, 3) [rad/s] in the
    world's axes; ``inertias`` (n, 3, 3) [kg m^2] about the centers of mass, in the bodies' axes. A body with inverse
    mass 0 does not rotate. Returns ``bodies`` with ``turning``.
    """
    import numpy as np

    from sceneql.shapes.placement import rotation_matrix
    from sceneql.system import Slopes, Turning

    n = bodies.count
    moving = assembly.numbers(bodies.inverse_at, bodies.inverse_at + n) > 0
    momenta, inverses, principal = np.zeros((n, 3)), np.zeros((n, 6)), np.zeros((n, 7))
    for k in np.flatnonzero(moving).tolist():
        turn = rotation_matrix(rotations[k])
        momenta[k] = turn @ inertias[k] @ turn.T @ spins[k]
        moments, axes = principal_axes(inertias[k])
        inverse = axes @ np.diag(1.0 / moments) @ axes.T
        inverses[k] = packed(0.5 * (inverse + inverse.T))
        principal[k] = [*moments, *quaternion(axes)]
    rotation_at = assembly.state(np.concatenate([np.ravel(rotations), np.ravel(momenta)]))
    momentum_at = rotation_at + 4 * n
    for k in range(n):
        assembly.alike(rotation_at + 4 * k, 4)
        assembly.alike(momentum_at + 3 * k, 3)
    turning = Turning(rotation_at, momentum_at, assembly.floats(inverses), assembly.floats(principal))
    ints = (n, rotation_at, momentum_at, turning.inverse_at, turning.principal_at)

    def slopes() -> Slopes:
        from sceneql.bodies.rigid.rigid_slopes_kernels import ENTRIES

        each, entry = np.divmod(np.arange(ENTRIES * n), ENTRIES)
        row, column = np.divmod(entry, 7)
        columns = np.where(column < 4, rotation_at + 4 * each + column, momentum_at + 3 * each + column - 4)
        return Slopes("sceneql.bodies.rigid.rigid_slopes_kernels:close", rotation_at + 4 * each + row, columns)

    assembly.term("close", f"{KERNELS}:close", ints, slopes, apart=True)
    assembly.after_step(f"{KERNELS}:settle", ints, apart=True, samples=True)
    assembly.free_motion("sceneql.bodies.rigid.free_motion_kernels:turn", ints, rotation_at, 4 * n)
    return replace(bodies, turning=turning)


def principal_axes(inertia: Floats) -> tuple[Floats, Floats]:
    """Principal moments of inertia (3,), ascending, and their axes as the columns of a rotation matrix (3, 3).

    A diagonal inertia keeps its axes and their order, without rounding.
    """
    import numpy as np

    if not np.any(inertia - np.diag(np.diag(inertia))):
        return np.diag(inertia).copy(), np.eye(3)
    moments, axes = np.linalg.eigh(inertia)
    return moments, axes * np.sign(np.linalg.det(axes))


def packed(matrix: Floats) -> Floats:
    """Components xx, yy, zz, yz, xz, xy (6,) of a symmetric matrix (3, 3)."""
    return matrix[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]]


def unpacked(numbers: Floats) -> Floats:
    """Symmetric matrices (..., 3, 3) from their components xx, yy, zz, yz, xz, xy (..., 6)."""
    import numpy as np

    return np.asarray(numbers)[..., [0, 5, 4, 5, 1, 3, 4, 3, 2]].reshape(*np.shape(numbers)[:-1], 3, 3)


def quaternion(matrix: Floats) -> Floats:
    """The unit quaternion (4,) [w, x, y, z] of a rotation matrix (3, 3); w is not negative."""
    import numpy as np

    m = matrix
    # The eigenvector of the largest eigenvalue (Bar-Itzhack 2000), equally accurate for all rotations.
    symmetric = np.array(
        [
            [m[0, 0] + m[1, 1] + m[2, 2], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0]],
            [m[0, 2] - m[2, 0], m[0, 1] + m[1, 0], m[1, 1] - m[0, 0] - m[2, 2], m[1, 2] + m[2, 1]],
            [m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], m[2, 2] - m[0, 0] - m[1, 1]],
        ]
    )
    found: Floats = np.linalg.eigh(symmetric)[1][:, 3]
    return found if found[0] >= 0 else -found


def rotations(turning: Turning, count: int, state: ModelState) -> Floats:
    """Unit quaternions (n, 4) [w, x, y, z] from the bodies' axes to the world's."""
    import numpy as np

    q = state.y[turning.rotation_at : turning.rotation_at + 4 * count].reshape(-1, 4)
    found: Floats = q / np.linalg.norm(q, axis=1)[:, None]
    return found


def matrices(turning: Turning, count: int, state: ModelState) -> Floats:
    """Rotation matrices (n, 3, 3) from the bodies' axes to the world's."""
    import numpy as np

    from sceneql.shapes.placement import rotation_matrix

    return np.array([rotation_matrix(q) for q in rotations(turning, count, state)]).reshape(-1, 3, 3)


def momenta(turning: Turning, count: int, state: ModelState) -> Floats:
    """Angular momenta (n, 3) [kg m^2/s] about the centers of mass, in the world's axes."""
    return state.y[turning.momentum_at : turning.momentum_at + 3 * count].reshape(-1, 3)


def own_momentum(turning: Turning, count: int, state: ModelState) -> Floats:
    """Sum (3,) [kg m^2/s] of the angular momenta about the bodies' own centers of mass."""
    found: Floats = momenta(turning, count, state).sum(axis=0)
    return found


def body_spins(turning: Turning, count: int, state: ModelState) -> Floats:
    """Angular velocities (n, 3) [rad/s] in the bodies' axes."""
    import numpy as np

    inverses = unpacked(state.floats[turning.inverse_at : turning.inverse_at + 6 * count].reshape(-1, 6))
    turns = matrices(turning, count, state)
    found: Floats = np.einsum("nij,nkj,nk->ni", inverses, turns, momenta(turning, count, state))
    return found


def spins(turning: Turning, count: int, state: ModelState) -> Floats:
    """Angular velocities (n, 3) [rad/s] in the world's axes."""
    import numpy as np

    found: Floats = np.einsum("nij,nj->ni", matrices(turning, count, state), body_spins(turning, count, state))
    return found


def rotation_energy(turning: Turning, count: int, state: ModelState) -> float:
    """Kinetic energy [J] of the rotation: half the sum of angular velocity times angular momentum."""
    import numpy as np

    return 0.5 * float(np.sum(spins(turning, count, state) * momenta(turning, count, state)))
