# mypy: ignore-errors
"""Forces of 1/r^2 between all pairs: F_i = c w_i sum_j w_j d_ij / (r^2 + softening^2)^(3/2), d_ij from i to j.

Few bodies are summed pair by pair, many by pairs of tiles, one of them in vector lanes: each pair is computed once, for
both of its bodies, so that momentum is conserved to rounding. The rows of tiles are divided among parts with sums of
their own, which are added in a fixed order: results do not depend on the number of threads.
"""

import math

import numpy as np
from numba import types

from sceneql.compiled.arithmetic_kernels import widest
from sceneql.compiled.kernels import inlined, kernel, lean, lean_inlined
from sceneql.compiled.lanes_kernels import aligned, fma, folded, guess, load, spread, store
from sceneql.compiled.threads_kernels import TILE, over_threads
from sceneql.nbody import layout
from sceneql.nbody.shared_masses_kernels import gather, velocity_of
from sceneql.nbody.weights_kernels import FLOOR, weights
from sceneql.system.signatures_kernels import TERM, A, F, I, N

FORCES, PARTS, ENTRY, THREADS, TILE_AT, BODIES = range(layout.OWN, layout.OWN + 6)
"""Places in ints: room for 3 ROOM sums of each part, and the number of parts; threads; the bodies."""
FEW = 32
LANES = 128
"""Bodies of a tile; ROOM is a multiple of it."""
MOST_PARTS = 16
WIDTH = 8
"""Bodies of a tile that pull another tile in one vector loop."""
ALONE = 1024
"""Largest number of bodies for which one thread is faster."""
X, Y, Z, W, FX, FY, FZ, ROWS = range(8)
"""Rows of a tile: places, weights, forces."""


@inlined
def spread_out(floats, ints):
    """Move y and z of the gathered places to their rows of padded length; padding has weight 0."""
    n, room, at = ints[BODIES], ints[layout.ROOM], ints[layout.POINTS]
    for c in range(2, -1, -1):
        for k in range(n - 1, -1, -1):
            floats[at + c * room + k] = floats[at + c * n + k]
    for k in range(n, room):
        for c in range(3):
            floats[at + c * room + k] = floats[at + c * room]
        floats[ints[layout.WEIGHTS] + k] = 0.0


@inlined
def few(y, rate, floats, ints, c):
    """Add the forces between all bodies, pair by pair."""
    n, at, weight = ints[BODIES], ints[layout.POINTS], ints[layout.WEIGHTS]
    soft = floats[ints[layout.SOFTENING]] * floats[ints[layout.SOFTENING]]
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
def inverse_cube(s, w):
    """w s^(-3/2) for s > 0, to some 1e-16: a first guess, refined twice by polynomials.

    Division and square root take three times as long as all of this; fixed operations keep the bits.
    """
    r = guess(s)
    r = r * fma(fma(0.39409475, s * (r * r), -1.28885265), s * (r * r), 1.89474086)
    c = r * r
    e = fma(s * -1.0, c, 1.0)
    return (r * c * w) * fma(fma(fma(2.1875, e, 1.875), e, 1.5), e, 1.0)


@lean_inlined
def pull(one, k, other, j, soft):
    """Pull of body j of a tile on a vector of bodies from k on of another: size by distance, separation (3)."""
    dx = other[X * LANES + j] - load(one, X * LANES + k)
    dy = other[Y * LANES + j] - load(one, Y * LANES + k)
    dz = other[Z * LANES + j] - load(one, Z * LANES + k)
    w = other[W * LANES + j] * load(one, W * LANES + k)
    return inverse_cube(fma(dx, dx, fma(dy, dy, fma(dz, dz, soft))), w), dx, dy, dz


@lean(types.void(A, A, F, A), inner=True)
def attract(one, other, soft, sums):
    """Add the forces between the bodies of two tiles; sums (3 LANES WIDTH,): scratch, for the pull on the other's."""
    widest()
    for at in range(0, 3 * LANES * WIDTH, WIDTH):
        store(sums, at, spread(0.0))
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


@lean(types.void(A, I, A, N), inner=True)
def take(floats, ints, tile, first):
    """Places and weights of the LANES bodies from ``first`` on, and no forces."""
    for c in range(3):
        at = ints[layout.POINTS] + c * ints[layout.ROOM] + first
        places = floats[at : at + LANES]
        for k in range(LANES):
            tile[c * LANES + k] = places[k]
            tile[(FX + c) * LANES + k] = 0.0
    own = floats[ints[layout.WEIGHTS] + first : ints[layout.WEIGHTS] + first + LANES]
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
    """The sums of one part: of its rows of tiles, dealt back and forth for equal work."""
    room, parts = ints[layout.ROOM], ints[PARTS]
    sums = ints[FORCES] + 3 * room * part
    for k in range(3 * room):
        floats[sums + k] = 0.0
    soft = floats[ints[layout.SOFTENING]] * floats[ints[layout.SOFTENING]] + FLOOR
    one, other = aligned(np.empty((ROWS + 1) * LANES)), aligned(np.empty((ROWS + 1) * LANES))
    scratch = aligned(np.empty((3 * LANES + 1) * WIDTH))
    tiles = room // LANES
    for turn in range(0, tiles, parts):
        row = turn + (part if turn // parts % 2 == 0 else parts - 1 - part)
        if row >= tiles:
            continue
        take(floats, ints, one, LANES * row)
        # A tile with itself: every pair is found twice, so only one of the two is kept.
        take(floats, ints, other, LANES * row)
        attract(one, other, soft, scratch)
        for column in range(row + 1, tiles):
            take(floats, ints, other, LANES * column)
            attract(one, other, soft, scratch)
            leave(other, floats, sums + LANES * column, room)
        leave(one, floats, sums + LANES * row, room)


@kernel(TERM)
def direct(t, y, rate, floats, ints):
    """Adds the forces between all pairs. ints: see above."""
    n = ints[BODIES]
    gather(y, floats, ints, BODIES, ints[layout.POINTS])
    weights(floats, ints, BODIES, ints[layout.WEIGHTS])
    if n <= FEW:
        few(y, rate, floats, ints, ints[layout.SIGN] * floats[ints[layout.CONSTANT]])
        return
    spread_out(floats, ints)
    count = 1 if n <= ALONE else ints[THREADS]
    over_threads(ints[ENTRY], count, ints[TILE_AT], ints[PARTS], t, y, rate, floats, ints)
    room, constant = ints[layout.ROOM], ints[layout.SIGN] * floats[ints[layout.CONSTANT]]
    for k in range(n):
        at = velocity_of(k, ints, BODIES)
        for c in range(3):
            total = 0.0
            for part in range(ints[PARTS]):
                total += floats[ints[FORCES] + (3 * part + c) * room + k]
            rate[at + c] += constant * total


def parts_of(room: int) -> int:
    """Number of parts among which the tiles of ``room`` bodies are divided."""
    return max(1, min(MOST_PARTS, room // LANES // 4))


@kernel((A, A, I, A))
def potentials(y, floats, ints, out):
    """Write sum_j w_j / sqrt(r^2 + softening^2) of every body, itself left out, to out (n,); ints as for the term."""
    n, at = ints[BODIES], ints[layout.POINTS]
    gather(y, floats, ints, BODIES, at)
    weights(floats, ints, BODIES, ints[layout.WEIGHTS])
    w = floats[ints[layout.WEIGHTS] : ints[layout.WEIGHTS] + n]
    soft = floats[ints[layout.SOFTENING]] * floats[ints[layout.SOFTENING]]
    for i in range(n):
        total = 0.0
        for j in range(n):
            dx = floats[at + j] - floats[at + i]
            dy = floats[at + n + j] - floats[at + n + i]
            dz = floats[at + 2 * n + j] - floats[at + 2 * n + i]
            square = dx * dx + dy * dy + dz * dz + soft
            total += w[j] / math.sqrt(square) if j != i and square > 0.0 else 0.0
        out[i] = total
