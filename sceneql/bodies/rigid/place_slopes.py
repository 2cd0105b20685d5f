"""Where the derivatives of forces at places of bodies stand in the Jacobian (place_slopes_kernels.py)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    Places = tuple[NDArray[int64], NDArray[int64]]


def force_places(pairs: Sequence[tuple[Sequence[int], Sequence[int]]]) -> Places:
    """Rows and columns for pairs of Place.ints: the one the force acts at, and the one by whose motion it changes.

    What a place with no arm lacks has an entry, always 0, among those that it has.
    """
    import numpy as np

    rows, columns = [], []
    for acted, moving in pairs:
        position, velocity, _, _, rotation, momentum, _, arm = moving
        turned, acts = arm >= 0, acted[7] >= 0
        column = [position + k for k in range(3)]
        column += [(rotation + k if turned else position) for k in range(4)] + [velocity + k for k in range(3)]
        column += [(momentum if turned else velocity) + k for k in range(3)]
        row = [acted[1] + k for k in range(3)] + [(acted[5] if acts else acted[1]) + k for k in range(3)]
        rows.append(np.repeat(row, len(column)))
        columns.append(np.tile(column, len(row)))
    return np.concatenate(rows), np.concatenate(columns)


def torque_places(place: Sequence[int]) -> Places:
    """Rows and columns of a torque on the body of Place.ints, by its place and velocity."""
    import numpy as np

    row = [place[5] + k for k in range(3)]
    column = [place[which] + k for which in (0, 1) for k in range(3)]
    return np.repeat(row, 6), np.tile(column, 3)
