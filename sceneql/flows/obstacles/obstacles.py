"""Standing solids in a flow: open fractions of faces and cells, and their centroids.

Near the surface a face or cell is divided into a few boxes; each is cut by the plane of the level set's value and
gradient at its center (grids/domain/cut.py).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sceneql.flows.fluid_box import around
from sceneql.flows.obstacles.gaps import TOUCHING, must_leave_cells
from sceneql.flows.obstacles.no_slip_numbers import LEAST, SLIVER
from sceneql.grids.domain.cut import below
from sceneql.grids.domain.domain import inside
from sceneql.island.start import Start
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from collections.abc import Container, Sequence

    from sceneql.flows.staggered import Faces
    from sceneql.frame import Floats
    from sceneql.kinds import Moment, Ref
    from sceneql.system import Assembly

SPLITS = (4, 4, 2)
"""Subdivisions along each axis of boxes with one, two and three axes that the surface may cut."""
ROUND = 2.5
"""Distance [cells] from the surface within which distances are computed."""


@dataclass(frozen=True, slots=True, eq=False)
class Opened:
    """Cuts of k boxes (faces or cells) by solids."""

    parts: Floats
    """(k,) open fraction of each box."""
    depths: Floats
    """(k,) [m] mean distance of the open part from the surface."""
    centers: Floats
    """(k, 3) [m] centroid of the open part."""
    levels: Floats
    """(k,) [m] signed distance of the box's center, negative in solids; a huge number far from the surface."""
    normals: Floats
    """(k, 3) unit normals away from the surface; 0 far from it."""


class Solids:
    """The union of solids, as level sets at the start of the run."""

    def __init__(
        self,
        refs: Sequence[Ref],
        faces: Faces,
        staircase: bool,
        assembly: Assembly,
        domain: Ref | None = None,
        named: Container[str] = (),
    ) -> None:
        """``domain``: the object that the fluid fills, whose complement is the last solid; ``named``: sides of the box
        that the script names.

        Raises ScriptError for an object without an inside, and where solids fill the box or the gap between two.
        """
        self.faces, self.staircase, self.spacing = faces, staircase, np.array(faces.cells.spacing)
        self.refs = refs if domain is None else (*refs, domain)
        self.levels: list[Any] = []
        for ref in refs:
            try:
                self.levels.append(inside(ref, faces.axes == 2, cast("Moment", Start(assembly)))[0])
            except (TypeError, ValueError) as error:
                message = f"'{ref.name}' cannot stand in a flow: {error}"
                help = "take an object with an inside: a mesh that is closed, an outline"
                raise ScriptError([Diagnostic("no-domain", message, ref.span, help)]) from error
        if domain is not None:
            self.levels.append(around(domain, faces, named, assembly))
        axes, centers = list(range(faces.axes)), self._centers()
        self.opened = []
        if staircase:
            self.parts = np.where(self.values(centers) > 0.0, 1.0, 0.0)
        else:
            self.parts = self.cut(centers, faces.cells.shape[::-1], axes).parts
            for component in axes:
                others = [k for k in axes if k != component]
                self.opened.append(self.cut(faces.points(component), faces.shapes[component], others))
                self.opened[-1].parts[self.opened[-1].parts < SLIVER] = 0.0
                self._shut(component, self.opened[-1].parts)
        if not (self.parts > 0.0).any():
            text = "the solids fill the whole box: no cell is left to flow through"
            raise ScriptError([Diagnostic("no-cell", text, self.refs[0].span, "take smaller ones, or a larger `size`")])
        if len(self.refs) > 1:
            must_leave_cells(self.refs, self.levels, faces.cells.shape[::-1], centers, self.spacing)

    def _shut(self, component: int, parts: Floats) -> None:
        """Set ``parts`` of a component's faces to 0 on the box's sides beside cells in a solid, which touches them."""
        faces, line = self.faces, 2 - component
        filled = self.parts.reshape(faces.cells.shape[::-1]) <= TOUCHING
        for high in range(0 if faces.periodic[component] else 2):
            mine = faces.on_side(component, high) - faces.starts[component]
            parts[mine[filled.take(-1 if high else 0, axis=line)]] = 0.0

    def _centers(self) -> Floats:
        found = self.faces.cells.centers()
        if self.faces.axes == 2:
            found[:, 2] = 0.0
        return found

    def values(self, points: Floats) -> Floats:
        """Level set (k,) of the union at points (k, 3), positive in the fluid."""
        found: Floats = np.min([level.values(points) for level in self.levels], axis=0)
        return found

    def fractions(self, areas: Floats) -> Floats:
        """Open fraction (cells,) of each cell, at least LEAST if a face is open; ``areas``: open areas of faces."""
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
        """The number of the nearest solid, for all faces, then for all cells."""
        return np.concatenate(
            [*(self.nearest(self.faces.points(axis)) for axis in range(self.faces.axes)), self.nearest(self._centers())]
        )

    def nearest(self, points: Floats) -> Any:
        """The number (k,) of the solid nearest to each point (k, 3)."""
        return np.argmin([level.values(points) for level in self.levels], axis=0)

    def planes(self, points: Floats, reach: float = 0.5) -> tuple[Floats, Floats]:
        """Level set (k,) and its gradient (k, 3) at points (k, 3), by central differences over +-``reach`` cells."""
        slopes = np.zeros((len(points), 3))
        for axis in range(self.faces.axes):
            step = np.zeros(3)
            step[axis] = reach * self.spacing[axis]
            slopes[:, axis] = (self.values(points + step) - self.values(points - step)) / (2.0 * step[axis])
        return self.values(points), slopes

    def cut(self, points: Floats, shape: tuple[int, ...], axes: Sequence[int]) -> Opened:
        """Cuts of boxes around points, which form a grid of ``shape`` (nz, ny, nx).

        A box has a cell's sides along ``axes``, and no extent along other axes: a face, or a cell.
        """
        phi = self.values(points)
        beside = np.flatnonzero(np.abs(phi) <= ROUND * _steps(phi.reshape(shape)).ravel())
        slopes, steep = np.zeros((len(phi), 3)), np.full(len(phi), 1e-300)
        slopes[beside] = self.planes(points[beside])[1]
        steep[beside] = np.maximum(np.linalg.norm(slopes[beside], axis=1), 1e-9)
        levels = phi / steep
        parts, depths, centers = np.where(phi > 0.0, 1.0, 0.0), np.maximum(levels, 0.0), points.copy()
        near = beside[np.abs(phi[beside]) <= np.abs(slopes[beside][:, axes]) @ self.spacing[axes]]
        open_, deep, moments = np.zeros(len(near)), np.zeros(len(near)), np.zeros((len(near), 3))
        splits = SPLITS[len(axes) - 1]
        sides = self.spacing[axes] / splits
        values = self._around(points[near], axes, splits)
        slope, steepness = slopes[near][:, axes].copy(), steep[near]
        off_plane = steepness**2 - (slope**2).sum(axis=1)
        for place in product(range(1, splits + 1), repeat=len(axes)):
            for k in range(len(axes)):
                ahead, behind = (tuple(n + way * (j == k) for j, n in enumerate(place)) for way in (1, -1))
                slope[:, k] = (values[ahead] - values[behind]) / (2.0 * sides[k])
            own = values[place]
            part = below(-own, -slope, sides)
            depth = below(-own, -slope, sides, depth=True)
            across = (slope**2).sum(axis=1)
            leans = (part > 0.0) & (part < 1.0) & (across > 0.0)
            off = np.where(leans, (depth - part * own) / np.where(leans, across, 1.0), 0.0)
            moments[:, axes] += part[:, None] * (np.array(place) - 0.5 * (splits + 1)) * sides + off[:, None] * slope
            open_ += part
            deep += depth / np.sqrt(np.maximum(off_plane + across, 1e-18))
        some = np.where(open_ > 0.0, open_, 1.0)
        parts[near], depths[near] = open_ / splits ** len(axes), deep / some
        centers[near] += moments / some[:, None]
        return Opened(parts, depths, centers, levels, slopes / steep[:, None])

    def _around(self, points: Floats, axes: Sequence[int], splits: int) -> dict[tuple[int, ...], Floats]:
        """Level set (k,) at the centers of the subdivisions of boxes, by their indices 1..splits, and one beyond."""
        found = {}
        for place in product(range(splits + 2), repeat=len(axes)):
            if sum(not 0 < one <= splits for one in place) <= 1:
                shift = np.zeros(3)
                shift[axes] = (np.array(place) - 0.5 * (splits + 1)) * self.spacing[axes] / splits
                found[place] = self.values(points + shift)
        return found

    def face_parts(self) -> Floats:
        """Open fraction (faces,) of each face."""
        if self.staircase:
            return np.concatenate([self._between(component) for component in range(self.faces.axes)])
        return np.concatenate([one.parts for one in self.opened])

    def middles(self) -> tuple[Any, Floats]:
        """Numbers (k,) of the cut faces, and centroids (k, 3) [m] of their open parts."""
        if self.staircase:
            return np.zeros(0, dtype=int), np.zeros((0, 3))
        parts = self.face_parts()
        cut = np.flatnonzero((parts > 0.0) & (parts < 1.0))
        return cut, np.concatenate([one.centers for one in self.opened])[cut]

    def _between(self, component: int) -> Floats:
        """For a component's faces 1 where the cells on both sides are open, else 0 (staircase)."""
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
        """Factors (nz, ny, nx) of a component's viscous ties to the faces before along an axis, for a staircase.

        2 between an open and a ``closed`` face across the component's axis, where the wall is halfway; 0 between closed
        ones.
        """
        before = np.roll(closed, 1, axis=2 - axis)
        found: Floats = np.where(closed != before, 1.0 if axis == component else 2.0, np.where(closed, 0.0, 1.0))
        return found


def _steps(phi: Floats) -> Floats:
    """Sum over the axes of the larger difference from the two neighbors' values, (nz, ny, nx)."""
    total = np.zeros(phi.shape)
    for line in range(3):
        step = np.abs(np.diff(phi, axis=line))
        none = np.zeros([1 if k == line else n for k, n in enumerate(phi.shape)])
        total += np.maximum(np.concatenate([none, step], axis=line), np.concatenate([step, none], axis=line))
    return total
