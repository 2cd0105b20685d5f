"""The Hausdorff distance between triangles and the surface that they stand for, by samples. Imports numpy and scipy."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from sceneql.field.tape.tape_solid import field_values, many_gradients

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints, Tape
    from sceneql.mesh.polygons import Polygons

STEPS = 12
"""Newton steps from a sample to the surface."""


class Hausdorff(NamedTuple):
    """Largest distances [m] found at samples: lower bounds of the true ones."""

    to_surface: float
    """Largest distance from points on the triangles to the surface."""
    to_mesh: float
    """Largest distance from points on the surface to the triangles."""

    @property
    def distance(self) -> float:
        """The larger of both."""
        return max(self)


def hausdorff(polygons: Polygons, tape: Tape, samples: int = 20_000) -> Hausdorff:
    """Distances between a mesh and the surface {tape = 0}, at sample points spread over the mesh by area.

    Newton's method moves each point along the gradient to a foot on the surface; the length of the move is the point's
    distance, at edges of the solid a little more. The distance of the foot from the mesh is measured in turn. Surface
    far from all triangles is not found. Samples are the same in each call. Raises ValueError for a mesh without
    triangles.
    """
    import numpy as np

    from sceneql.mesh.distance import distances

    if not len(polygons.triangles):
        raise ValueError("a mesh without triangles is no distance from anything")
    points = _spread(polygons.vertices[polygons.triangles], samples)
    feet, reached = _feet(tape, points)
    lengths = np.linalg.norm(feet - points, axis=1)
    back = distances(feet[reached], polygons.vertices, polygons.triangles)
    return Hausdorff(float(lengths[reached].max(initial=0.0)), float(back.max(initial=0.0)))


def _spread(corners: Floats, samples: int) -> Floats:
    """(n, 3) points on triangles (m, 3, 3), at equal steps of cumulative area; in each by a quasirandom sequence."""
    import numpy as np

    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.cumsum(np.linalg.norm(across, axis=1))
    k = np.arange(samples)
    chosen = np.minimum(np.searchsorted(area, (k + 0.5) / samples * area[-1]), len(corners) - 1)
    # The sequence of Roberts (2018): powers of the root of x^3 = x + 1, the golden ratio's counterpart.
    u, v = (0.5 + k * 0.7548776662466927) % 1.0, (0.5 + k * 0.5698402909980532) % 1.0
    over = u + v > 1.0
    u, v = np.where(over, 1.0 - u, u), np.where(over, 1.0 - v, v)
    a, b, c = (corners[chosen, j] for j in range(3))
    points: Floats = a + u[:, None] * (b - a) + v[:, None] * (c - a)
    return points


def _feet(tape: Tape, points: Floats) -> tuple[Floats, Ints]:
    """Points (n, 3) moved to the surface by Newton's method along the gradient, and (n,) whether each converged."""
    import numpy as np

    feet = points.copy()
    with np.errstate(all="ignore"):
        for _ in range(STEPS):
            slopes = many_gradients(tape, feet)
            moves = (field_values(tape, feet) / (slopes**2).sum(axis=1))[:, None] * slopes
            finite = np.isfinite(moves).all(axis=1)
            feet -= np.where(finite[:, None], moves, 0.0)
    size = np.ptp(points, axis=0).max()
    return feet, finite & (np.linalg.norm(moves, axis=1) < 1e-9 * size)
