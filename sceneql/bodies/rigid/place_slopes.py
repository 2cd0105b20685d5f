"""Sparsity of the Jacobian of forces at places on bodies (place_slopes_kernels.py)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    Places = tuple[NDArray[int64], NDArray[int64]]


def force_places(pairs: Sequence[tuple[Sequence[int], Sequence[int]]]) -> Places:
    """Rows and columns of the Jacobian's entries, for pairs of Place.ints (acted, moving).

    The force acts at the first place and depends on the motion of the second. Rotation and angular momentum of a place
    without an arm do not exist; their entries, always 0, are put at its position and velocity.
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
    """Rows and columns of the Jacobian of a torque on a body by the position and velocity of a place (Place.ints)."""
    import numpy as np

    row = [place[5] + k for k in range(3)]
    column = [place[which] + k for which in (0, 1) for k in range(3)]
    return np.repeat(row, 6), np.tile(column, 3)
