# mypy: ignore-errors
"""Direct sums in single precision: the parts of direct_kernels, with twice as many lanes and shorter arithmetic.

Places are taken from the middle of all bodies, in units of their extent, as a float32 and the rest of it, so that the
distances of near bodies are as good as those of far ones; sums are single within a pair of tiles alone. Fixed
operations keep the bits. Bodies closer than 1e-10 of the extent pull each other less than they should.
"""

import numpy as np
from numba import types

from sceneql.compiled.arithmetic_kernels import widest
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.compiled.lanes_kernels import aligned, fma, folded, guess, load, spread, store
from sceneql.compiled.threads_kernels import TILE
from sceneql.nbody import layout
from sceneql.nbody.direct_kernels import FORCES, FX, FY, FZ, LANES, PARTS, W, X, Y, Z
from sceneql.system.signatures_kernels import A, I, N

S = types.float32[::1]
XL, YL, ZL, ROWS = range(7, 11)
"""Rows of a tile after those of direct_kernels: the places' low parts."""
WIDTH = 16
"""Bodies that are worked on together."""
FLOOR = 1e-20
"""Added to squared distances in units of the extent."""


@lean_inlined
def inverse_cube(s, w):
    """w s^(-3/2) of float32 s > 0: a guess r of s^(-1/2) leaves e = 1 - s r^2 within 7 %, and a polynomial of least
    greatest error, 2.6e-7, stands for (1 - e)^(-3/2).
    """
    r = guess(s)
    c = r * r
    e = fma(s * -1.0, c, 1.0)
    p = fma(fma(fma(fma(2.46489084, e, 2.20332663), e, 1.87502927), e, 1.49998157), e, 0.99999998)
    return (r * c) * (w * p)


@lean_inlined
def pull(one, k, other, j, soft):
    """As in direct_kernels, for places in two parts, high and low."""
    dx = other[X * LANES + j] - load(one, X * LANES + k) + (other[XL * LANES + j] - load(one, XL * LANES + k))
    dy = other[Y * LANES + j] - load(one, Y * LANES + k) + (other[YL * LANES + j] - load(one, YL * LANES + k))
    dz = other[Z * LANES + j] - load(one, Z * LANES + k) + (other[ZL * LANES + j] - load(one, ZL * LANES + k))
    w = other[W * LANES + j] * load(one, W * LANES + k)
    return inverse_cube(fma(dx, dx, fma(dy, dy, fma(dz, dz, soft))), w), dx, dy, dz


@lean(types.void(S, S, types.float32, S), inner=True)
def attract(one, other, soft, sums):
    """As in direct_kernels."""
    widest()
    for at in range(0, 3 * LANES * WIDTH, WIDTH):
        store(sums, at, spread(np.float32(0.0)))
    for k in range(0, LANES, WIDTH):
        fx, fy, fz = load(one, FX * LANES + k), load(one, FY * LANES + k), load(one, FZ * LANES + k)
        for j in range(LANES):
            f, dx, dy, dz = pull(one, k, other, j, soft)
            fx, fy, fz = fma(f, dx, fx), fma(f, dy, fy), fma(f, dz, fz)
            at = 3 * WIDTH * j
            store(sums, at, fma(f, dx, load(sums, at)))
            store(sums, at + WIDTH, fma(f, dy, load(sums, at + WIDTH)))
            store(sums, at + 2 * WIDTH, fma(f, dz, load(sums, at + 2 * WIDTH)))
        store(one, FX * LANES + k, fx)
        store(one, FY * LANES + k, fy)
        store(one, FZ * LANES + k, fz)
    for j in range(LANES):
        for c in range(3):
            other[(FX + c) * LANES + j] -= folded(load(sums, (3 * j + c) * WIDTH))


@lean(types.void(A, I, A, S, N), inner=True)
def take(floats, ints, unit, tile, first):
    """The LANES bodies from ``first`` on, without forces; ``unit``: middle (3), 1 / extent, 1 / largest weight."""
    for c in range(3):
        at = ints[layout.POINTS] + c * ints[layout.ROOM] + first
        places = floats[at : at + LANES]
        middle, scale = unit[c], unit[3]
        for k in range(LANES):
            place = (places[k] - middle) * scale
            rounded = np.float32(place)
            tile[c * LANES + k] = rounded
            tile[(XL + c) * LANES + k] = np.float32(place - np.float64(rounded))
            tile[(FX + c) * LANES + k] = np.float32(0.0)
    weights, scale = floats[ints[layout.WEIGHTS] + first : ints[layout.WEIGHTS] + first + LANES], unit[4]
    for k in range(LANES):
        tile[W * LANES + k] = np.float32(weights[k] * scale)


@lean(types.void(S, A, N, N), inner=True)
def leave(tile, floats, at, room):
    """Add the forces of a tile to the sums at floats[at:], and reset them to 0."""
    for c in range(3):
        for k in range(LANES):
            floats[at + c * room + k] += np.float64(tile[(FX + c) * LANES + k])
            tile[(FX + c) * LANES + k] = np.float32(0.0)


@lean(types.void(A, I, A), inner=True)
def units(floats, ints, unit):
    """Middle (3) of all bodies, 1 / their extent, 1 / the largest weight."""
    room, at = ints[layout.ROOM], ints[layout.POINTS]
    side = 0.0
    for c in range(3):
        low, high = floats[at + c * room], floats[at + c * room]
        for k in range(room):
            low, high = min(low, floats[at + c * room + k]), max(high, floats[at + c * room + k])
        unit[c] = 0.5 * (low + high)
        side = max(side, high - low)
    most = 0.0
    for k in range(room):
        most = max(most, abs(floats[ints[layout.WEIGHTS] + k]))
    unit[3] = 1.0 / side if side > 0.0 else 1.0
    unit[4] = 1.0 / most if most > 0.0 else 1.0


@kernel(TILE, inner=True)
def fast_tile(part, t, y, rate, floats, ints):
    """As direct_tile: the sums of one part, of its rows of tiles."""
    room, parts = ints[layout.ROOM], ints[PARTS]
    sums = ints[FORCES] + 3 * room * part
    for k in range(3 * room):
        floats[sums + k] = 0.0
    unit = np.empty(5)
    units(floats, ints, unit)
    soft = np.float32((floats[ints[layout.SOFTENING]] * unit[3]) ** 2 + FLOOR)
    one = aligned(np.empty((ROWS + 1) * LANES, dtype=np.float32))
    other = aligned(np.empty((ROWS + 1) * LANES, dtype=np.float32))
    scratch = aligned(np.empty((3 * LANES + 1) * WIDTH, dtype=np.float32))
    tiles = room // LANES
    for turn in range(0, tiles, parts):
        row = turn + (part if turn // parts % 2 == 0 else parts - 1 - part)
        if row >= tiles:
            continue
        take(floats, ints, unit, one, LANES * row)
        take(floats, ints, unit, other, LANES * row)
        attract(one, other, soft, scratch)
        leave(one, floats, sums + LANES * row, room)
        for column in range(row + 1, tiles):
            take(floats, ints, unit, other, LANES * column)
            attract(one, other, soft, scratch)
            leave(other, floats, sums + LANES * column, room)
            leave(one, floats, sums + LANES * row, room)
    scale = (unit[3] / unit[4]) ** 2
    for k in range(3 * room):
        floats[sums + k] *= scale
