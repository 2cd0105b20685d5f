"""The velocity of the walls of solids that stand in a flow and turn in place, or whose skin moves along itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.flows.edges import component_at, timed
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sceneql.flows.obstacles import Solids
    from sceneql.flows.parts import Side
    from sceneql.flows.staggered import Faces
    from sceneql.frame import Floats

THROUGH = 0.05
"""Velocity across a wall, in parts of the largest on it, from which on it counts as one through it."""


def wall_velocities(solids: Solids, boundary: Mapping[str, Side], faces: Faces) -> Floats:
    """By face: the velocity along its axis of the wall of the nearest solid [m/s], by parts named like solids; beside
    a wall that of its nearest point.

    Raises ScriptError where a velocity varies in time, has other components than the box sides, or leads through.
    """
    found = np.zeros(faces.count)
    owners = solids.owners()[: faces.count]
    for number, ref in enumerate(solids.refs):
        part = boundary.get(ref.name)
        if part is None or part.velocity is None:
            continue
        formula = part.velocity
        if timed(formula.expr):
            text = "the velocity of a solid's wall does not vary in time"
            raise ScriptError([Diagnostic("invalid", text, formula.span)])
        if formula.expr.type.shape != (faces.axes,):
            text = f"this velocity needs {faces.axes} components, one for each side of the box"
            raise ScriptError([Diagnostic("wrong-shape", text, formula.span)])
        points = np.concatenate([faces.points(axis) for axis in range(faces.axes)])
        across, speed = np.zeros(len(points)), np.zeros(len(points))
        level, slopes = solids.planes(points)
        steep = np.maximum(np.linalg.norm(slopes, axis=1), 1e-9)
        beside = np.abs(level) < 1.5 * steep * faces.cells.spacing[: faces.axes].max()
        feet = points - np.where(beside, level / steep**2, 0.0)[:, None] * slopes
        near = (owners == number) & beside
        for axis in range(faces.axes):
            there = component_at(formula, axis, feet, 0.0)
            across += there * slopes[:, axis] / steep
            speed += there**2
            mine = slice(faces.starts[axis], faces.starts[axis] + int(np.prod(faces.shapes[axis])))
            own = owners[mine] == number
            found[mine] = np.where(own, component_at(formula, axis, feet[mine], 0.0), found[mine])
        if near.any() and np.abs(across[near]).max() > THROUGH * np.sqrt(speed[near].max()):
            text = "a wall moves along itself: this velocity leads through that of the solid"
            raise ScriptError([Diagnostic("invalid", text, formula.span, "turn it about its own axis: `[-y, x]`")])
    return found
