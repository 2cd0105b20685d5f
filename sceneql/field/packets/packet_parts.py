"""The parts of a tape converted to float32 columns, in the layout of packet_rows.

Imports numpy: to be imported by the function that needs it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.field.packets import packet_rows as rows
from sceneql.field.packets import point_blocks_kernels as blocks
from sceneql.field.packets.packet_kernels import VECTOR
from sceneql.field.skeleton.skeleton import CURVE, NODE, TRIANGLE

if TYPE_CHECKING:
    from numpy import float32
    from numpy.typing import NDArray

    from sceneql.frame import Floats

BLUR = 4.0e-7
"""Rounding error of a position in float32, relative to the sum of its terms: six half units in the last place."""
MORE = 1.0 + 8.0e-6
"""Factor that keeps upper bounds valid after rounding to float32."""


def density_columns(parts: Floats) -> NDArray[float32]:
    """Columns (PART, p) of the p parts of an operation DENSITY, from its rows (p, 8)."""
    out = np.zeros((rows.PART, len(parts)))
    a, b, radius = parts[:, :3], parts[:, 3:6], parts[:, 6]
    _place(out, a, b - a, radius, BLUR * (np.abs(a) + np.abs(b - a)).sum(axis=1))
    out[rows.WEIGHT] = parts[:, 7]
    _enclose(out, np.stack([a, b]), radius)
    return _single(out)


def skeleton_columns(parts: Floats) -> NDArray[float32]:
    """Columns (PART, r) of an operation SKELETON, two a part, from its rows (r, 8). The REACH of nodes is -1."""
    first, second = parts[::2], parts[1::2]
    shape = second[:, 6]
    a, b, c = first[:, :3], first[:, 3:6], second[:, :3]
    out = np.zeros((rows.PART, len(parts)))
    one, two = out[:, ::2], out[:, 1::2]
    along, across = b - a, c - a
    curved, flat = shape == CURVE, shape == TRIANGLE
    # A segment of length 0 has the radius at a, as in skeleton_kernels.to_segment.
    last = np.where(~curved & ((along**2).sum(axis=1) == 0.0), first[:, 6], second[:, 3])
    radii = np.stack([first[:, 6], last, np.where(curved, second[:, 7], first[:, 6])])
    small, large = radii.min(axis=0), radii.max(axis=0)
    with np.errstate(all="ignore"):  # rows of nodes give inf and NaN, overwritten below
        worse = np.where(flat, second[:, 7], 1.0)
        _place(one, a, along, small, BLUR * worse * (np.abs(a) + np.abs(along) + np.abs(across)).sum(axis=1))
        one[rows.WEIGHT] = first[:, 7]
        shares = np.array([[0.5, 0.5, 0.0], [1 / 3, 1 / 3, 1 / 3], [0.0, 0.0, 0.0], [0.25, 0.25, 0.5]])
        at = shares[shape.astype(int)].T
        corners = np.stack([a, b, c])
        anchor = (at[:, :, None] * corners).sum(axis=0)
        one[rows.ANCHOR_X : rows.ANCHORED], one[rows.ANCHORED] = anchor.T, 1.0 / (at * radii).sum(axis=0)
        one[rows.AWAY] = MORE * np.sqrt(((corners - anchor) ** 2).sum(axis=2).max(axis=0))
        two[rows.FAR] = _enclose(one, corners, large)
        two[rows.CX : rows.CX + 3] = across.T
        two[rows.KERNEL], two[rows.GROUP], two[rows.SHAPE] = second[:, 4], second[:, 5], shape
        bend = a - 2.0 * c + b
        two[rows.RADIUS_A : rows.RADIUS_C + 1] = radii
        two[rows.CUBE] = MORE / small**3
        sag = 0.25 * MORE * np.where(curved, np.sqrt((bend**2).sum(axis=1)), 0.0)
        two[rows.EVEN] = sag + MORE * (large - small)
        two[rows.CONE] = sag + np.where(curved, 0.25 * MORE * np.abs(radii[0] + radii[1] - 2.0 * radii[2]), 0.0)
        two[rows.VX : rows.VX + 3] = bend.T
        normal = np.cross(along, across)
        area2 = (normal**2).sum(axis=1)[:, None]
        flats = [np.cross(across, normal) / area2, np.cross(normal, along) / area2, normal / np.sqrt(area2)]
        two[rows.GX : rows.NZ + 1, flat] = np.concatenate([vector.T for vector in flats])[:, flat]
    out[:, np.repeat(shape == NODE, 2)] = 0.0
    one[rows.REACH, shape == NODE] = two[rows.REACH] = -1.0
    return _single(out)


def point_blocks(parts: Floats) -> NDArray[float32]:
    """Columns, in the layout of point_blocks_kernels, of a SKELETON whose parts are all points; ``parts`` (r, 8)."""
    places = np.flatnonzero(parts[1::2, 6] != NODE) * 2
    points = parts[places]
    reach = points[:, 6] + blocks.ROUNDED * (np.abs(points[:, :3]).sum(axis=1) + points[:, 6])
    n = len(points)
    levels = [(points[:, :3] - reach[:, None], points[:, :3] + reach[:, None])]
    for _ in range(2):
        starts = np.arange(0, len(levels[-1][0]), VECTOR)
        low, high = levels[-1]
        levels.append((np.minimum.reduceat(low, starts), np.maximum.reduceat(high, starts)))
    sizes = [-(-len(low) // VECTOR) * VECTOR for low, _ in levels]
    out = np.zeros((blocks.BLOCKS, sum(sizes)))
    out[:3, :n], out[blocks.REACH2, :n], out[blocks.ROW, :n] = points[:, :3].T, reach**2, places
    out[blocks.COUNT, 0] = n
    for start, (low, high) in zip((sizes[0], sizes[0] + sizes[1]), levels[1:], strict=True):
        room = blocks.ROUNDED * (np.abs(low) + np.abs(high))
        out[:3, start : start + len(low)], out[3:, start : start + len(low)] = (low - room).T, (high + room).T
    return _single(out)


def _place(out: Floats, a: Floats, along: Floats, radius: Floats, blur: Floats) -> None:
    """Fill the rows of ends a (p, 3), axes ``along`` (p, 3), radii (p,) and rounding errors ``blur`` (p,)."""
    length2 = (along**2).sum(axis=1)
    out[rows.AX : rows.AX + 3], out[rows.SX : rows.SX + 3] = a.T, along.T
    out[rows.INVERSE], out[rows.RADIUS], out[rows.BLUR] = 1.0 / radius**2, radius, blur
    out[rows.SHRINK] = np.divide(1.0, length2, out=np.zeros(len(a)), where=length2 > 0.0)


def _enclose(out: Floats, corners: Floats, radius: Floats) -> Floats:
    """Fill the rows of the bounding boxes of corners (k, p, 3) and of REACH; returns the square root of REACH (p,)."""
    for axis in range(3):
        out[rows.LOW_X + 2 * axis] = corners[:, :, axis].min(axis=0)
        out[rows.HIGH_X + 2 * axis] = corners[:, :, axis].max(axis=0)
    far: Floats = (radius + 2.0 * out[rows.BLUR]) * MORE
    out[rows.REACH] = far**2 * MORE
    return far


def _single(out: Floats) -> NDArray[float32]:
    """The array as float32. Too large numbers become infinite, for which the kernels claim no bound."""
    with np.errstate(over="ignore"):
        single: NDArray[float32] = out.astype(np.float32)
    return single
