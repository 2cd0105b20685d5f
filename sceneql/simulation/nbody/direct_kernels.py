# mypy: ignore-errors
"""Forces of 1/r^2 between all pairs: F_i = c w_i sum_j w_j d_ij / (r^2 + softening^2)^(3/2), d_ij from i to j.

Few bodies go pair by pair. Many go by pairs of tiles, one of which lies in the lanes of vectors: each pair is computed
once, for both of its bodies, so that momentum is kept to rounding. The rows of tiles are dealt to parts with sums of
their own, which are added in one order: the bytes do not depend on the number of threads.
"""

import math

import numpy as np
from numba import types

from sceneql.kernels import inlined, kernel, lean, lean_inlined
from sceneql.simulation.arithmetic_kernels import fma, inverse_cube, widest
from sceneql.simulation.nbody.weights_kernels import (
    CONSTANT,
    FLOOR,
    POINTS,
    ROOM,
    SIGN,
    SOFTENING,
    WEIGHTS,
    weights,
)
from sceneql.simulation.threads_kernels import TILE, over_threads
from sceneql.simulation.together_kernels import gather, velocity_of
from sceneql.system_kernels import TERM, A, F, I, N

FORCES, PARTS, ENTRY, THREADS, TILE_AT, BODIES = range(6, 12)
"""Places in ints after those of weights_kernels: room for 3 ROOM sums of each part, and the number of parts; threads;
the bodies."""
FEW = 32
LANES = 128
"""Bodies of a tile; ROOM is a multiple of it."""
MOST_PARTS = 16
ALONE = 1024
"""Up to so many bodies one thread is quicker."""
X, Y, Z, W, FX, FY, FZ, ROWS = range(8)
"""Rows of a tile: places, weights, forces."""
SOURCES, STRIP = 4, 16
"""Bodies of the other tile that are worked on together, so that the sums stay in registers for four; lanes of a tile
whose pull on such a body is summed apart."""


@inlined
def spread_out(floats, ints):
    """Move y and z of the gathered places to where the padded lanes have them; the padding weighs nothing."""
    n, room, at = ints[BODIES], ints[ROOM], ints[POINTS]
    for c in range(2, -1, -1):
        for k in range(n - 1, -1, -1):
            floats[at + c * room + k] = floats[at + c * n + k]
    for k in range(n, room):
        for c in range(3):
            floats[at + c * room + k] = floats[at + c * room]
        floats[ints[WEIGHTS] + k] = 0.0


@inlined
def few(y, rate, floats, ints, c):
    """Pair by pair."""
    n, at, weight = ints[BODIES], ints[POINTS], ints[WEIGHTS]
    soft = floats[ints[SOFTENING]] * floats[ints[SOFTENING]]
    for i in range(n):
        vi = velocity_of(i, ints, BODIES)
        for j in range(i + 1, n):
            dx = floats[at + j] - floats[at + i]
            dy = floats[at + n + j] - floats[at + n + i]
            dz = floats[at + 2 * n + j] - floats[at + 2 * n + i]
            square = dx * dx + dy * dy + dz * dz
            if square == 0.0:
                continue
            square += soft
            f = c * floats[weight + i] * floats[weight + j] / (square * math.sqrt(square))
            vj = velocity_of(j, ints, BODIES)
            rate[vi] += f * dx
            rate[vi + 1] += f * dy
            rate[vi + 2] += f * dz
            rate[vj] -= f * dx
            rate[vj + 1] -= f * dy
            rate[vj + 2] -= f * dz


@lean_inlined
def pull(source, j, soft, px, py, pz, w):
    """The force of body j of a tile on a body at (px, py, pz) of weight w: its size by distance, and the way (3)."""
    dx, dy, dz = source[X * LANES + j] - px, source[Y * LANES + j] - py, source[Z * LANES + j] - pz
    return inverse_cube(fma(dx, dx, fma(dy, dy, fma(dz, dz, soft))), w * source[W * LANES + j]), dx, dy, dz


@lean(types.void(A, A, N, F, A), inner=True)
def strips(one, other, j, soft, sums):
    """The forces between all lanes of one tile and the bodies j..j + 3 of the other, whose sums are kept by lane."""
    widest()
    for first in range(0, LANES, STRIP):
        for l in range(STRIP):
            k = first + l
            px, py, pz, w = one[X * LANES + k], one[Y * LANES + k], one[Z * LANES + k], one[W * LANES + k]
            fx, fy, fz = one[FX * LANES + k], one[FY * LANES + k], one[FZ * LANES + k]
            f, dx, dy, dz = pull(other, j, soft, px, py, pz, w)
            fx, fy, fz = fma(f, dx, fx), fma(f, dy, fy), fma(f, dz, fz)
            ax, ay, az = fma(f, dx, sums[l]), fma(f, dy, sums[STRIP + l]), fma(f, dz, sums[2 * STRIP + l])
            f, dx, dy, dz = pull(other, j + 1, soft, px, py, pz, w)
            fx, fy, fz = fma(f, dx, fx), fma(f, dy, fy), fma(f, dz, fz)
            bx, by, bz = (
                fma(f, dx, sums[3 * STRIP + l]),
                fma(f, dy, sums[4 * STRIP + l]),
                fma(f, dz, sums[5 * STRIP + l]),
            )
            f, dx, dy, dz = pull(other, j + 2, soft, px, py, pz, w)
            fx, fy, fz = fma(f, dx, fx), fma(f, dy, fy), fma(f, dz, fz)
            cx, cy, cz = (
                fma(f, dx, sums[6 * STRIP + l]),
                fma(f, dy, sums[7 * STRIP + l]),
                fma(f, dz, sums[8 * STRIP + l]),
            )
            f, dx, dy, dz = pull(other, j + 3, soft, px, py, pz, w)
            one[FX * LANES + k], one[FY * LANES + k], one[FZ * LANES + k] = (
                fma(f, dx, fx),
                fma(f, dy, fy),
                fma(f, dz, fz),
            )
            sums[9 * STRIP + l] = fma(f, dx, sums[9 * STRIP + l])
            sums[10 * STRIP + l] = fma(f, dy, sums[10 * STRIP + l])
            sums[11 * STRIP + l] = fma(f, dz, sums[11 * STRIP + l])
            sums[l], sums[STRIP + l], sums[2 * STRIP + l] = ax, ay, az
            sums[3 * STRIP + l], sums[4 * STRIP + l], sums[5 * STRIP + l] = bx, by, bz
            sums[6 * STRIP + l], sums[7 * STRIP + l], sums[8 * STRIP + l] = cx, cy, cz


@lean_inlined
def folded(sums):
    """The sum of STRIP numbers, half by half, as vectors do it."""
    for l in range(8):
        sums[l] += sums[8 + l]
    for l in range(4):
        sums[l] += sums[4 + l]
    return (sums[0] + sums[2]) + (sums[1] + sums[3])


@lean(types.void(A, A, A, F), inner=True)
def attract(one, other, sums, soft):
    """Add the forces between the bodies of two tiles; sums (3 SOURCES STRIP,): scratch."""
    for j in range(0, LANES, SOURCES):
        for k in range(3 * SOURCES * STRIP):
            sums[k] = 0.0
        strips(one, other, j, soft, sums)
        for source in range(SOURCES):
            for c in range(3):
                other[(FX + c) * LANES + j + source] -= folded(sums[(3 * source + c) * STRIP :])


@lean(types.void(A, I, A, N), inner=True)
def take(floats, ints, tile, first):
    """Places and weights of the LANES bodies from ``first`` on, and no forces."""
    for c in range(3):
        places = floats[ints[POINTS] + c * ints[ROOM] + first : ints[POINTS] + c * ints[ROOM] + first + LANES]
        for k in range(LANES):
            tile[c * LANES + k] = places[k]
            tile[(FX + c) * LANES + k] = 0.0
    own = floats[ints[WEIGHTS] + first : ints[WEIGHTS] + first + LANES]
    for k in range(LANES):
        tile[W * LANES + k] = own[k]


@lean(types.void(A, A, N, N), inner=True)
def leave(tile, floats, at, room):
    """Add the forces of a tile to the sums at floats[at:]."""
    for c in range(3):
        for k in range(LANES):
            floats[at + c * room + k] += tile[(FX + c) * LANES + k]


@kernel(TILE, inner=True)
def direct_tile(part, t, y, rate, floats, ints):
    """The sums of one part: of its rows of tiles, dealt to and fro so that all have as much to do."""
    room, parts = ints[ROOM], ints[PARTS]
    sums = ints[FORCES] + 3 * room * part
    for k in range(3 * room):
        floats[sums + k] = 0.0
    soft = floats[ints[SOFTENING]] * floats[ints[SOFTENING]] + FLOOR
    one, other, scratch = np.empty(ROWS * LANES), np.empty(ROWS * LANES), np.empty(3 * SOURCES * STRIP)
    tiles = room // LANES
    for turn in range(0, tiles, parts):
        row = turn + (part if turn // parts % 2 == 0 else parts - 1 - part)
        if row >= tiles:
            continue
        take(floats, ints, one, LANES * row)
        # A tile with itself: every pair is found twice, so only one of the two is kept.
        take(floats, ints, other, LANES * row)
        attract(one, other, scratch, soft)
        for column in range(row + 1, tiles):
            take(floats, ints, other, LANES * column)
            attract(one, other, scratch, soft)
            leave(other, floats, sums + LANES * column, room)
        leave(one, floats, sums + LANES * row, room)


@kernel(TERM)
def direct(t, y, rate, floats, ints):
    """Adds the forces between all pairs. ints: see above."""
    n = ints[BODIES]
    gather(y, floats, ints, BODIES, ints[POINTS])
    weights(floats, ints, BODIES, ints[WEIGHTS])
    if n <= FEW:
        few(y, rate, floats, ints, ints[SIGN] * floats[ints[CONSTANT]])
        return
    spread_out(floats, ints)
    count = 1 if n <= ALONE else ints[THREADS]
    over_threads(ints[ENTRY], count, ints[TILE_AT], ints[PARTS], t, y, rate, floats, ints)
    room, constant = ints[ROOM], ints[SIGN] * floats[ints[CONSTANT]]
    for k in range(n):
        at = velocity_of(k, ints, BODIES)
        for c in range(3):
            total = 0.0
            for part in range(ints[PARTS]):
                total += floats[ints[FORCES] + (3 * part + c) * room + k]
            rate[at + c] += constant * total


def parts_of(room: int) -> int:
    """How many parts the tiles of so many bodies are dealt to."""
    return max(1, min(MOST_PARTS, room // LANES // 4))


@kernel((A, A, I, A))
def potentials(y, floats, ints, out):
    """Write sum_j w_j / sqrt(r^2 + softening^2) of every body, itself left out, to out (n,); ints as for the term."""
    n, at = ints[BODIES], ints[POINTS]
    gather(y, floats, ints, BODIES, at)
    weights(floats, ints, BODIES, ints[WEIGHTS])
    w = floats[ints[WEIGHTS] : ints[WEIGHTS] + n]
    soft = floats[ints[SOFTENING]] * floats[ints[SOFTENING]]
    for i in range(n):
        total = 0.0
        for j in range(n):
            dx = floats[at + j] - floats[at + i]
            dy = floats[at + n + j] - floats[at + n + i]
            dz = floats[at + 2 * n + j] - floats[at + 2 * n + i]
            square = dx * dx + dy * dy + dz * dz + soft
            total += w[j] / math.sqrt(square) if j != i and square > 0.0 else 0.0
        out[i] = total
