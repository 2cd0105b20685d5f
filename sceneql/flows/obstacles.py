"""Solids that stand in a flow: open parts of faces and of cells, and where these parts are.

Near the surface each of the few parts of a box is cut by the plane of the level's value and gradient in its middle
(grids/domain/cut.py).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
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
LEAST = 0.3
"""Least volume of a velocity's own cell, of a whole one: smaller ones have this inertia, for the sake of the step."""
SPLITS = 4
"""Parts along each axis of a box that the surface may cut."""


@dataclass(frozen=True, slots=True, eq=False)
class Opened:
    """How solids cut boxes (k,)."""

    parts: Floats
    """The open part of each."""
    depths: Floats
    """The mean distance of the open part from the surface [m]."""
    centers: Floats
    """(k, 3) the middle of the open part [m]."""
    levels: Floats
    """The distance of the box's own middle, below 0 in solids [m]."""
    normals: Floats
    """(k, 3) away from the surface."""


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
        axes, centers = list(range(faces.axes)), self._centers()
        self.opened = []
        if staircase:
            self.parts = np.where(self.values(centers) > 0.0, 1.0, 0.0)
        else:
            self.parts = self.cut(centers, axes).parts
            for component in axes:
                self.opened.append(self.cut(faces.points(component), [k for k in axes if k != component]))
                self.opened[-1].parts[self.opened[-1].parts < SLIVER] = 0.0
        if not (self.parts > 0.0).any():
            text = "the solids fill the whole box: no cell is left to flow through"
            raise ScriptError([Diagnostic("no-cell", text, refs[0].span, "take smaller ones, or a larger `size`")])

    def _centers(self) -> Floats:
        found = self.faces.cells.centers()
        if self.faces.axes == 2:
            found[:, 2] = 0.0
        return found

    def values(self, points: Floats) -> Floats:
        """The level of the union (k,): above 0 in the fluid."""
        found: Floats = np.min([level.values(points) for level in self.levels], axis=0)
        return found

    def fractions(self, areas: Floats) -> Floats:
        """The open part of each cell, at least LEAST of those with an open face, by the open ``areas`` of faces."""
        alive = np.zeros(len(self.parts), dtype=bool)
        for axis in range(self.faces.axes):
            own = areas[self.faces.index(axis)] > 0.0
            count, line = self.faces.cells.shape[axis], 2 - axis
            alive |= (
                own.take(range(count), axis=line) | np.roll(own, -1, axis=line).take(range(count), axis=line)
            ).ravel()
        parts: Floats = np.where(alive, np.maximum(self.parts, LEAST), 0.0)
        return parts

    def owners(self) -> Any:
        """By face, then by cell: the number of the nearest solid."""
        return np.concatenate(
            [*(self.nearest(self.faces.points(axis)) for axis in range(self.faces.axes)), self.nearest(self._centers())]
        )

    def nearest(self, points: Floats) -> Any:
        """(k,) the number of the solid nearest to each point."""
        return np.argmin([level.values(points) for level in self.levels], axis=0)

    def planes(self, points: Floats) -> tuple[Floats, Floats]:
        """The level (k,) and its gradient (k, 3)."""
        slopes = np.zeros((len(points), 3))
        for axis in range(self.faces.axes):
            step = np.zeros(3)
            step[axis] = 0.5 * self.spacing[axis]
            slopes[:, axis] = (self.values(points + step) - self.values(points - step)) / self.spacing[axis]
        return self.values(points), slopes

    def cut(self, points: Floats, axes: Sequence[int]) -> Opened:
        """How solids cut boxes of a cell's sides along these axes, of no extent along others."""
        phi, slopes = self.planes(points)
        steep = np.maximum(np.linalg.norm(slopes, axis=1), 1e-9)
        levels = phi / steep
        parts, depths, centers = np.where(phi > 0.0, 1.0, 0.0), np.maximum(levels, 0.0), points.copy()
        near = np.flatnonzero(np.abs(phi) <= np.abs(slopes[:, axes]) @ self.spacing[axes])
        open_, deep, moments = np.zeros(len(near)), np.zeros(len(near)), np.zeros((len(near), 3))
        sides = self.spacing[axes] / SPLITS
        for place in product(range(SPLITS), repeat=len(axes)):
            shift = np.zeros(3)
            shift[axes] = (np.array(place) - 0.5 * (SPLITS - 1)) * sides
            own, slope = self.planes(points[near] + shift)
            part = below(-own, -slope[:, axes], sides)
            depth = below(-own, -slope[:, axes], sides, depth=True)
            across = (slope[:, axes] ** 2).sum(axis=1)
            leans = (part > 0.0) & (part < 1.0) & (across > 0.0)
            off = np.where(leans, (depth - part * own) / np.where(leans, across, 1.0), 0.0)
            moments += part[:, None] * shift
            moments[:, axes] += off[:, None] * slope[:, axes]
            open_ += part
            deep += depth / np.maximum(np.linalg.norm(slope, axis=1), 1e-9)
        some = np.where(open_ > 0.0, open_, 1.0)
        parts[near], depths[near] = open_ / SPLITS ** len(axes), deep / some
        centers[near] += moments / some[:, None]
        return Opened(parts, depths, centers, levels, slopes / steep[:, None])

    def face_parts(self) -> Floats:
        """By face: its open part."""
        if self.staircase:
            return np.concatenate([self._between(component) for component in range(self.faces.axes)])
        return np.concatenate([one.parts for one in self.opened])

    def middles(self) -> tuple[Any, Floats]:
        """The numbers of faces that are cut, and the middles of what is open of them (k, 3)."""
        if self.staircase:
            return np.zeros(0, dtype=int), np.zeros((0, 3))
        parts = self.face_parts()
        cut = np.flatnonzero((parts > 0.0) & (parts < 1.0))
        return cut, np.concatenate([one.centers for one in self.opened])[cut]

    def _between(self, component: int) -> Floats:
        """Of a component's faces: 1 where the cells on both sides are open."""
        cells = (self.parts > 0.0).reshape(self.faces.cells.shape[::-1])
        line = 2 - component
        if self.faces.periodic[component]:
            both: Floats = (cells & np.roll(cells, 1, axis=line)).ravel().astype(float)
            return both
        first, last = cells.take([0], axis=line), cells.take([-1], axis=line)
        low, high = np.concatenate([first, cells], axis=line), np.concatenate([cells, last], axis=line)
        found: Floats = (low & high).ravel().astype(float)
        return found

    def steps(self, component: int, axis: int, closed: Any) -> Floats:
        """Of a component's faces (nz, ny, nx) in a staircase: viscous ties to the ones before along an axis, of one
        in the open. Walls are halfway to ``closed`` faces, which are shut, across a component."""
        before = np.roll(closed, 1, axis=2 - axis)
        found: Floats = np.where(closed != before, 1.0 if axis == component else 2.0, np.where(closed, 0.0, 1.0))
        return found
