# mypy: ignore-errors
"""Curl noise, and the drag of air that moves by it.

The velocity is the curl of a vector potential of gradient noise, so its divergence is exactly zero (Bridson, Hourihan &
Nordenstam 2007, Curl-noise for procedural fluid flow; Perlin 2002 for the noise): in a cell of the lattice
psi = sum over corners of w(f) G d, with quintic weights w, d from the corner and a random matrix G of each corner.
"""

import math

import numpy as np

from sceneql.kernels import inlined, kernel
from sceneql.simulation.arithmetic_kernels import fma, widest
from sceneql.simulation.threads_kernels import TILE, over_threads
from sceneql.system_kernels import TERM

LANES = 256
"""Particles that are worked on together, in single precision; the cell and the place in it are found in double."""
FASTER = 2.0 ** (2.0 / 3.0)
"""How much sooner they change."""
ROUGHNESS = 2.0 ** (-1.0 / 3.0)
"""Speed of eddies of half the size (Kolmogorov 1941)."""
SPREAD = 1.2185
"""Root mean square of the curl of one octave, measured."""
FX, FY, FZ, SX, SY, SZ, TX, TY, TZ, UX, UY, UZ, ROWS = range(13)


@inlined
def mixed(h):
    """32 bits stirred (Wellons 2018, hash prospector, "lowbias32")."""
    h = np.uint32(h ^ (h >> np.uint32(16)))
    h = np.uint32(h * np.uint32(0x7FEB352D))
    h = np.uint32(h ^ (h >> np.uint32(15)))
    h = np.uint32(h * np.uint32(0x846CA68B))
    return np.uint32(h ^ (h >> np.uint32(16)))


@inlined
def number(h, shift):
    """The bits of a word from ``shift`` down, as a number in [-2^31, 2^31)."""
    return np.float32(np.int32(np.uint32(h << np.uint32(shift))))


@inlined
def next_word(h):
    """Another word of bits."""
    h = np.uint32(h * np.uint32(0x9E3779B1))
    return np.uint32(h ^ (h >> np.uint32(15)))


@inlined
def corner(cx, cy, cz, seed, cosine, sine, work, cells):
    """Add one corner's part of the curl to rows UX, UY, UZ, for all lanes."""
    widest()
    ox, oy, oz = np.float32(cx), np.float32(cy), np.float32(cz)
    ax, ay, az = np.float32(1 - cx), np.float32(1 - cy), np.float32(1 - cz)
    bx, by, bz = np.float32(2 * cx - 1), np.float32(2 * cy - 1), np.float32(2 * cz - 1)
    px = np.uint32(cx) * np.uint32(0x8DA6B343)
    py = np.uint32(cy) * np.uint32(0xD8163841)
    pz = np.uint32(cz) * np.uint32(0xCB1AB31F)
    for k in range(LANES):
        h = np.uint32(
            np.uint32(cells[k] + px) ^ np.uint32(cells[LANES + k] + py) ^ np.uint32(cells[2 * LANES + k] + pz)
        )
        p = mixed(np.uint32(h ^ seed))
        q = next_word(p)
        r = next_word(q)
        u = next_word(r)
        v = next_word(u)
        w = next_word(v)
        xx = fma(sine, number(u, 0), cosine * number(p, 0))
        xy = fma(sine, number(u, 11), cosine * number(p, 11))
        xz = fma(sine, number(u, 22), cosine * number(p, 22))
        yx = fma(sine, number(v, 0), cosine * number(q, 0))
        yy = fma(sine, number(v, 11), cosine * number(q, 11))
        yz = fma(sine, number(v, 22), cosine * number(q, 22))
        zx = fma(sine, number(w, 0), cosine * number(r, 0))
        zy = fma(sine, number(w, 11), cosine * number(r, 11))
        zz = fma(sine, number(w, 22), cosine * number(r, 22))
        dx, dy, dz = work[FX * LANES + k] - ox, work[FY * LANES + k] - oy, work[FZ * LANES + k] - oz
        a = fma(xx, dx, fma(xy, dy, xz * dz))
        b = fma(yx, dx, fma(yy, dy, yz * dz))
        c = fma(zx, dx, fma(zy, dy, zz * dz))
        wx = fma(bx, work[SX * LANES + k], ax)
        wy = fma(by, work[SY * LANES + k], ay)
        wz = fma(bz, work[SZ * LANES + k], az)
        weight = wx * wy * wz
        gx = bx * work[TX * LANES + k] * (wy * wz)
        gy = by * work[TY * LANES + k] * (wx * wz)
        gz = bz * work[TZ * LANES + k] * (wx * wy)
        work[UX * LANES + k] += fma(gy, c, fma(-gz, b, weight * (zy - yz)))
        work[UY * LANES + k] += fma(gz, a, fma(-gx, c, weight * (xz - zx)))
        work[UZ * LANES + k] += fma(gx, b, fma(-gy, a, weight * (yx - xy)))


@inlined
def locate(place, axis, prime, work, cells, k):
    """Lattice cell of a coordinate, place in it, quintic weight and its slope."""
    below = math.floor(place)
    f = place - below
    work[(FX + axis) * LANES + k] = np.float32(f)
    work[(SX + axis) * LANES + k] = np.float32(f * f * f * (f * (6.0 * f - 15.0) + 10.0))
    work[(TX + axis) * LANES + k] = np.float32(30.0 * f * f * (f - 1.0) * (f - 1.0))
    cells[axis * LANES + k] = np.uint32(np.int64(below) * prime)


@inlined
def curl(places, seed, angle, octaves, work, cells, total):
    """Write the curl (3, LANES) of up to LANES points (3, LANES), in units of the lattice; rms speed near 1."""
    for c in range(3):
        for k in range(LANES):
            total[c, k] = 0.0
    scale, part, square = 1.0, 1.0, 0.0
    for octave in range(octaves):
        shift = 17.31 * octave
        cosine, sine = np.float32(math.cos(angle)), np.float32(math.sin(angle))
        for k in range(LANES):
            locate(scale * places[0, k] + shift, 0, 0x8DA6B343, work, cells, k)
            locate(scale * places[1, k] + shift, 1, 0xD8163841, work, cells, k)
            locate(scale * places[2, k] + shift, 2, 0xCB1AB31F, work, cells, k)
        for k in range(UX * LANES, ROWS * LANES):
            work[k] = np.float32(0.0)
        stirred = mixed(np.uint32(seed + 0x632BE5AB * octave))
        for at in range(8):
            corner(at & 1, (at >> 1) & 1, at >> 2, stirred, cosine, sine, work, cells)
        for c in range(3):
            for k in range(LANES):
                total[c, k] += part * work[(UX + c) * LANES + k]
        square += part * part
        scale *= 2.0
        angle *= FASTER
        part *= ROUGHNESS
    return 2.0**-31 / (SPREAD * math.sqrt(square))


@kernel(TILE)
def turbulence_tile(tile, t, y, rate, floats, ints):
    """The masses LANES tile, LANES tile + 1, ...; their power goes to floats[power_at + tile]."""
    position_at, velocity_at, count, inverse_at = ints[0], ints[1], ints[2], ints[4]
    speed, linear = floats[ints[5]], floats[ints[6]]
    air_at, numbers_at, power_at = ints[7], ints[8], ints[9]
    size, omega = floats[numbers_at], floats[numbers_at + 1]
    first = tile * LANES
    count = min(LANES, count - first)
    places = np.zeros((3, LANES))
    total = np.empty((3, LANES))
    work = np.empty(ROWS * LANES, dtype=np.float32)
    cells = np.empty(3 * LANES, dtype=np.uint32)
    for k in range(count):
        at = position_at + 3 * (first + k)
        for c in range(3):
            places[c, k] = (y[at + c] - t * floats[air_at + c]) / size
    factor = speed * curl(places, ints[11], omega * t, ints[10], work, cells, total)
    power = 0.0
    for k in range(count):
        if floats[inverse_at + first + k] == 0.0:
            continue
        at = velocity_at + 3 * (first + k)
        for c in range(3):
            force = -linear * (y[at + c] - floats[air_at + c] - factor * total[c, k])
            rate[at + c] += force
            power -= force * y[at + c]
    floats[power_at + tile] = power


@kernel(TERM)
def turbulence(t, y, rate, floats, ints):
    """Adds -c (v - u), and takes its power from the work.

    ints: position_at, velocity_at, count, work_at, inverse_at, speed_at, linear_at, air_at, numbers_at (size,
    angular frequency), power_at, octaves, seed, threads' entry and number, address of the tile function.
    """
    tiles = (ints[2] + LANES - 1) // LANES
    over_threads(ints[12], ints[13], ints[14], tiles, t, y, rate, floats, ints)
    for tile in range(tiles):
        rate[ints[3]] += floats[ints[9] + tile]
