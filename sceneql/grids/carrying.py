"""Advection of a field by a drift, as a term of an island."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.grids.drift_kernels import KOREN, UPWIND, VAN_LEER
from sceneql.system import Slopes

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.grids.drift import Drift
    from sceneql.grids.flow import Flow
    from sceneql.grids.ground import Ground
    from sceneql.system import Assembly

KERNELS = "sceneql.grids.drift_kernels:carry"
SLOPES = "sceneql.grids.drift_slopes_kernels:carry"
POSITIVE = "sceneql.grids.drift_positive_kernels:carry"
LIMITERS = {"none": UPWIND, "van_leer": VAN_LEER, "koren": KOREN}


def add_drift(
    drift: Drift, flow: Flow, at: int, ground: Ground, periodic: tuple[bool, ...], exchange: tuple[int, ...],
    assembly: Assembly,
) -> None:  # fmt: skip
    """Add the advection term of the field at ``at`` in y.

    ``exchange``: offsets of arrays (cells,): amount per second that inflow through the boundary brings in, outflow
    [m^3/s], and both for the reversed flow.
    """
    axes = [assembly.floats(one) for one in flow.axes]
    strength = assembly.value(drift.strength)
    cells = ground.cells
    ints = (
        at, *cells.shape, ground.divisors_at, ground.volumes_at, *(*axes, axes[0])[:3], *map(int, periodic),
        LIMITERS[drift.limiter], strength, *exchange, at + ground.count,
    )  # fmt: skip
    places = (at, cells.shape, len(axes), periodic)
    assembly.term("close", KERNELS, ints, lambda: Slopes(SLOPES, *_places(*places), positive=POSITIVE))


def _places(
    at: int, shape: tuple[int, int, int], axes: int, periodic: tuple[bool, ...]
) -> tuple[NDArray[int64], NDArray[int64]]:
    """Rows and columns of the entries of drift_slopes_kernels.carry."""
    index = np.arange(shape[0] * shape[1] * shape[2], dtype=np.int64).reshape(shape[::-1])
    own: Any = index.ravel()
    rows, columns = [own], [own]
    for axis in range(axes):
        count = shape[axis]
        numbers = [np.arange(count) + shift for shift in (-2, -1, 1)]
        # Entries of missing neighbors are 0; their columns are clipped to the row's ends.
        kept = [number % count if periodic[axis] else np.clip(number, 0, count - 1) for number in numbers]
        behind, before, after = (index.take(number, axis=2 - axis).ravel() for number in kept)
        for row in (before, own):
            rows += [row] * 4
            columns += [behind, before, own, after]
    return at + np.concatenate(rows), at + np.concatenate(columns)
