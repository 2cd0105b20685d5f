# mypy: ignore-errors
"""What soft discs leave of the light of a direction."""

import math

from numba import types

from sceneql.compiled.kernels import lean

_reals = types.float64[::1]
_table = types.float64[:, ::1]


@lean(types.void(types.int64[::1], _table, _reals, _reals, _table, _reals))
def thin_out(order, places, radii, opacity, whole, left):
    """Write what discs leave of the light at places behind them.

    ``places`` (n + m, 2) of n discs and m places asked for, in cells of the map ``whole`` (h, w), which begins as ones
    and is what all discs so far leave; ``order``: of all these, from the lamp on. Discs have ``radii`` (n,) in cells,
    and the profile of sprites_kernels.cover_rows. ``left`` (m,) is read between the middles of four cells.
    """
    count = radii.shape[0]
    tall, wide = whole.shape
    for k in range(order.shape[0]):
        i = order[k]
        x, y = places[i, 0], places[i, 1]
        if i >= count:
            x, y = min(max(x - 0.5, 0.0), wide - 1.001), min(max(y - 0.5, 0.0), tall - 1.001)
            column, row = int(x), int(y)
            u, v = x - column, y - row
            near = whole[row, column] + u * (whole[row, column + 1] - whole[row, column])
            far = whole[row + 1, column] + u * (whole[row + 1, column + 1] - whole[row + 1, column])
            left[i - count] = near + v * (far - near)
            continue
        radius = radii[i]
        top, bottom = max(0, math.ceil(y - radius - 0.5)), min(tall - 1, math.floor(y + radius - 0.5))
        first, last = max(0, math.ceil(x - radius - 0.5)), min(wide - 1, math.floor(x + radius - 0.5))
        for row in range(int(top), int(bottom) + 1):
            for column in range(int(first), int(last) + 1):
                dx, dy = column + 0.5 - x, row + 0.5 - y
                inside = 1.0 - (dx * dx + dy * dy) / (radius * radius)
                if inside > 0.0:
                    whole[row, column] *= 1.0 - opacity[i] * inside * inside
