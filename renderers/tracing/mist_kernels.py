# mypy: ignore-errors
"""Mists on the way of a ray: what is left of light, and what they send along it.

The optical depth is exact for the trilinear interpolant of absorption: between nodes that is a cubic along a ray, which
Gauss's two-point rule integrates. What a mist sends (its source, the radiance of a place where it is thick) is taken
from the middle of each piece of a ray in a cell (order 2).
"""

import math

import numpy as np

from renderers.tracing import layout
from renderers.tracing.scene_kernels import MIST, part
from renderers.tracing.solids.cubic_kernels import trilinear
from renderers.tracing.solids.grid_kernels import BLOCK, cell_of, leaving
from renderers.tracing.solids.solids_kernels import box_span, inverse, local_point
from sceneql.compiled.kernels import kernel

GAUSS = 0.5 / math.sqrt(3.0)
OPAQUE = 14.0
"""Optical depth behind which nothing is seen, since less than a millionth of it is left."""


@part
def span(u, k, sx, sy, sz, wx, wy, wz, near, far):
    """The part of (near, far) of a ray, by nodes, in the box of the mist whose reals begin at k; or an empty one."""
    for axis in range(3):
        start, way = (sx, wx) if axis == 0 else ((sy, wy) if axis == 1 else (sz, wz))
        enter, leave = box_span(u[k + layout.MIST_LOW + axis], u[k + layout.MIST_HIGH + axis], start, inverse(way))
        near, far = max(near, enter), min(far, leave)
    return near, far


@part
def pass_mist(u, k, ox, oy, oz, dx, dy, dz, near, far, sends):
    """(what is left of light, radiance that is sent (3)) of one mist on a ray in (near, far).

    What is sent is left out unless ``sends``.
    """
    sx, sy, sz = local_point(u, k, ox, oy, oz, 1.0)
    wx, wy, wz = local_point(u, k, dx, dy, dz, 0.0)
    t, stop = span(u, k, sx, sy, sz, wx, wy, wz, near, far)
    if not t < stop:
        return 1.0, 0.0, 0.0, 0.0
    meter = np.sqrt(dx * dx + dy * dy + dz * dz)
    nx, ny, nz = int(u[k + layout.NODES]), int(u[k + layout.NODES + 1]), int(u[k + layout.NODES + 2])
    deep = nx * ny
    values = k + layout.ABSORPTION
    source = values + nx * ny * nz
    lit = sends and u[k + layout.LIT] != 0.0
    blocks = source + (3 * nx * ny * nz if u[k + layout.LIT] != 0.0 else 0)
    bx, by = (nx + BLOCK - 2) // BLOCK, (ny + BLOCK - 2) // BLOCK
    i = cell_of(sx + t * wx, 0, nx - 2)
    j = cell_of(sy + t * wy, 0, ny - 2)
    l = cell_of(sz + t * wz, 0, nz - 2)
    depth, left = 0.0, 1.0
    r = g = b = 0.0
    while t < stop:
        empty = u[blocks + (l // BLOCK * by + j // BLOCK) * bx + i // BLOCK] == 0.0
        size = BLOCK if empty else 1
        if empty:
            i, j, l = i // size * size, j // size * size, l // size * size
        tx, ty, tz = leaving(sx, wx, i, size), leaving(sy, wy, j, size), leaving(sz, wz, l, size)
        end = min(min(tx, ty), min(tz, stop))
        if end > t:
            if not empty:
                middle, half = 0.5 * (t + end), GAUSS * (end - t)
                node = values + l * deep + j * nx + i
                px, py, pz = sx + middle * wx - i, sy + middle * wy - j, sz + middle * wz - l
                hx, hy, hz = half * wx, half * wy, half * wz
                thick = trilinear(u, node, nx, deep, px - hx, py - hy, pz - hz)
                thick += trilinear(u, node, nx, deep, px + hx, py + hy, pz + hz)
                thick *= 0.5 * meter * (end - t)
                if thick > 0.0:
                    depth += thick
                    if lit:
                        after = np.exp(-depth)
                        some = left - after
                        left = after
                        node = source + 3 * (l * deep + j * nx + i)
                        r += some * trilinear3(u, node, 3 * nx, 3 * deep, px, py, pz)
                        g += some * trilinear3(u, node + 1, 3 * nx, 3 * deep, px, py, pz)
                        b += some * trilinear3(u, node + 2, 3 * nx, 3 * deep, px, py, pz)
                    if depth > OPAQUE:
                        break
            t = end
        if end >= stop:
            break
        if tx <= ty and tx <= tz:
            i = i + size if wx > 0.0 else i - 1
            if empty:
                j = cell_of(sy + t * wy, j, min(j + size, ny - 1) - 1)
                l = cell_of(sz + t * wz, l, min(l + size, nz - 1) - 1)
        elif ty <= tz:
            j = j + size if wy > 0.0 else j - 1
            if empty:
                i = cell_of(sx + t * wx, i, min(i + size, nx - 1) - 1)
                l = cell_of(sz + t * wz, l, min(l + size, nz - 1) - 1)
        else:
            l = l + size if wz > 0.0 else l - 1
            if empty:
                i = cell_of(sx + t * wx, i, min(i + size, nx - 1) - 1)
                j = cell_of(sy + t * wy, j, min(j + size, ny - 1) - 1)
        if i < 0 or j < 0 or l < 0 or i > nx - 2 or j > ny - 2 or l > nz - 2:
            break
    left = np.exp(-depth)
    if sends and not lit:
        r, g, b = (
            (1.0 - left) * u[k + layout.MIST_COLOR],
            (1.0 - left) * u[k + layout.MIST_COLOR + 1],
            (1.0 - left) * u[k + layout.MIST_COLOR + 2],
        )
    return left, r, g, b


@part
def trilinear3(u, node, up, deep, x, y, z):
    """The interpolant of one of three numbers that stand together at each node."""
    front = (1.0 - y) * (u[node] + x * (u[node + 3] - u[node]))
    front += y * (u[node + up] + x * (u[node + up + 3] - u[node + up]))
    node += deep
    back = (1.0 - y) * (u[node] + x * (u[node + 3] - u[node]))
    back += y * (u[node + up] + x * (u[node + up + 3] - u[node + up]))
    return front + z * (back - front)


@kernel(MIST.signature, _nrt=False)
def mists_along(scene, ox, oy, oz, dx, dy, dz, near, far, want):
    """(what is left of light, radiance that is sent (3)) on a ray in (near, far), by ``want``.

    SEEN: all mists; LIGHT: those that are lit, which light from around meets; LEFT: these, and nothing that they send.
    Mists follow one another by where the ray enters their boxes: of those in one another one covers the other.
    """
    u = scene.reals
    left = 1.0
    r = g = b = 0.0
    count = scene.ints[layout.MISTS]
    after, of = -np.inf, -1
    for _ in range(count):
        entry, found = np.inf, -1
        for m in range(count):
            k = scene.ints[scene.ints[layout.MISTS_AT] + m]
            if want != layout.SEEN and u[k + layout.LIT] == 0.0:
                continue
            first = 0.0
            if count > 1:
                sx, sy, sz = local_point(u, k, ox, oy, oz, 1.0)
                wx, wy, wz = local_point(u, k, dx, dy, dz, 0.0)
                first, last = span(u, k, sx, sy, sz, wx, wy, wz, near, far)
                if not first < last:
                    continue
            if (first > after or (first == after and m > of)) and first < entry:
                entry, found = first, m
        if found < 0:
            break
        after, of = entry, found
        k = scene.ints[scene.ints[layout.MISTS_AT] + found]
        share, mr, mg, mb = pass_mist(u, k, ox, oy, oz, dx, dy, dz, near, far, want != layout.LEFT)
        r, g, b = r + left * mr, g + left * mg, b + left * mb
        left *= share
    return left, r, g, b
