# mypy: ignore-errors
"""Interval bounds of density fields over a box: compiled when `interval_kernels.box` meets a tape with parts."""

import numpy as np
from numba import types

from sceneql.compiled.kernels import lean
from sceneql.field.skeleton.density_kernels import offset
from sceneql.field.skeleton.skeleton_bounds_kernels import ULPS, box_of
from sceneql.field.skeleton.skeleton_bounds_kernels import skeleton_box as bounds_of_skeleton

ROWS = types.float64[:, ::1]
BOX = types.UniTuple(types.float64, 2)(ROWS, types.int64, types.int64, ROWS, types.int64)


@lean(BOX, inner=True)
def density_box(parts, start, stop, scratch, p):
    """Interval of a density field over the box whose sides are rows p..p+2 of scratch."""
    low = high = bulk = 0.0
    x, y, z, hx, hy, hz = box_of(scratch, p)
    diagonal = np.sqrt(hx * hx + hy * hy + hz * hz)
    for i in range(start, stop):
        wx, wy, wz = offset(parts, i, x, y, z)
        radius = parts[i, 6]
        weight = parts[i, 7]
        # Distance is 1-Lipschitz in the point.
        distance = np.sqrt(wx * wx + wy * wy + wz * wz)
        blur = ULPS * (distance + diagonal + abs(x) + abs(y) + abs(z) + abs(parts[i, 0] - parts[i, 3]))
        blur += ULPS * (abs(parts[i, 1] - parts[i, 4]) + abs(parts[i, 2] - parts[i, 5]))
        near = max(distance - diagonal - blur, 0.0)
        far = distance + diagonal + blur
        if parts[i, 0] == parts[i, 3] and parts[i, 1] == parts[i, 4] and parts[i, 2] == parts[i, 5]:
            nx = max(abs(wx) - hx - blur, 0.0)
            ny = max(abs(wy) - hy - blur, 0.0)
            nz = max(abs(wz) - hz - blur, 0.0)
            near = np.sqrt(nx * nx + ny * ny + nz * nz) - blur
        least = 1.0 - far * far / (radius * radius)
        most = 1.0 - near * abs(near) / (radius * radius)
        least = least * least * least if least > 0.0 else 0.0
        most = most * most * most if most > 0.0 else 0.0
        low += weight * (least if weight > 0.0 else most)
        high += weight * (most if weight > 0.0 else least)
        bulk += abs(weight) * most
    return low - ULPS * 8.0 * bulk, high + ULPS * 8.0 * bulk


@lean(BOX, inner=True)
def skeleton_box(parts, start, stop, scratch, p):
    """Interval of a skeleton's density over the box whose sides are rows p..p+2 of scratch."""
    return bounds_of_skeleton(parts, start, stop, scratch, p)
