"""The groups of entries of a state with a common error scale (stepping/error_scales_kernels.py)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.stepping.error_scales_kernels import GROUP_OF, SHARED

if TYPE_CHECKING:
    from numpy import bool_, int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.island.system import System
    from sceneql.system import Prepared, Stepper


def error_scales(system: System) -> tuple[NDArray[int64], Floats]:
    """The plan (groups of entries) and the scales before the first step.

    Positions of a model's masses share a scale; so do their velocities, the cells of a field, and entries that words
    declare alike. Other entries have their own. Tallies, on which nothing depends, have a scale of at least 1 in SI.
    """
    group = np.full(len(system.y), -1, dtype=np.int64)
    shared = 0
    for velocity_at, _, count in system.masses:
        velocities = np.arange(velocity_at, velocity_at + 3 * count)
        for members in (np.isin(system.partner, velocities), velocities):
            group[members] = shared
            shared += 1
    for at, count in system.alike:
        group[at : at + count] = shared
        shared += 1
    for grid in system.grids:
        group[grid.at : grid.at + int(np.prod(grid.cells.shape))] = shared
        shared += 1
    sums = system.pattern.tallies if system.pattern is not None and system.pattern.exact else _sums(system)
    tallies = sums[group[sums] < 0]
    group[tallies] = shared + np.arange(len(tallies))
    alone = np.flatnonzero(group < 0)
    shared += len(tallies)
    group[alone] = shared + np.arange(len(alone))
    groups = shared + len(alone)
    scales = np.zeros(1 + 4 * groups)
    scales[1 + group[tallies]] = 1.0
    return np.concatenate([[groups, shared, 2 * len(system.masses)], group]), scales


def prepare(system: System, stepper: Stepper) -> Prepared:
    """Prepare a tableau's step whose errors are measured by scales (runge_kutta_kernels.py)."""
    from sceneql.system import Prepared

    method = stepper.method
    plan, scales = error_scales(system)
    return Prepared(
        settings=np.concatenate([method.settings, scales, [np.nan]]),
        numbers=np.concatenate([method.numbers[:-1], [len(plan)], plan]),
        work=(method.work + 3) * len(system.y),
        alone=alone(plan),
        scales=(len(method.settings), len(scales)),
    )


def alone(plan: NDArray[int64]) -> NDArray[bool_]:
    """(n,) bool: entries with a scale of their own."""
    found: NDArray[bool_] = plan[GROUP_OF:] >= plan[SHARED]
    return found


def _sums(system: System) -> NDArray[int64]:
    """(k,) all entries of models of masses and fields, among which those in no group yet are tallies."""
    found = np.zeros(len(system.y), dtype=bool)
    at = [velocity_at for velocity_at, _, _ in system.masses] + [grid.at for grid in system.grids]
    at += [first for first, _ in system.inertia]
    for first, last, _, _ in system.ranges:
        found[first:last] = any(first <= one < last for one in at)
    return np.flatnonzero(found)
