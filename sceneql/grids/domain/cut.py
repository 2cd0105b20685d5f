"""Cut cells: volumes of cells inside a domain, open areas of their faces, and areas of the boundary in them.

The domain is {phi < 0}. In each cell and face the boundary is approximated by the plane of phi's value and gradient at
the center, and the volume below it has a closed form (Scardovelli & Zaleski 2000, J. Comput. Phys. 164, 228-237). The
vector area of the boundary in a cell balances that of the cell's open faces. Fluxes between neighbors use the open
areas and the distance of centers, which is of second order for zero flux through the boundary (Ng, Min & Gibou 2009, J.
Comput. Phys. 228, 8807-8829). Where a value is given (Dirichlet), cells with centers inside are whole, and the boundary
is at its true distance along each axis, again of second order (Gibou, Fedkiw, Cheng & Kang 2002, J. Comput. Phys. 176,
205-227). ``staircase`` takes whole cells everywhere, and half a cell for that distance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations
from math import factorial
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from sceneql.grids.domain.cells import BoundaryFaces, Cells

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

LEAST_SLOPE = 1e-4
"""Least relative slope of a plane along an axis; below it differences of cubes in the closed form cancel."""
BISECTIONS = 40
"""Bisections of a spacing in the search for the side of a thin plate."""
LEAST_VOLUME = 1e-6
"""Least volume of a cell relative to a whole one; smaller cells are left out. Their open faces are then closed, which
loses second order unless these are slivers, too."""
CROWDED = 0.3
"""Least volume of a cell, relative to the one with which its open faces would allow a whole cell's explicit step. A
larger constant would dominate the maximum error."""
NEAREST = 0.2
"""Least distance of a cell's center from the boundary used in fluxes, relative to the cell's size."""
NEAREST_HELD = 0.05
"""Value of NEAREST for a boundary with a given value (Dirichlet)."""


class Level(Protocol):
    """A domain as the level set {phi < 0}."""

    names: tuple[str, ...]
    """Names of the pieces of its boundary."""

    def values(self, points: Floats) -> Floats:
        """phi (k,) at points (k, 3) [m], negative inside; proportional to the distance near the boundary."""

    def pieces(self, points: Floats) -> NDArray[int64]:
        """Index (k,) into ``names`` of the boundary's piece nearest to each point (k, 3)."""


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """A regular grid around a domain."""

    shape: tuple[int, int, int]
    low: Floats
    spacing: Floats
    """(3,) [m]; the last is the depth of a two-dimensional grid."""

    @property
    def axes(self) -> tuple[int, ...]:
        """Numbers of the domain's axes."""
        return (0, 1) if self.shape[2] == 1 else (0, 1, 2)

    def points(self, shift: int | None = None) -> Floats:
        """Centers (cells, 3) [m] of cells, or of their low faces along the axis ``shift``; z = 0 in two dimensions."""
        nx, ny, nz = self.shape
        cell = np.arange(nx * ny * nz)
        index = np.stack([cell % nx, cell // nx % ny, cell // (nx * ny)], axis=1) + 0.5
        if shift is not None:
            index[:, shift] -= 0.5
        points: Floats = self.low + index * self.spacing
        if len(self.axes) == 2:
            points[:, 2] = 0.0
        return points

    def cells(self, volumes: Floats, areas: list[Floats], boundary: BoundaryFaces, names: tuple[str, ...]) -> Cells:
        """Cells on this grid, with the grid's box as bounding box."""
        around = self.low, self.low + np.array(self.shape) * self.spacing
        return Cells(
            self.shape, self.low, self.spacing, volumes, (areas[0], areas[1], areas[2]), boundary, names, around
        )


def frame(low: Floats, high: Floats, cell: float, depth: float, flat: bool) -> Frame:
    """A grid of cells of side ``cell`` [m] centered on a box, slightly larger than it if they do not fit."""
    sides = np.asarray(high, dtype=float) - low
    counts = np.maximum(1, np.ceil(sides / cell * (1.0 - 1e-9))).astype(int)
    middle = 0.5 * (np.asarray(low) + high)
    spacing = np.full(3, cell)
    if flat:
        counts[2], spacing[2], middle[2] = 1, depth, 0.0
    return Frame((int(counts[0]), int(counts[1]), int(counts[2])), middle - 0.5 * counts * spacing, spacing)


def below(phi: Floats, slopes: Floats, sides: Floats, depth: bool = False) -> Floats:
    """Fraction (m,) of boxes -sides/2 <= x <= sides/2 in which phi + slopes . x < 0; slopes (m, k), sides (k,).

    ``depth``: instead the mean over the box of max(-(phi + slopes . x), 0).
    """
    k = slopes.shape[1]
    power = k + 1 if depth else k
    rise = np.abs(slopes) * sides
    largest = np.maximum(rise.max(axis=1), np.abs(phi))
    largest = np.where(largest > 0.0, largest, 1.0)
    rise, phi = rise / largest[:, None], phi / largest
    total = rise.sum(axis=1)
    some = total > 1e-9 * np.abs(phi)
    rise = np.where(some[:, None], rise / np.where(some, total, 1.0)[:, None], 1.0 / k)
    rise = np.maximum(rise, LEAST_SLOPE)
    whole = rise.sum(axis=1)
    room = np.where(some, -phi / np.where(some, total, 1.0), np.where(phi < 0.0, 1.0, -1.0)) + 0.5 * whole
    part = np.zeros(len(phi))
    for size in range(k + 1):
        for chosen in combinations(range(k), size):
            part += (-1.0) ** size * np.maximum(0.0, room - rise[:, list(chosen)].sum(axis=1)) ** power
    part /= factorial(power) * rise.prod(axis=1)
    if depth:
        part = np.where(room <= 0.0, 0.0, np.where(room >= whole, room - 0.5 * whole, np.maximum(part, 0.0)))
        deep: Floats = np.where(some, part * total, np.maximum(-phi, 0.0)) * largest
        return deep
    found: Floats = np.clip(np.where(room <= 0.0, 0.0, np.where(room >= whole, 1.0, part)), 0.0, 1.0)
    return found


def _slopes(level: Level, points: Floats, grid: Frame, axes: tuple[int, ...]) -> Floats:
    """Components (m, len(axes)) of the gradient of phi at points (m, 3), by central differences."""
    columns = []
    for axis in axes:
        move = np.zeros(3)
        move[axis] = 0.05 * grid.spacing[axis]
        columns.append((level.values(points + move) - level.values(points - move)) / (0.1 * grid.spacing[axis]))
    return np.column_stack(columns)


def _find_sides(level: Level, grid: Frame, centers: Floats, near: Any, phi: Floats, slopes: Floats) -> None:
    """Replace phi and slopes of cells inside where the gradient vanishes, in place.

    There the faces of a plate, thinner than a cell, are nearer than its sides. The new values are those of the side
    that is nearest along an axis, found by bisection towards the neighboring center.
    """
    even = np.flatnonzero(~slopes.any(axis=1) & (phi[near] < 0.0))
    at, best = centers[near[even]], np.full(len(even), np.inf)
    for column, axis in enumerate(grid.axes):
        for way in (-1.0, 1.0):
            low, high = np.zeros(len(even)), np.full(len(even), grid.spacing[axis])
            step = way * np.eye(3)[axis]
            leaves = level.values(at + grid.spacing[axis] * step) >= 0.0
            for _ in range(BISECTIONS):
                middle = (low + high) / 2
                out = level.values(at + middle[:, None] * step) >= 0.0
                low, high = np.where(out, low, middle), np.where(out, middle, high)
            nearer = leaves & (high < best)
            best[nearer], phi[near[even[nearer]]] = high[nearer], -high[nearer]
            slopes[even[nearer]] = way * (np.arange(len(grid.axes)) == column)


def _near(phi: Floats, grid: Frame) -> Any:
    """(cells,) whether phi changes its sign among a cell and its 26 neighbors (8 in two dimensions)."""
    inside = (phi < 0.0).reshape(grid.shape[::-1])
    some, all_ = inside.copy(), inside.copy()
    for axis in (0, 1, 2):
        wide, narrow = some.copy(), all_.copy()
        for way in (1, -1):
            to = tuple(slice(1, None) if (k == axis and way > 0) else slice(None, -1) if k == axis else slice(None)
                       for k in range(3))  # fmt: skip
            of = tuple(slice(None, -1) if (k == axis and way > 0) else slice(1, None) if k == axis else slice(None)
                       for k in range(3))  # fmt: skip
            wide[to] |= some[of]
            narrow[to] &= all_[of]
            edge = tuple(0 if (k == axis and way > 0) else -1 if k == axis else slice(None) for k in range(3))
            narrow[edge] &= grid.shape[2 - axis] == 1
        some, all_ = wide, narrow
    return (some & ~all_).ravel()


def cut(level: Level, grid: Frame, held: Callable[[Floats, Any], Any] | None = None) -> Cells:
    """The cut cells of a domain.

    ``held``: from points of the boundary (m, 3) and their pieces (m,) whether a value is given there (m,) bool.
    """
    axes = grid.axes
    whole = float(np.prod(grid.spacing))
    centers = grid.points()
    phi = level.values(centers)
    near = np.flatnonzero(_near(phi, grid))
    slopes = _slopes(level, centers[near], grid, axes)
    _find_sides(level, grid, centers, near, phi, slopes)
    volumes = np.where(phi < 0.0, whole, 0.0)
    volumes[near] = whole * below(phi[near], slopes, grid.spacing[list(axes)])
    volumes[volumes < LEAST_VOLUME * whole] = 0.0
    stiff = np.zeros(len(phi), dtype=bool)
    if held is not None:
        squares = (slopes**2).sum(axis=1)  # zero in a plate thinner than a cell
        foot = centers[near]
        foot[:, list(axes)] -= (phi[near] / np.where(squares > 0.0, squares, np.inf))[:, None] * slopes
        stiff[near] = held(foot, level.pieces(foot))
        volumes[stiff] = np.where(phi[stiff] < 0.0, whole, 0.0)
    areas = [_areas(level, grid, axis, volumes > 0.0, near, stiff) for axis in range(3)]
    alone = sum(_both(area, grid, axis) for axis, area in enumerate(areas)) == 0.0
    volumes[alone] = 0.0
    closing = np.stack([area - _after(area, grid, axis) for axis, area in enumerate(areas)], axis=1)
    owners = np.flatnonzero((volumes > 0.0) & ~stiff & (np.linalg.norm(closing, axis=1) > 1e-9 * whole ** (2 / 3)))
    size = np.linalg.norm(closing[owners], axis=1)
    place = np.full(len(phi), -1)
    place[near] = np.arange(len(near))
    steep = np.linalg.norm(slopes, axis=1)[place[owners]]
    least, away = NEAREST * grid.spacing[list(axes)].min(), -phi[owners] / np.maximum(steep, 1e-300)
    distances = np.maximum(away, least)
    # Points on the boundary, also if the cell's center is outside: formulas are evaluated there.
    outward = closing[owners] / size[:, None]
    points = centers[owners] + outward * away[:, None]
    boundary = BoundaryFaces(owners, size, distances, points, outward, level.pieces(points))
    if stiff.any():
        boundary = _joined(boundary, _held_faces(level, grid, phi, (volumes > 0.0) & stiff, areas))
    volumes = _relieved(volumes, areas, grid)
    return grid.cells(volumes, areas, boundary, level.names)


def staircase(level: Level, grid: Frame) -> Cells:
    """Whole cells: those whose centers lie inside the domain."""
    whole = float(np.prod(grid.spacing))
    centers = grid.points()
    inside = level.values(centers) < 0.0
    n = len(inside)
    areas, faces = [], []
    for axis in range(3):
        full = whole / grid.spacing[axis] if axis in grid.axes else 0.0
        before, first = _shifted(inside, grid, axis)
        area = np.where(inside & before & ~first, full, 0.0)
        areas.append(area)
        if axis in grid.axes:
            after = _after(area, grid, axis)
            faces += [(np.flatnonzero(inside & (area == 0.0)), axis, -0.5, full)]
            faces += [(np.flatnonzero(inside & (after == 0.0)), axis, 0.5, full)]
    owners = np.concatenate([cells for cells, *_ in faces])
    outward = np.zeros((len(owners), 3))
    at = 0
    for cells, axis, way, _ in faces:
        outward[at : at + len(cells), axis] = 2.0 * way
        at += len(cells)
    points = centers[owners] + 0.5 * outward * grid.spacing
    size = np.concatenate([np.full(len(cells), full) for cells, _, _, full in faces])
    distances = np.concatenate([np.full(len(cells), 0.5 * grid.spacing[axis]) for cells, axis, _, _ in faces])
    boundary = BoundaryFaces(owners, size, distances, points, outward, level.pieces(points))
    volumes = np.where(inside, whole, np.zeros(n))
    return grid.cells(volumes, areas, boundary, level.names)


def _shifted(values: Any, grid: Frame, axis: int) -> tuple[Any, Any]:
    """Values (cells,) of the cell before along an axis, wrapped periodically, and a mask of the first cells."""
    index = np.arange(values.size).reshape(grid.shape[::-1])
    first = np.zeros(index.shape, dtype=bool)
    first[tuple(0 if k == 2 - axis else slice(None) for k in range(3))] = True
    return values[np.roll(index, 1, axis=2 - axis).ravel()], first.ravel()


def _after(area: Floats, grid: Frame, axis: int) -> Floats:
    """Area (cells,) of each cell's high face, the next cell's low face; 0 for the last cells, like the first's."""
    following: Floats = np.roll(area.reshape(grid.shape[::-1]), -1, axis=2 - axis).ravel()
    return following


def _both(area: Floats, grid: Frame, axis: int) -> Floats:
    return area + _after(area, grid, axis)


def _held_faces(level: Level, grid: Frame, phi: Floats, cells: Any, areas: list[Floats]) -> BoundaryFaces:
    """Boundary faces of whole cells where a value is given, at the boundary's true distance along the axis."""
    centers = grid.points()
    index = np.arange(len(phi)).reshape(grid.shape[::-1])
    parts = []
    for axis in grid.axes:
        after = _after(areas[axis], grid, axis)
        for area, way in ((areas[axis], 1), (after, -1)):
            mine = np.flatnonzero(cells & (area == 0.0))
            beyond = np.roll(index, way, axis=2 - axis).ravel()[mine]
            other = phi[beyond]
            last = np.flatnonzero((mine - beyond) * way < 0)  # the grid ends here: the wrapped cell is no neighbor
            outer = centers[mine[last]]
            outer[:, axis] -= way * grid.spacing[axis]
            other[last] = level.values(outer)
            share = np.where(other > 0.0, phi[mine] / np.where(other > 0.0, phi[mine] - other, 1.0), 0.5)
            distance = np.clip(share, NEAREST_HELD, 1.0) * grid.spacing[axis]
            points = centers[mine]
            points[:, axis] -= way * distance
            full = np.full(len(mine), float(np.prod(grid.spacing)) / grid.spacing[axis])
            outward = np.zeros_like(points)
            outward[:, axis] = -way
            parts.append(BoundaryFaces(mine, full, distance, points, outward, level.pieces(points)))
    found = parts[0]
    for part in parts[1:]:
        found = _joined(found, part)
    return found


def _joined(one: BoundaryFaces, other: BoundaryFaces) -> BoundaryFaces:
    names = ("cells", "areas", "distances", "points", "outward", "pieces")
    cells, areas, distances, points, outward, pieces = (
        np.concatenate([getattr(one, name), getattr(other, name)]) for name in names
    )
    return BoundaryFaces(cells, areas, distances, points, outward, pieces)


def _areas(level: Level, grid: Frame, axis: int, inside: Any, near: Any, stiff: Any) -> Floats:
    """Open areas (cells,) [m^2] of the low faces along an axis."""
    if axis not in grid.axes:
        return np.zeros(len(inside))
    full = float(np.prod(grid.spacing)) / grid.spacing[axis]
    before, first = _shifted(inside, grid, axis)
    area = np.where(inside & before & ~first, full, 0.0)
    at_edge = np.zeros(len(inside), dtype=bool)
    at_edge[near] = True
    cut_before, _ = _shifted(at_edge, grid, axis)
    held_before, _ = _shifted(stiff, grid, axis)
    chosen = np.flatnonzero((area > 0.0) & (at_edge | cut_before) & ~stiff & ~held_before)
    others = tuple(a for a in grid.axes if a != axis)
    points = grid.points(axis)[chosen]
    part = below(level.values(points), _slopes(level, points, grid, others), grid.spacing[list(others)])
    area[chosen] = np.where(part > 1e-9, full * part, 0.0)
    return area


def _relieved(volumes: Floats, areas: list[Floats], grid: Frame) -> Floats:
    """Volumes (cells,) with small ones enlarged at their neighbors' expense, so that explicit steps can stay long.

    A small cell takes volume from the neighbor with the largest common face; the total stays the same.
    """
    whole = float(np.prod(grid.spacing))
    n = len(volumes)
    index = np.arange(n).reshape(grid.shape[::-1])
    need = np.zeros(n)
    widest, giver = np.zeros(n), np.full(n, -1)
    all_open = sum(2.0 / grid.spacing[axis] ** 2 for axis in grid.axes)
    for axis in grid.axes:
        after = _after(areas[axis], grid, axis)
        need += (areas[axis] + after) / grid.spacing[axis]
        for area, way in ((areas[axis], 1), (after, -1)):
            wider = area > widest
            widest[wider] = area[wider]
            giver[wider] = np.roll(index, way, axis=2 - axis).ravel()[wider]
    missing = np.where((volumes > 0.0) & (giver >= 0), np.maximum(0.0, CROWDED * need / all_open - volumes), 0.0)
    missing = np.minimum(missing, 0.25 * whole)
    relieved = volumes + missing
    takers = np.flatnonzero(missing)
    np.subtract.at(relieved, giver[takers], missing[takers])
    return np.where(relieved > 0.0, relieved, volumes)
