# mypy: ignore-errors
"""Forces of 1/r^2 between all pairs: F_i = c w_i sum_j w_j d_ij / (r^2 + softening^2)^(3/2), d_ij from i to j.

Few bodies go pair by pair, with the third law of Newton to the last bit. Many go by tiles of targets that lie in the
lanes of vectors; the sum over the sources has one order, whatever the number of threads.
"""

import math

import numpy as np

from sceneql.kernels import inlined, kernel
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
from sceneql.system_kernels import TERM, A, I

ENTRY, THREADS, TILE_AT, BODIES = range(6, 10)
"""Places in ints after those of weights_kernels: threads; the bodies."""
FEW = 32
LANES = 128
"""Targets of a tile; ROOM is a multiple of it."""
ALONE = 1024
"""Up to so many bodies one thread is quicker."""


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


@kernel(TILE)
def direct_tile(tile, t, y, rate, floats, ints):
    """The forces of all bodies on LANES of them."""
    widest()
    n, room = ints[BODIES], ints[ROOM]
    x = floats[ints[POINTS] : ints[POINTS] + room]
    y_ = floats[ints[POINTS] + room : ints[POINTS] + 2 * room]
    z = floats[ints[POINTS] + 2 * room : ints[POINTS] + 3 * room]
    w = floats[ints[WEIGHTS] : ints[WEIGHTS] + room]
    soft = floats[ints[SOFTENING]] * floats[ints[SOFTENING]] + FLOOR
    first = tile * LANES
    lanes = np.zeros(6 * LANES)
    for k in range(LANES):
        lanes[3 * LANES + k] = x[first + k]
        lanes[4 * LANES + k] = y_[first + k]
        lanes[5 * LANES + k] = z[first + k]
    for j in range(0, room, 4):
        # Four sources at a time, so that the sums stay in registers for four.
        xa, ya, za, wa = x[j], y_[j], z[j], w[j]
        xb, yb, zb, wb = x[j + 1], y_[j + 1], z[j + 1], w[j + 1]
        xc, yc, zc, wc = x[j + 2], y_[j + 2], z[j + 2], w[j + 2]
        xd, yd, zd, wd = x[j + 3], y_[j + 3], z[j + 3], w[j + 3]
        for k in range(LANES):
            px, py, pz = lanes[3 * LANES + k], lanes[4 * LANES + k], lanes[5 * LANES + k]
            fx, fy, fz = lanes[k], lanes[LANES + k], lanes[2 * LANES + k]
            dx, dy, dz = xa - px, ya - py, za - pz
            f = inverse_cube(fma(dx, dx, fma(dy, dy, fma(dz, dz, soft))), wa)
            fx, fy, fz = fma(f, dx, fx), fma(f, dy, fy), fma(f, dz, fz)
            dx, dy, dz = xb - px, yb - py, zb - pz
            f = inverse_cube(fma(dx, dx, fma(dy, dy, fma(dz, dz, soft))), wb)
            fx, fy, fz = fma(f, dx, fx), fma(f, dy, fy), fma(f, dz, fz)
            dx, dy, dz = xc - px, yc - py, zc - pz
            f = inverse_cube(fma(dx, dx, fma(dy, dy, fma(dz, dz, soft))), wc)
            fx, fy, fz = fma(f, dx, fx), fma(f, dy, fy), fma(f, dz, fz)
            dx, dy, dz = xd - px, yd - py, zd - pz
            f = inverse_cube(fma(dx, dx, fma(dy, dy, fma(dz, dz, soft))), wd)
            fx, fy, fz = fma(f, dx, fx), fma(f, dy, fy), fma(f, dz, fz)
            lanes[k], lanes[LANES + k], lanes[2 * LANES + k] = fx, fy, fz
    c = ints[SIGN] * floats[ints[CONSTANT]]
    for k in range(min(LANES, n - first)):
        at = velocity_of(first + k, ints, BODIES)
        own = c * w[first + k]
        rate[at] += own * lanes[k]
        rate[at + 1] += own * lanes[LANES + k]
        rate[at + 2] += own * lanes[2 * LANES + k]


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
    over_threads(ints[ENTRY], count, ints[TILE_AT], ints[ROOM] // LANES, t, y, rate, floats, ints)


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
