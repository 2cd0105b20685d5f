"""Bounding balls of solids {f < 0}, so that a renderer skips the tiles of a picture outside the ball.

Imports numpy: to be imported by the function that needs it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.field.roots.clips import LAST, LINEAR, branches, clips_of
from sceneql.field.skeleton.skeleton import plain_points
from sceneql.field.tape.own_coordinates import in_own_coordinates
from sceneql.field.tape.plans import density_of, without_factor
from sceneql.field.tape.tape_ops import DENSITY

if TYPE_CHECKING:
    from sceneql.frame import Floats, Tape

ROUNDED = 1e-9
"""Relative enlargement of a ball, for rounding."""


def ball_around(tape: Tape) -> Floats:
    """(4,) center and radius [m] of the smallest ball found that contains the solid {f < 0}; radius inf without any."""
    found = [ball for clip in clips_of(tape) if (ball := _of_quadric(clip)) is not None]
    own, matrix = in_own_coordinates(tape)
    for branch in branches(own):
        row = without_factor(own, branch)
        if (density := density_of(own, row)) is not None:
            found.append(_of_points(own, density[0], matrix))
    if not found:
        return np.array([0.0, 0.0, 0.0, np.inf])
    ball = min(found, key=lambda ball: float(ball[3]))
    ball[3] += ROUNDED * np.abs(ball).sum()
    return ball


def _of_quadric(clip: Floats) -> Floats | None:
    """Center and radius (4,) of the ball around an ellipsoid {q < 0}; None for another quadric. ``clip`` (10,): q."""
    form = np.diag(clip[:3])
    form[[0, 1, 2], [1, 2, 0]] = form[[1, 2, 0], [0, 1, 2]] = 0.5 * clip[3:LINEAR]
    least, *_, most = np.linalg.eigvalsh(form)
    if not least > 1e-9 * most:
        return None
    center = np.linalg.solve(form, -0.5 * clip[LINEAR:LAST])
    return np.array([*center, np.sqrt(max(center @ form @ center - clip[LAST], 0.0) / least)])


def _of_points(tape: Tape, row: int, matrix: Floats) -> Floats:
    """Center and radius (4,), in the world, of a ball around the supports of a density's points.

    ``row``: of the density; ``matrix`` (3, 4) maps the world to the points' coordinates.
    """
    kind, start, stop, _ = tape.code[row]
    parts = tape.parts[start:stop]
    points = parts if kind == DENSITY else plain_points(parts)
    assert points is not None
    centers, radii = points[:, :3], points[:, 6:7]
    middle = 0.5 * ((centers - radii).min(axis=0) + (centers + radii).max(axis=0))
    radius = float((np.sqrt(((centers - middle) ** 2).sum(axis=1)) + radii[:, 0]).max())
    size = np.linalg.svd(matrix[:, :3], compute_uv=False)[-1]
    return np.array([*np.linalg.solve(matrix[:, :3], middle - matrix[:, 3]), radius / size])
