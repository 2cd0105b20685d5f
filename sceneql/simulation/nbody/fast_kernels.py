# mypy: ignore-errors
"""Direct sums in single precision: the parts of direct_kernels, with twice as many lanes and shorter arithmetic.

Places are taken from the middle of all bodies, in units of their extent, as a float32 and the rest of it, so that the
distances of near bodies are as good as those of far ones; sums are single within a pair of tiles alone. Fixed
operations keep the bits. Bodies closer than 1e-10 of the extent pull each other less than they should.
"""

import numpy as np
from numba import types

from sceneql.kernels import kernel, lean, lean_inlined
from sceneql.simulation.arithmetic_kernels import fma, inverse_cube_single, widest
from sceneql.simulation.nbody.direct_kernels import FORCES, LANES, PARTS, SOURCES, STRIP, folded
from sceneql.simulation.nbody.weights_kernels import POINTS, ROOM, SOFTENING, WEIGHTS
from sceneql.simulation.threads_kernels import TILE
from sceneql.system_kernels import A, I, N

S = types.float32[::1]
X, Y, Z, XL, YL, ZL, W, FX, FY, FZ, ROWS = range(11)
"""Rows of a tile: places, what they lack, weights, forces."""
FLOOR = 1e-20
"""Added to squared distances in units of the extent."""


@lean_inlined
def pull(source, j, soft, px, py, pz, qx, qy, qz, w):
    """The force of body j of a tile on a body at p + q of weight w: its size by distance, and the way (3)."""
    dx = (source[X * LANES + j] - px) + (source[XL * LANES + j] - qx)
    dy = (source[Y * LANES + j] - py) + (source[YL * LANES + j] - qy)
    dz = (source[Z * LANES + j] - pz) + (source[ZL * LANES + j] - qz)
    square = fma(dx, dx, fma(dy, dy, fma(dz, dz, soft)))
    return inverse_cube_single(square, w * source[W * LANES + j]), dx, dy, dz


@lean(types.void(S, S, N, types.float32, S), inner=True)
def strips(one, other, j, soft, sums):
    """As in direct_kernels."""
    widest()
    for first in range(0, LANES, STRIP):
        for l in range(STRIP):
            k = first + l
            px, py, pz, w = one[X * LANES + k], one[Y * LANES + k], one[Z * LANES + k], one[W * LANES + k]
            qx, qy, qz = one[XL * LANES + k], one[YL * LANES + k], one[ZL * LANES + k]
            fx, fy, fz = one[FX * LANES + k], one[FY * LANES + k], one[FZ * LANES + k]
            f, dx, dy, dz = pull(other, j, soft, px, py, pz, qx, qy, qz, w)
            fx, fy, fz = fma(f, dx, fx), fma(f, dy, fy), fma(f, dz, fz)
            ax, ay, az = fma(f, dx, sums[l]), fma(f, dy, sums[STRIP + l]), fma(f, dz, sums[2 * STRIP + l])
            f, dx, dy, dz = pull(other, j + 1, soft, px, py, pz, qx, qy, qz, w)
            fx, fy, fz = fma(f, dx, fx), fma(f, dy, fy), fma(f, dz, fz)
            bx = fma(f, dx, sums[3 * STRIP + l])
            by = fma(f, dy, sums[4 * STRIP + l])
            bz = fma(f, dz, sums[5 * STRIP + l])
            f, dx, dy, dz = pull(other, j + 2, soft, px, py, pz, qx, qy, qz, w)
            fx, fy, fz = fma(f, dx, fx), fma(f, dy, fy), fma(f, dz, fz)
            cx = fma(f, dx, sums[6 * STRIP + l])
            cy = fma(f, dy, sums[7 * STRIP + l])
            cz = fma(f, dz, sums[8 * STRIP + l])
            f, dx, dy, dz = pull(other, j + 3, soft, px, py, pz, qx, qy, qz, w)
            one[FX * LANES + k] = fma(f, dx, fx)
            one[FY * LANES + k] = fma(f, dy, fy)
            one[FZ * LANES + k] = fma(f, dz, fz)
            sums[9 * STRIP + l] = fma(f, dx, sums[9 * STRIP + l])
            sums[10 * STRIP + l] = fma(f, dy, sums[10 * STRIP + l])
            sums[11 * STRIP + l] = fma(f, dz, sums[11 * STRIP + l])
            sums[l], sums[STRIP + l], sums[2 * STRIP + l] = ax, ay, az
            sums[3 * STRIP + l], sums[4 * STRIP + l], sums[5 * STRIP + l] = bx, by, bz
            sums[6 * STRIP + l], sums[7 * STRIP + l], sums[8 * STRIP + l] = cx, cy, cz


@lean(types.void(S, S, S, types.float32), inner=True)
def attract(one, other, sums, soft):
    """Add the forces between the bodies of two tiles; sums (3 SOURCES STRIP,): scratch."""
    for j in range(0, LANES, SOURCES):
        for k in range(3 * SOURCES * STRIP):
            sums[k] = np.float32(0.0)
        strips(one, other, j, soft, sums)
        for source in range(SOURCES):
            for c in range(3):
                other[(FX + c) * LANES + j + source] -= folded(sums[(3 * source + c) * STRIP :])


@lean(types.void(A, I, A, S, N), inner=True)
def take(floats, ints, unit, tile, first):
    """The LANES bodies from ``first`` on, without forces; ``unit``: middle (3), 1 / extent, 1 / largest weight."""
    for c in range(3):
        places = floats[ints[POINTS] + c * ints[ROOM] + first : ints[POINTS] + c * ints[ROOM] + first + LANES]
        middle, scale = unit[c], unit[3]
        for k in range(LANES):
            place = (places[k] - middle) * scale
            rounded = np.float32(place)
            tile[c * LANES + k] = rounded
            tile[(XL + c) * LANES + k] = np.float32(place - np.float64(rounded))
            tile[(FX + c) * LANES + k] = np.float32(0.0)
    weights, scale = floats[ints[WEIGHTS] + first : ints[WEIGHTS] + first + LANES], unit[4]
    for k in range(LANES):
        tile[W * LANES + k] = np.float32(weights[k] * scale)


@lean(types.void(S, A, N, N), inner=True)
def leave(tile, floats, at, room):
    """Add the forces of a tile to the sums at floats[at:], and begin anew."""
    for c in range(3):
        for k in range(LANES):
            floats[at + c * room + k] += np.float64(tile[(FX + c) * LANES + k])
            tile[(FX + c) * LANES + k] = np.float32(0.0)


@lean(types.void(A, I, A), inner=True)
def units(floats, ints, unit):
    """Middle (3) of all bodies, 1 / their extent, 1 / the largest weight."""
    room, at = ints[ROOM], ints[POINTS]
    side = 0.0
    for c in range(3):
        low, high = floats[at + c * room], floats[at + c * room]
        for k in range(room):
            low, high = min(low, floats[at + c * room + k]), max(high, floats[at + c * room + k])
        unit[c] = 0.5 * (low + high)
        side = max(side, high - low)
    most = 0.0
    for k in range(room):
        most = max(most, abs(floats[ints[WEIGHTS] + k]))
    unit[3] = 1.0 / side if side > 0.0 else 1.0
    unit[4] = 1.0 / most if most > 0.0 else 1.0


@kernel(TILE, inner=True)
def fast_tile(part, t, y, rate, floats, ints):
    """As direct_tile: the sums of one part, of its rows of tiles."""
    room, parts = ints[ROOM], ints[PARTS]
    sums = ints[FORCES] + 3 * room * part
    for k in range(3 * room):
        floats[sums + k] = 0.0
    unit = np.empty(5)
    units(floats, ints, unit)
    soft = np.float32((floats[ints[SOFTENING]] * unit[3]) ** 2 + FLOOR)
    one, other = np.empty(ROWS * LANES, dtype=np.float32), np.empty(ROWS * LANES, dtype=np.float32)
    scratch = np.empty(3 * SOURCES * STRIP, dtype=np.float32)
    tiles = room // LANES
    for turn in range(0, tiles, parts):
        row = turn + (part if turn // parts % 2 == 0 else parts - 1 - part)
        if row >= tiles:
            continue
        take(floats, ints, unit, one, LANES * row)
        take(floats, ints, unit, other, LANES * row)
        attract(one, other, scratch, soft)
        leave(one, floats, sums + LANES * row, room)
        for column in range(row + 1, tiles):
            take(floats, ints, unit, other, LANES * column)
            attract(one, other, scratch, soft)
            leave(other, floats, sums + LANES * column, room)
            leave(one, floats, sums + LANES * row, room)
    scale = (unit[3] / unit[4]) ** 2
    for k in range(3 * room):
        floats[sums + k] *= scale
