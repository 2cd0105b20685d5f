"""Faces of a staggered grid, numbered component by component, and edges on the sides of its box."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.grids.domain.cells import Cells


@dataclass(frozen=True, slots=True, eq=False)
class Edges:
    """The m edges of one component on one side of the box."""

    faces: NDArray[int64]
    """(m,) number of the face next to each edge."""
    points: Floats
    """(m, 3) [m] midpoints of the edges."""
    both: tuple[NDArray[int64], NDArray[int64]]
    """(m,) each: boundary faces of the two cells on both sides of that face."""


class Faces:
    """All faces of a staggered grid, component after component.

    Arrays of a component are (nz, ny, nx), with one more entry along its own axis unless this is periodic.
    """

    def __init__(self, cells: Cells, periodic: tuple[bool, bool, bool]) -> None:
        self.cells, self.periodic = cells, periodic
        self.axes = 2 if cells.flat else 3
        self.shapes = []
        self.starts = []
        self.count = 0
        for axis in range(self.axes):
            shape = list(cells.shape)
            shape[axis] += not periodic[axis]
            self.shapes.append((shape[2], shape[1], shape[0]))
            self.starts.append(self.count)
            self.count += int(np.prod(shape))
        self.low = np.array([*cells.low[:2], 0.0 if cells.flat else cells.low[2]])
        volume = float(np.prod(cells.spacing))
        self.areas = tuple(volume / float(cells.spacing[axis]) for axis in range(self.axes))
        self.volume = volume

    def index(self, component: int) -> NDArray[int64]:
        """Numbers (nz, ny, nx) of a component's faces."""
        shape = self.shapes[component]
        count = np.arange(np.prod(shape), dtype=np.int64)
        found: NDArray[int64] = self.starts[component] + count.reshape(shape)
        return found

    def points(self, component: int, shift: tuple[int, float] | None = None) -> Floats:
        """Centers (m, 3) [m] of a component's faces; ``shift``: an axis, and a shift along it in cells."""
        index = np.stack(np.meshgrid(*map(np.arange, self.shapes[component]), indexing="ij")[::-1], axis=-1)
        offset = np.full(3, 0.5)
        offset[component] = 0.0
        if shift is not None:
            offset[shift[0]] += shift[1]
        found: Floats = self.low + (index.reshape(-1, 3) + offset) * self.cells.spacing
        if self.cells.flat:
            found[:, 2] = 0.0
        return found

    def box(self, component: int) -> list[float]:
        """Low corner and spacing, six numbers [m], of the grid whose cells are centered on a component's faces."""
        low = np.array(self.low)
        low[component] -= 0.5 * self.cells.spacing[component]
        if self.cells.flat:
            low[2] = -0.5 * self.cells.spacing[2]
        return [*low.tolist(), *self.cells.spacing.tolist()]

    def own_widths(self, component: int) -> Floats:
        """Widths (nz, ny, nx) [cells] of a component's control volumes along its axis: 1, and 1/2 on the boundary."""
        widths = np.ones(self.shapes[component])
        if not self.periodic[component]:
            for end in (0, -1):
                widths[tuple(end if k == 2 - component else slice(None) for k in range(3))] = 0.5
        return widths

    def side(self, axis: int, high: int) -> NDArray[int64]:
        """Numbers of a side's boundary faces (in cells.boundary), as an array (z, y, x) without its axis."""
        shape = [n for k, n in enumerate(self.cells.shape[::-1]) if k != 2 - axis]
        count = int(np.prod(shape))
        before = sum(2 * int(np.prod(self.cells.shape)) // self.cells.shape[k] for k in range(axis))
        return before + high * count + np.arange(count, dtype=np.int64).reshape(shape)

    def on_side(self, axis: int, high: int) -> NDArray[int64]:
        """Numbers of the faces that lie on a side, in the order of `side`."""
        found: NDArray[int64] = self.index(axis).take([-1 if high else 0], axis=2 - axis).squeeze(2 - axis)
        return found

    def edges(self, component: int, axis: int, high: int) -> Edges:
        """The edges of a component on a side normal to another axis."""
        faces: Any = self.index(component).take(-1 if high else 0, axis=2 - axis)
        points = self.points(component, (axis, 0.5 if high else -0.5))
        own = points.reshape(*self.shapes[component], 3).take(-1 if high else 0, axis=2 - axis)
        beside = self.side(axis, high)
        along = [k for k in (2, 1, 0) if k != axis].index(component)
        if self.periodic[component]:
            behind, ahead = np.roll(beside, 1, axis=along), beside
        else:
            first, last = beside.take([0], axis=along), beside.take([-1], axis=along)
            behind = np.concatenate([first, beside], axis=along)
            ahead = np.concatenate([beside, last], axis=along)
        return Edges(faces.ravel(), own.reshape(-1, 3), (behind.ravel(), ahead.ravel()))
