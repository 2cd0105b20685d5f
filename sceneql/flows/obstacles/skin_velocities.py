"""Wall velocities of standing solids in a flow, which rotate in place or whose surface moves tangentially."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.flows.edges import component_at, timed
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sceneql.flows.obstacles.obstacles import Solids
    from sceneql.flows.parts import Side
    from sceneql.frame import Floats

THROUGH = 0.05
"""Largest normal component of a wall's velocity, relative to the largest velocity on the wall."""

NEAR = 0.05
"""Half width [cells] of the differences by which the nearest points of walls are found."""


class SkinVelocities:
    """Wall velocities by the entries of a boundary that are named like solids."""

    def __init__(self, solids: Solids, boundary: Mapping[str, Side]) -> None:
        """Raises ScriptError for a velocity that varies in time, is not tangential or has too many components."""
        self.solids = solids
        named = ((number, boundary.get(ref.name)) for number, ref in enumerate(solids.refs))
        self.formulas = [(number, part.velocity) for number, part in named if part is not None and part.velocity]
        axes = solids.faces.axes
        for number, formula in self.formulas:
            if timed(formula.expr):
                text = "the velocity of a solid's wall does not vary in time"
                raise ScriptError([Diagnostic("invalid", text, formula.span, "write it by place alone: `[-y, x]`")])
            if formula.expr.type.shape != (axes,):
                text = f"this velocity needs {axes} components, one for each side of the box"
                raise ScriptError([Diagnostic("wrong-shape", text, formula.span)])
            points = np.concatenate([solids.faces.points(axis) for axis in range(axes)])
            feet, normals, beside = self._feet(points)
            mine = beside & (solids.nearest(points) == number)
            if not mine.any():
                continue
            there = np.stack([component_at(formula, axis, feet[mine], 0.0) for axis in range(axes)], axis=1)
            across = (there * normals[mine][:, :axes]).sum(axis=1)
            if np.abs(across).max() > THROUGH * np.sqrt((there**2).sum(axis=1).max()):
                text = "a wall moves along itself: this velocity leads through that of the solid"
                raise ScriptError([Diagnostic("invalid", text, formula.span, "turn it about its own axis: `[-y, x]`")])

    def _feet(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """(nearest wall points (k, 3), normals (k, 3), whether near a wall (k,)); points far from walls are returned
        unchanged."""
        level, slopes = self.solids.planes(points, NEAR)
        steep = np.maximum(np.linalg.norm(slopes, axis=1), 1e-9)
        spacing = self.solids.spacing[: self.solids.faces.axes]
        beside = np.abs(level) < 1.5 * steep * spacing.max()
        feet = points - np.where(beside, level / steep**2, 0.0)[:, None] * slopes
        return feet, slopes / steep[:, None], beside

    def at(self, points: Floats, component: int) -> Floats:
        """A component (k,) [m/s] of the velocity of the wall nearest to each point (k, 3)."""
        found = np.zeros(len(points))
        if not self.formulas or not len(points):
            return found
        feet, _, _ = self._feet(points)
        owners = self.solids.nearest(points)
        for number, formula in self.formulas:
            mine = owners == number
            found[mine] = component_at(formula, component, feet[mine], 0.0)
        return found
