# mypy: ignore-errors
"""Rays against surfaces on grids: roots of the trilinear interpolant, a cubic in each cell."""

import math

import numpy as np

from renderers.tracing.scene_kernels import CROSSING, SKIN, part
from renderers.tracing.solids.cubic_kernels import bernstein, first_root, trilinear
from renderers.tracing.solids.solids_kernels import NONE, box_span, inverse, local_point
from renderers.tracing.solids.surface_kernels import unit
from sceneql.compiled.kernels import kernel

BLOCK = 4
"""Cells along a side of the blocks that are skipped at once if they have no surface."""
LOW, HIGH, NODES, BOUND, VALUES = 12, 15, 18, 21, 22
"""Reals of a GRID behind its map to nodes (3, 4): corners of its box there, nodes along x, y, z, whether it has bounds;
the values of its nodes, those of its bounds if it has them, and for each block 1 if the surface may pass."""


@part
def cell_of(place, low, high):
    """The cell along one axis that contains a place, clamped to ``low``..``high``."""
    return int(min(max(math.floor(place), low), high))


@part
def leaving(origin, way, low, size):
    """t at which a ray leaves the piece [low, low + size] of an axis."""
    return (low + (size if way > 0.0 else 0) - origin) / way if way != 0.0 else np.inf


@part
def interpolant(r, at, nx, ny, i, j, l, x, y, z):
    """The trilinear interpolant of the values from ``at`` on, at a place in nodes in cell (i, j, l)."""
    return trilinear(r, at + (l * ny + j) * nx + i, nx, nx * ny, x - i, y - j, z - l)


@part
def corners(r, node, nx, deep):
    """(least, largest) value at the corners of the cell whose first node is ``node``."""
    low, high = r[node], r[node]
    for c in range(1, 8):
        value = r[node + (c & 1) + (nx if c & 2 else 0) + (deep if c & 4 else 0)]
        low, high = min(low, value), max(high, value)
    return low, high


@part
def within(r, bounds, nx, ny, i, j, l, sx, sy, sz, wx, wy, wz, t):
    """Whether the bounds, if there are any, are negative at a place of a ray in cell (i, j, l)."""
    return bounds == 0 or interpolant(r, bounds, nx, ny, i, j, l, sx + t * wx, sy + t * wy, sz + t * wz) < 0.0


@kernel(CROSSING.signature, _nrt=False, inner=True)
def crossing(scene, scratch, k, ox, oy, oz, dx, dy, dz, near, far, anywhere):
    """First place behind ``near`` where the interpolant of the grid whose reals begin at k changes its sign.

    A cell whose corners have one sign has no root, by the interpolant's convexity. In the others it is a cubic along
    the ray (Marmitt, Kleer, Wald, Friedrich & Slusallek 2004), whose roots are bracketed between its turning points.
    The sign is carried from cell to cell, so that rounding at a wall between two of them loses none.
    """
    r = scene.reals
    sx, sy, sz = local_point(r, k, ox, oy, oz, 1.0)
    wx, wy, wz = local_point(r, k, dx, dy, dz, 0.0)
    t, stop = near, far
    for axis in range(3):
        start, way = (sx, wx) if axis == 0 else ((sy, wy) if axis == 1 else (sz, wz))
        enter, leave = box_span(r[k + LOW + axis], r[k + HIGH + axis], start, inverse(way))
        t, stop = max(t, enter), min(stop, leave)
    if not t < stop:
        return NONE
    nx, ny, nz = int(r[k + NODES]), int(r[k + NODES + 1]), int(r[k + NODES + 2])
    values = k + VALUES
    bounds = values + nx * ny * nz if r[k + BOUND] != 0.0 else 0
    blocks = values + (2 if bounds > 0 else 1) * nx * ny * nz
    bx, by = (nx + BLOCK - 2) // BLOCK, (ny + BLOCK - 2) // BLOCK
    i = cell_of(sx + t * wx, 0, nx - 2)
    j = cell_of(sy + t * wy, 0, ny - 2)
    l = cell_of(sz + t * wz, 0, nz - 2)
    negative = interpolant(r, values, nx, ny, i, j, l, sx + t * wx, sy + t * wy, sz + t * wz) < 0.0
    while t < stop:
        met = r[blocks + (l // BLOCK * by + j // BLOCK) * bx + i // BLOCK] != 0.0
        size = 1 if met else BLOCK
        i, j, l = i // size * size, j // size * size, l // size * size
        tx, ty, tz = leaving(sx, wx, i, size), leaving(sy, wy, j, size), leaving(sz, wz, l, size)
        end = max(t, min(min(tx, ty), min(tz, stop)))
        node = values + (l * ny + j) * nx + i
        low, high = (r[node], r[node]) if not met else corners(r, node, nx, nx * ny)
        if low < 0.0 <= high:
            a, b, c, d = bernstein(
                r, node, nx, nx * ny, sx + t * wx - i, sy + t * wy - j, sz + t * wz - l,
                sx + end * wx - i, sy + end * wy - j, sz + end * wz - l,
            )  # fmt: skip
            u = 0.0
            while u < 1.0:
                u = first_root(a, b, c, d, u, negative)
                if u > 1.0:
                    break
                negative = not negative
                root = t + u * (end - t)
                if near < root < far and within(r, bounds, nx, ny, i, j, l, sx, sy, sz, wx, wy, wz, root):
                    return root
        elif (high < 0.0) != negative:
            negative = not negative
            if near < t < far and within(r, bounds, nx, ny, i, j, l, sx, sy, sz, wx, wy, wz, t):
                return t
        if end >= stop:
            break
        t = end
        if tx <= ty and tx <= tz:
            i = i + size if wx > 0.0 else i - 1
            j = cell_of(sy + t * wy, j, min(j + size, ny - 1) - 1)
            l = cell_of(sz + t * wz, l, min(l + size, nz - 1) - 1)
        elif ty <= tz:
            j = j + size if wy > 0.0 else j - 1
            i = cell_of(sx + t * wx, i, min(i + size, nx - 1) - 1)
            l = cell_of(sz + t * wz, l, min(l + size, nz - 1) - 1)
        else:
            l = l + size if wz > 0.0 else l - 1
            i = cell_of(sx + t * wx, i, min(i + size, nx - 1) - 1)
            j = cell_of(sy + t * wy, j, min(j + size, ny - 1) - 1)
        if i < 0 or j < 0 or l < 0 or i > nx - 2 or j > ny - 2 or l > nz - 2:
            break
    return NONE


@part
def rise(r, node, stride, index, count):
    """Central difference at a node, with an index below ``count`` along an axis; at its ends a one-sided one."""
    after, before = min(index + 1, count - 1), max(index - 1, 0)
    return (r[node + (after - index) * stride] - r[node + (before - index) * stride]) / (after - before)


@kernel(SKIN.signature, _nrt=False, inner=True)
def skin(scene, scratch, k, x, y, z):
    """(normal, paint) of the grid whose reals begin at k, at a point of its surface; it has no paint (3 NaN).

    The normal interpolates the central differences at the nodes: continuous where the surface has a crease between
    cells, as that of maps.interpolation for meshes.
    """
    r = scene.reals
    px, py, pz = local_point(r, k, x, y, z, 1.0)
    nx, ny, nz = int(r[k + NODES]), int(r[k + NODES + 1]), int(r[k + NODES + 2])
    i, j, l = cell_of(px, 0, nx - 2), cell_of(py, 0, ny - 2), cell_of(pz, 0, nz - 2)
    u, v, w = px - i, py - j, pz - l
    gx = gy = gz = 0.0
    for c in range(8):
        a, b, e = i + (c & 1), j + (c >> 1 & 1), l + (c >> 2)
        weight = (u if c & 1 else 1.0 - u) * (v if c & 2 else 1.0 - v) * (w if c & 4 else 1.0 - w)
        node = k + VALUES + (e * ny + b) * nx + a
        gx += weight * rise(r, node, 1, a, nx)
        gy += weight * rise(r, node, nx, b, ny)
        gz += weight * rise(r, node, nx * ny, e, nz)
    hx, hy, hz = unit(
        gx * r[k] + gy * r[k + 4] + gz * r[k + 8],
        gx * r[k + 1] + gy * r[k + 5] + gz * r[k + 9],
        gx * r[k + 2] + gy * r[k + 6] + gz * r[k + 10],
    )
    return hx, hy, hz, np.nan, np.nan, np.nan
