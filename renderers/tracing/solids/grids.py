"""Packing of surfaces on grids."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing.scene_kernels import CROSSING, SKIN
from renderers.tracing.solids.grid_kernels import BLOCK, crossing, skin
from sceneql.compiled.kernels import address

if TYPE_CHECKING:
    from numpy import bool_
    from numpy.typing import NDArray

    from renderers.tracing.scene_kernels import Scene
    from sceneql.frame import Floats, Grid


def found_by_cells(scene: Scene) -> Scene:
    """Scene with the addresses of the kernels for grids."""
    return scene._replace(grid=address(crossing, CROSSING), grid_skin=address(skin, SKIN))


def row(shape: Grid) -> Floats:
    """Reals (1, r) of a GRID (see grid_kernels)."""
    counts = shape.values.shape[::-1]
    bounds = np.empty(0) if shape.bounds is None else shape.bounds
    head = [*np.asarray(shape.to_nodes).ravel(), *shape.low, *shape.high, *counts, float(shape.bounds is not None)]
    return np.concatenate([head, shape.values.ravel(), bounds.ravel(), met(shape.values).ravel()])[None, :]


def box(shape: Grid) -> Floats:
    """Low and high corner (1, 6) in the world [m]."""
    to_world = np.linalg.inv(np.asarray(shape.to_nodes)[:, :3])
    low, high = np.array(shape.low), np.array(shape.high)
    middle = to_world @ (0.5 * (low + high) - np.asarray(shape.to_nodes)[:, 3])
    reach = np.abs(to_world) @ (0.5 * (high - low)) * (1 + 1e-9)
    return np.concatenate([middle - reach, middle + reach])[None, :]


def met(values: Floats) -> NDArray[bool_]:
    """Mask (bz, by, bx) of the blocks with corners of both signs, in which the surface may lie."""
    return blocks_with(values < 0.0) & blocks_with(values >= 0.0)


def blocks_with(corners: NDArray[bool_]) -> NDArray[bool_]:
    """Mask (bz, by, bx) of the blocks of cells with any corner set; ``corners`` (nz, ny, nx)."""
    for axis in range(3):
        starts = np.arange(0, corners.shape[axis] - 1, BLOCK)
        ends = np.minimum(starts + BLOCK, corners.shape[axis] - 1)
        corners = np.logical_or.reduceat(corners, starts, axis=axis) | np.take(corners, ends, axis=axis)
    return corners
