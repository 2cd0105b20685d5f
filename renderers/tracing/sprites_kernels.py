# mypy: ignore-errors
"""Soft discs over the rows of a picture."""

import math

from numba import types

from renderers.tracing.record_kernels import OWNER, PLACE
from sceneql.compiled.kernels import lean, lean_inlined

_i = types.int64
_reals = types.float64[::1]
_table = types.float64[:, ::1]
_rows = types.float32[:, ::1]


@lean_inlined
def depth_of(record, camera):
    """Distance before the camera, along its axis, of the surface seen in a pixel; infinite for the sky."""
    if record[OWNER] == 0.0:
        return math.inf
    away = 0.0
    for c in range(3):
        away -= (record[PLACE + c] - camera[c]) * camera[3 + c]
    return away


@lean(types.void(_i, _i, _i, _reals, _table, types.boolean, _rows, _rows))
def cover_rows(start, stop, width, camera, discs, covers, records, linear):
    """Draw the discs (n, 15) of sprites.py in their order over the rows start..stop - 1.

    A disc has the profile (1 - q^2)^2 of the distance q from its middle, relative to its radius. It fades within its
    own depth where it cuts through a surface, so that no edge shows.
    """
    for k in range(discs.shape[0]):
        x, y, depth, radius, reach = discs[k, 0], discs[k, 1], discs[k, 2], discs[k, 3], discs[k, 4]
        top, bottom = max(float(start), math.ceil(y - radius - 0.5)), min(stop - 1.0, math.floor(y + radius - 0.5))
        left, right = max(0.0, math.ceil(x - radius - 0.5)), min(width - 1.0, math.floor(x + radius - 0.5))
        if top > bottom or left > right:
            continue
        for row in range(int(top), int(bottom) + 1):
            for column in range(int(left), int(right) + 1):
                dx, dy = column + 0.5 - x, row + 0.5 - y
                inside = 1.0 - (dx * dx + dy * dy) / (radius * radius)
                if inside <= 0.0:
                    continue
                pixel = row * width + column
                before = 0.5 + 0.5 * (depth_of(records[pixel], camera) - depth) / reach
                part = discs[k, 5] * inside * inside * min(1.0, max(0.0, before))
                keep = 1.0 - part if covers else 1.0
                u, v = dx / radius, -dy / radius
                for c in range(3):
                    own = max(0.0, discs[k, 6 + c] + u * discs[k, 9 + c] + v * discs[k, 12 + c])
                    linear[pixel, c] = linear[pixel, c] * keep + part * own
