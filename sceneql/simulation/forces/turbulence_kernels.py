# mypy: ignore-errors
"""Curl noise, and the drag of air that moves by it.

The velocity is the curl of a smooth vector potential, so its divergence is exactly zero (Bridson, Hourihan & Nordenstam
2007, Curl-noise for procedural fluid flow). In a cell of the lattice psi = sum over corners of w(f) (g x d + a h), with
quintic weights w (Perlin 2002), d from the corner, and random vectors g and h of each corner:

    u = curl psi = sum of g (2 w + grad w . d) - d (grad w . g) + grad w x a h

At a corner u = 2 g; a makes its square nearly as large everywhere. In time g and h turn into one another.
"""

import math

import numpy as np

from sceneql.kernels import inlined, kernel
from sceneql.simulation.arithmetic_kernels import fma, widest
from sceneql.simulation.threads_kernels import TILE, over_threads
from sceneql.system_kernels import TERM

LANES = 256
"""Particles that are worked on together, in single precision; the cell and the place in it are found in double."""
PART = 8 * LANES
"""Particles of a tile."""
FASTER = 2.0 ** (2.0 / 3.0)
"""How much sooner they change."""
ROUGHNESS = 2.0 ** (-1.0 / 3.0)
"""Speed of eddies of half the size (Kolmogorov 1941)."""
EVEN = np.float32(0.75)
"""a."""
SPREAD = 1.8538
"""Root mean square of the curl of one octave, measured."""
FX, FY, FZ, SX, SY, SZ, TX, TY, TZ, UX, UY, UZ, ROWS = range(13)
"""Rows of scratch: place in the cell, weight and slope of its upper corner, the velocity so far."""


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
    """Add one corner's part of the curl to rows UX, UY, UZ, for all lanes. The numbers turn by an angle in time."""
    widest()
    ox, oy, oz = np.float32(cx), np.float32(cy), np.float32(cz)
    ax, ay, az = np.float32(1 - cx), np.float32(1 - cy), np.float32(1 - cz)
    bx, by, bz = np.float32(2 * cx - 1), np.float32(2 * cy - 1), np.float32(2 * cz - 1)
    px = np.uint32(cx) * np.uint32(0x8DA6B343)
    py = np.uint32(cy) * np.uint32(0xD8163841)
    pz = np.uint32(cz) * np.uint32(0xCB1AB31F)
    two, along, against = np.float32(2.0), EVEN * cosine, -EVEN * sine
    for k in range(LANES):
        h = np.uint32(
            np.uint32(cells[k] + px) ^ np.uint32(cells[LANES + k] + py) ^ np.uint32(cells[2 * LANES + k] + pz)
        )
        p = mixed(np.uint32(h ^ seed))
        q = next_word(p)
        ex, ey, ez = number(p, 0), number(p, 11), number(p, 22)
        fx, fy, fz = number(q, 0), number(q, 11), number(q, 22)
        gx, gy, gz = fma(sine, fx, cosine * ex), fma(sine, fy, cosine * ey), fma(sine, fz, cosine * ez)
        hx, hy, hz = fma(against, ex, along * fx), fma(against, ey, along * fy), fma(against, ez, along * fz)
        dx, dy, dz = work[FX * LANES + k] - ox, work[FY * LANES + k] - oy, work[FZ * LANES + k] - oz
        wx = fma(bx, work[SX * LANES + k], ax)
        wy = fma(by, work[SY * LANES + k], ay)
        wz = fma(bz, work[SZ * LANES + k], az)
        yz, xz, xy = wy * wz, wx * wz, wx * wy
        sx = bx * work[TX * LANES + k] * yz
        sy = by * work[TY * LANES + k] * xz
        sz = bz * work[TZ * LANES + k] * xy
        forth = fma(two, wx * yz, fma(sx, dx, fma(sy, dy, sz * dz)))
        back = fma(sx, gx, fma(sy, gy, sz * gz))
        work[UX * LANES + k] += fma(gx, forth, fma(-dx, back, fma(sy, hz, -sz * hy)))
        work[UY * LANES + k] += fma(gy, forth, fma(-dy, back, fma(sz, hx, -sx * hz)))
        work[UZ * LANES + k] += fma(gz, forth, fma(-dz, back, fma(sx, hy, -sy * hx)))


@inlined
def locate(axis, scale, shift, places, work, cells):
    """For all lanes: lattice cell of a coordinate, place in it, quintic weight and its slope."""
    widest()
    prime = np.uint32(0x8DA6B343 if axis == 0 else (0xD8163841 if axis == 1 else 0xCB1AB31F))
    for k in range(LANES):
        place = fma(scale, places[axis * LANES + k], shift)
        below = math.floor(place)
        f = np.float32(place - below)
        square = f * f
        back = f - np.float32(1.0)
        work[(FX + axis) * LANES + k] = f
        work[(SX + axis) * LANES + k] = square * f * (f * (np.float32(6.0) * f - np.float32(15.0)) + np.float32(10.0))
        work[(TX + axis) * LANES + k] = np.float32(30.0) * square * (back * back)
        cells[axis * LANES + k] = np.uint32(np.uint32(np.int64(below)) * prime)


@inlined
def curl(places, seed, angle, octaves, work, cells, total):
    """Write the curl (3 LANES,) at LANES points (3 LANES,), in units of the lattice; the factor for a speed of 1."""
    for k in range(3 * LANES):
        total[k] = np.float32(0.0)
    scale, part, square = 1.0, 1.0, 0.0
    for octave in range(octaves):
        cosine, sine = np.float32(math.cos(angle)), np.float32(math.sin(angle))
        for axis in range(3):
            locate(axis, scale, 17.31 * octave, places, work, cells)
        for k in range(UX * LANES, ROWS * LANES):
            work[k] = np.float32(0.0)
        stirred = mixed(np.uint32(seed + 0x632BE5AB * octave))
        for at in range(8):
            corner(at & 1, (at >> 1) & 1, at >> 2, stirred, cosine, sine, work, cells)
        weight = np.float32(part)
        for k in range(3 * LANES):
            total[k] += weight * work[UX * LANES + k]
        square += part * part
        scale *= 2.0
        angle *= FASTER
        part *= ROUGHNESS
    return 2.0**-31 / (SPREAD * math.sqrt(square))


@inlined
def split(x, scale, ax, ay, az, places):
    """Places (3 LANES,) of up to LANES points, one coordinate after the other, from points (3 count,)."""
    for k in range(x.size // 3):
        places[k] = scale * x[3 * k] - ax
        places[LANES + k] = scale * x[3 * k + 1] - ay
        places[2 * LANES + k] = scale * x[3 * k + 2] - az


@inlined
def push(v, inverse, linear, factor, ax, ay, az, total, force, powers):
    """Add the drag of some masses to ``force`` and write the power of each that it takes."""
    for k in range(inverse.size):
        c = linear if inverse[k] > 0.0 else 0.0
        vx, vy, vz = v[3 * k], v[3 * k + 1], v[3 * k + 2]
        fx = c * (fma(factor, np.float64(total[k]), ax) - vx)
        fy = c * (fma(factor, np.float64(total[LANES + k]), ay) - vy)
        fz = c * (fma(factor, np.float64(total[2 * LANES + k]), az) - vz)
        force[3 * k] += fx
        force[3 * k + 1] += fy
        force[3 * k + 2] += fz
        powers[k] = -fma(fx, vx, fma(fy, vy, fz * vz))


@inlined
def summed(powers):
    """Their sum, in an order of its own that vectors can follow."""
    size = LANES
    while size > 1:
        size //= 2
        for k in range(size):
            powers[k] += powers[size + k]
    return powers[0]


@kernel(TILE)
def turbulence_tile(tile, t, y, rate, floats, ints):
    """The masses from PART tile on; their power goes to floats[power_at + tile]."""
    position_at, velocity_at, inverse_at = ints[0], ints[1], ints[4]
    speed, linear = floats[ints[5]], floats[ints[6]]
    air_at, numbers_at = ints[7], ints[8]
    scale, omega = 1.0 / floats[numbers_at], floats[numbers_at + 1]
    ax, ay, az = floats[air_at], floats[air_at + 1], floats[air_at + 2]
    drift = scale * t
    places = np.zeros(3 * LANES)
    powers = np.zeros(LANES)
    total = np.empty(3 * LANES, dtype=np.float32)
    work = np.empty(ROWS * LANES, dtype=np.float32)
    cells = np.empty(3 * LANES, dtype=np.uint32)
    power = 0.0
    last = min(ints[2], PART * (tile + 1))
    for first in range(PART * tile, last, LANES):
        end = min(last, first + LANES)
        split(y[position_at + 3 * first : position_at + 3 * end], scale, drift * ax, drift * ay, drift * az, places)
        factor = speed * curl(places, ints[11], omega * t, ints[10], work, cells, total)
        for k in range(end - first, LANES):
            powers[k] = 0.0
        push(
            y[velocity_at + 3 * first : velocity_at + 3 * end], floats[inverse_at + first : inverse_at + end],
            linear, factor, ax, ay, az, total, rate[velocity_at + 3 * first : velocity_at + 3 * end], powers,
        )  # fmt: skip
        power += summed(powers)
    floats[ints[9] + tile] = power


@kernel(TERM)
def turbulence(t, y, rate, floats, ints):
    """Adds -c (v - u), and takes its power from the work.

    ints: position_at, velocity_at, count, work_at, inverse_at, speed_at, linear_at, air_at, numbers_at (size,
    angular frequency), power_at, octaves, seed, threads' entry and number, address of the tile function.
    """
    tiles = (ints[2] + PART - 1) // PART
    over_threads(ints[12], ints[13], ints[14], tiles, t, y, rate, floats, ints)
    for tile in range(tiles):
        rate[ints[3]] += floats[ints[9] + tile]
