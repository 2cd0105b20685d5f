"""Solids that stand in a flow: open fractions of faces and of each velocity's own cell, and the walls within these.

In each box around a point the surface is a plane by the level's value and gradient there (grids/domain/cut.py). What is
between two velocities, and between a velocity and the wall, crosses the open part of the sides of its own cell.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sceneql.grids.domain.cut import below
from sceneql.grids.domain.domain import inside
from sceneql.island.start import Start
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.flows.staggered import Faces
    from sceneql.frame import Floats
    from sceneql.kinds import Moment, Ref
    from sceneql.system import Assembly

SLIVER = 0.02
"""Open part of a face below which it is closed: what little flows there would need a large pressure behind it."""
NEAREST = 0.05
"""Least distance from a wall, in parts of a cell's side."""
LEAST = 0.3
"""Least volume of a velocity's own cell, of a whole one: smaller ones have this inertia, for the sake of the step."""


class Solids:
    """Solids by their level sets, where they stand at the start."""

    def __init__(self, refs: Sequence[Ref], faces: Faces, staircase: bool, assembly: Assembly) -> None:
        """Raises ScriptError for an object without an inside, and where nothing is left of the box."""
        self.faces, self.staircase, self.spacing = faces, staircase, np.array(faces.cells.spacing)
        self.refs = refs
        self.levels = []
        for ref in refs:
            try:
                self.levels.append(inside(ref, faces.axes == 2, cast("Moment", Start(assembly)))[0])
            except (TypeError, ValueError) as error:
                message = f"'{ref.name}' cannot stand in a flow: {error}"
                raise ScriptError([Diagnostic("no-domain", message, ref.span)]) from error
        centers = self._centers()
        self.cells = self._values(centers) > 0.0 if staircase else self.open(centers, range(faces.axes)) > 0.0
        if not self.cells.any():
            text = "the solids fill the whole box: no cell is left to flow through"
            raise ScriptError([Diagnostic("no-cell", text, refs[0].span, "take smaller ones, or a larger `size`")])

    def _centers(self) -> Floats:
        found = self.faces.cells.centers()
        if self.faces.axes == 2:
            found[:, 2] = 0.0
        return found

    def _values(self, points: Floats) -> Floats:
        """The level of the union (k,): above 0 in the fluid."""
        found: Floats = np.min([level.values(points) for level in self.levels], axis=0)
        return found

    def fractions(self, areas: Floats) -> Floats:
        """The open part of each cell, at least LEAST of those with an open face, by the open ``areas`` of faces."""
        found = self.cells.astype(float) if self.staircase else self.open(self._centers(), range(self.faces.axes))
        alive = np.zeros(len(found), dtype=bool)
        for axis in range(self.faces.axes):
            own = areas[self.faces.index(axis)] > 0.0
            count, line = self.faces.cells.shape[axis], 2 - axis
            alive |= (
                own.take(range(count), axis=line) | np.roll(own, -1, axis=line).take(range(count), axis=line)
            ).ravel()
        parts: Floats = np.where(alive, np.maximum(found, LEAST), 0.0)
        return parts

    def owners(self) -> Any:
        """By face, then by cell: the number of the nearest solid."""
        faces = self.faces
        points = [*map(faces.points, range(faces.axes)), self._centers()]
        return np.concatenate([np.argmin([level.values(one) for level in self.levels], axis=0) for one in points])

    def planes(self, points: Floats) -> tuple[Floats, Floats]:
        """The level (k,) and its gradient (k, 3)."""
        slopes = np.zeros((len(points), 3))
        for axis in range(self.faces.axes):
            step = np.zeros(3)
            step[axis] = 0.5 * self.spacing[axis]
            slopes[:, axis] = (self._values(points + step) - self._values(points - step)) / self.spacing[axis]
        return self._values(points), slopes

    def open(self, points: Floats, axes: Any) -> Floats:
        """The open part (k,) of boxes of a cell's sides along these axes, of no extent along others."""
        phi, slopes = self.planes(points)
        chosen = list(axes)
        found: Floats = np.where(phi > 0.0, 1.0, 0.0)
        near = np.abs(phi) <= np.abs(slopes[:, chosen]) @ self.spacing[chosen]
        found[near] = below(-phi[near], -slopes[near][:, chosen], self.spacing[chosen])
        return found

    def face_parts(self) -> Floats:
        """By face: its open part."""
        faces = self.faces
        if self.staircase:
            return np.concatenate([self._between(component) for component in range(faces.axes)])
        parts = [
            self.open(faces.points(component), [k for k in range(faces.axes) if k != component])
            for component in range(faces.axes)
        ]
        found = np.concatenate(parts)
        found[found < SLIVER] = 0.0
        return found

    def _between(self, component: int) -> Floats:
        """Of a component's faces: 1 where the cells on both sides are open."""
        cells = self.cells.reshape(self.faces.cells.shape[::-1])
        line = 2 - component
        if self.faces.periodic[component]:
            both: Floats = (cells & np.roll(cells, 1, axis=line)).ravel().astype(float)
            return both
        first, last = cells.take([0], axis=line), cells.take([-1], axis=line)
        low, high = np.concatenate([first, cells], axis=line), np.concatenate([cells, last], axis=line)
        found: Floats = (low & high).ravel().astype(float)
        return found

    def ties(self, component: int, axis: int, closed: Any, shifts: Floats) -> Floats:
        """Of a component's faces: the open part of what is between them and the one before along an axis, over their
        distance in cells.

        ``closed`` (m,) bool: faces that are shut. A staircase has its walls halfway to these, across a component.
        """
        shape = self.faces.shapes[component]
        shut = closed.reshape(shape)
        before = np.roll(shut, 1, axis=2 - axis)
        if not self.staircase:
            own = self.faces.points(component, (axis, -0.5))
            shift = np.where(closed, 0.0, shifts[:, axis]).reshape(shape)
            apart = 1.0 + (shift - np.roll(shift, 1, axis=2 - axis)) / self.spacing[axis]
            apart = np.where(shut != before, self._to_wall(component, axis, shut, shifts), apart).ravel()
            whole = self.open(own, [k for k in range(self.faces.axes) if k != axis])
            found: Floats = whole / np.clip(apart, 0.25, 2.0)
            return found
        factor = np.where(shut != before, 1.0 if axis == component else 2.0, np.where(shut, 0.0, 1.0))
        steps: Floats = factor.ravel()
        return steps

    def _to_wall(self, component: int, axis: int, shut: Any, shifts: Floats) -> Floats:
        """Of a component's faces, where one of it and the one before along an axis is shut: how far the wall between
        them is from the middle of the other one's fluid, in cells."""
        points = self.faces.points(component)
        level = self._values(points).reshape(shut.shape)
        middle = self._values(points + shifts).reshape(shut.shape)
        before = np.roll(level, 1, axis=2 - axis), np.roll(middle, 1, axis=2 - axis)
        steps = np.where(shut, before[0] - level, level - before[0])
        above = np.where(shut, before[1], middle)
        found: Floats = np.where(steps > 0.0, above / np.where(steps > 0.0, steps, 1.0), 1.0)
        return found

    def walls(self, component: int) -> tuple[Floats, Floats, Floats]:
        """Of a component's faces: the volume of the own cell in parts, (wall's area)/(distance) in it [m], and how far
        from the face's middle (m, 3) the middle of the fluid is that is nearer to a wall [m]."""
        faces = self.faces
        points = faces.points(component)
        if self.staircase:
            return np.ones(len(points)), np.zeros(len(points)), np.zeros_like(points)
        volumes = self.open(points, range(faces.axes))
        vector = np.zeros(len(points))
        for axis in range(faces.axes):
            across = [k for k in range(faces.axes) if k != axis]
            ends = []
            for side in (-0.5, 0.5):
                shift = np.zeros(3)
                shift[axis] = side * self.spacing[axis]
                ends.append(self.open(points + shift, across))
            vector += ((ends[1] - ends[0]) * faces.areas[axis]) ** 2
        area = np.sqrt(vector)
        some = area > 1e-9 * max(faces.areas)
        middle = 0.5 * volumes * faces.volume / np.where(some, area, 1.0)
        phi, slopes = self.planes(points)
        steep = np.maximum(np.linalg.norm(slopes, axis=1), 1e-9)
        distance = phi / steep
        away = np.maximum(np.maximum(distance, middle), NEAREST * self.spacing[: faces.axes].min())
        shifts = np.where(some, (away - distance) / steep, 0.0)[:, None] * slopes
        return volumes, np.where(some, area / away, 0.0), shifts
