"""The groups of entries of a state with a common error scale (stepping/error_scales_kernels.py)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.island.system import System


def error_scales(system: System) -> tuple[NDArray[int64], Floats]:
    """The plan and the scales before the first step. The island must have a pattern.

    Positions of a model's masses share a scale, and so do their velocities, and the cells of a field; other entries
    have their own. Sums on which nothing depends, such as the energy lost by damping, have a scale of at least 1 in SI.
    """
    assert system.pattern is not None
    group = np.full(len(system.y), -1, dtype=np.int64)
    shared = 0
    for velocity_at, _, count in system.masses:
        velocities = np.arange(velocity_at, velocity_at + 3 * count)
        for members in (np.isin(system.partner, velocities), velocities):
            group[members] = shared
            shared += 1
    for grid in system.grids:
        group[grid.at : grid.at + int(np.prod(grid.cells.shape))] = shared
        shared += 1
    tallies = system.pattern.tallies[group[system.pattern.tallies] < 0]
    group[tallies] = shared + np.arange(len(tallies))
    alone = np.flatnonzero(group < 0)
    shared += len(tallies)
    group[alone] = shared + np.arange(len(alone))
    groups = shared + len(alone)
    scales = np.zeros(1 + 2 * groups)
    scales[1 + group[tallies]] = 1.0
    return np.concatenate([[groups, shared, 2 * len(system.masses)], group]), scales
