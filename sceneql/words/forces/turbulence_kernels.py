# mypy: ignore-errors
"""Curl noise, and the drag of air that moves with its velocity.

The velocity is the curl of a smooth vector potential, so its divergence is exactly zero (Bridson, Hourihan & Nordenstam
2007, Curl-noise for procedural fluid flow). In a cell of the lattice psi = sum over corners of w(f) (g x d + a h), with
quintic weights w (Perlin 2002), d from the corner, and random vectors g and h of each corner:

    u = curl psi = sum of 2 w g + grad w x (g x d + a h)

At a corner u = 2 g; the constant a makes u^2 nearly as large everywhere. In time g and h rotate into one another.
"""

import math

import numpy as np

from sceneql.compiled.arithmetic_kernels import always_inlined, bits, fma, widest
from sceneql.compiled.kernels import inlined, kernel
from sceneql.compiled.threads_kernels import TILE, over_threads
from sceneql.system.signatures_kernels import TERM

POSITION_AT, VELOCITY_AT, COUNT, WORK_AT, INVERSE_AT, SPEED_AT, LINEAR_AT, AIR_AT, NUMBERS_AT = range(9)
POWER_AT, OCTAVES, SEED, ENTRY, THREADS, TILE_AT = range(9, 15)
"""At NUMBERS_AT: size [m], angular frequency [1/s]."""

LANES = 256
"""Particles in a vector loop, in single precision; their cells and places in the cells are computed in double."""
PART = 8 * LANES
"""Particles of a tile."""
MANY = 8
"""Least number of tiles for threads; a block of an island (march_blocks.py) has fewer, and its own threads."""
FASTER = 2.0 ** (2.0 / 3.0)
"""Ratio of the rates of change of eddies of half the size (Kolmogorov 1941)."""
ROUGHNESS = 2.0 ** (-1.0 / 3.0)
"""Speed of eddies of half the size (Kolmogorov 1941)."""
EVEN = np.float32(0.75)
"""The constant a above."""
WHOLE = 1.5 * 2.0**52
"""Adding and subtracting this number rounds to an integer."""
SPREAD = 1.8538
"""Root mean square of the curl of one octave, measured."""
FX, FY, FZ, UX, UY, UZ, ROWS = range(7)
"""Rows of scratch: place in the cell, the velocity of an octave."""


@inlined
def mixed(h):
    """Hash of 32 bits (Wellons 2018, hash prospector, "lowbias32")."""
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
    """The next pseudorandom word."""
    h = np.uint32(h * np.uint32(0x9E3779B1))
    return np.uint32(h ^ (h >> np.uint32(15)))


@inlined
def corner(h, dx, dy, dz, cosine, sine, along, against):
    """One corner's g x d + a h and g, from its hash; d from the corner. The numbers turn by an angle in time."""
    always_inlined()
    p = mixed(h)
    q = next_word(p)
    ex, ey, ez = number(p, 0), number(p, 11), number(p, 22)
    fx, fy, fz = number(q, 0), number(q, 11), number(q, 22)
    gx, gy, gz = fma(sine, fx, cosine * ex), fma(sine, fy, cosine * ey), fma(sine, fz, cosine * ez)
    hx, hy, hz = fma(against, ex, along * fx), fma(against, ey, along * fy), fma(against, ez, along * fz)
    return fma(gy, dz, fma(-gz, dy, hx)), fma(gz, dx, fma(-gx, dz, hy)), fma(gx, dy, fma(-gy, dx, hz)), gx, gy, gz


@inlined
def edge(x, right, yz, fx, dy, dz, sx, cosine, sine, along, against):
    """Interpolate between two corners along x: psi (3), its difference (y, z) between them, g (3)."""
    always_inlined()
    px, py, pz, gx, gy, gz = corner(np.uint32(x ^ yz), fx, dy, dz, cosine, sine, along, against)
    back = fx - np.float32(1.0)
    qx, qy, qz, hx, hy, hz = corner(np.uint32(right ^ yz), back, dy, dz, cosine, sine, along, against)
    qx, qy, qz = qx - px, qy - py, qz - pz
    hx, hy, hz = fma(sx, hx - gx, gx), fma(sx, hy - gy, gy), fma(sx, hz - gz, gz)
    return fma(sx, qx, px), fma(sx, qy, py), fma(sx, qz, pz), qy, qz, hx, hy, hz


@inlined
def face(x, right, y, up, z, fx, fy, dz, sx, sy, cosine, sine, along, against):
    """Interpolate between two edges along y: psi (x, y), its slopes along x (y, z) and along y (x, z), g (3)."""
    always_inlined()
    low, high = np.uint32(y ^ z), np.uint32(up ^ z)
    px, py, pz, ay, az, gx, gy, gz = edge(x, right, low, fx, fy, dz, sx, cosine, sine, along, against)
    back = fy - np.float32(1.0)
    qx, qy, qz, by, bz, hx, hy, hz = edge(x, right, high, fx, back, dz, sx, cosine, sine, along, against)
    ay, az = fma(sy, by - ay, ay), fma(sy, bz - az, az)
    gx, gy, gz = fma(sy, hx - gx, gx), fma(sy, hy - gy, gy), fma(sy, hz - gz, gz)
    return fma(sy, qx - px, px), fma(sy, qy - py, py), ay, az, qx - px, qz - pz, gx, gy, gz


@inlined
def weight(f):
    """Quintic weight of the upper corner, and its slope."""
    square = f * f
    back = f - np.float32(1.0)
    return (
        square * f * fma(f, fma(np.float32(6.0), f, np.float32(-15.0)), np.float32(10.0)),
        np.float32(30.0) * square * (back * back),
    )


@inlined
def cell(seed, cosine, sine, work, cells):
    """Write the curl of one octave to rows UX, UY, UZ, for all lanes, interpolated along x, then y, then z."""
    widest()
    nx, ny, nz = np.uint32(0x8DA6B343), np.uint32(0xD8163841), np.uint32(0xCB1AB31F)
    one, two, along, against = np.float32(1.0), np.float32(2.0), EVEN * cosine, -EVEN * sine
    for k in range(LANES):
        x, y, z = np.uint32(cells[k] ^ seed), cells[LANES + k], cells[2 * LANES + k]
        right, up, out = np.uint32(np.uint32(cells[k] + nx) ^ seed), np.uint32(y + ny), np.uint32(z + nz)
        fx, fy, fz = work[FX * LANES + k], work[FY * LANES + k], work[FZ * LANES + k]
        (sx, tx), (sy, ty), (sz, tz) = weight(fx), weight(fy), weight(fz)
        px, py, ay, az, bx, bz, gx, gy, gz = face(x, right, y, up, z, fx, fy, fz, sx, sy, cosine, sine, along, against)
        qx, qy, cy, cz, dx, dz, hx, hy, hz = face(
            x, right, y, up, out, fx, fy, fz - one, sx, sy, cosine, sine, along, against
        )
        # Slopes of psi: y and z by x, x and z by y, x and y by z.
        ay, az = tx * fma(sz, cy - ay, ay), tx * fma(sz, cz - az, az)
        bx, bz = ty * fma(sz, dx - bx, bx), ty * fma(sz, dz - bz, bz)
        gx, gy, gz = fma(sz, hx - gx, gx), fma(sz, hy - gy, gy), fma(sz, hz - gz, gz)
        work[UX * LANES + k] = fma(two, gx, fma(-tz, qy - py, bz))
        work[UY * LANES + k] = fma(two, gy, fma(tz, qx - px, -az))
        work[UZ * LANES + k] = fma(two, gz, ay - bx)


@inlined
def locate(axis, scale, shift, places, work, cells):
    """For all lanes: lattice cell of a coordinate, and the place in it."""
    widest()
    prime = np.uint32(0x8DA6B343 if axis == 0 else (0xD8163841 if axis == 1 else 0xCB1AB31F))
    for k in range(LANES):
        place = fma(scale, places[axis * LANES + k], shift)
        # After adding a large number the integer is in the last bits.
        rounded = (place - 0.5) + WHOLE
        work[(FX + axis) * LANES + k] = np.float32(place - (rounded - WHOLE))
        cells[axis * LANES + k] = np.uint32(np.uint32(bits(rounded) & 0xFFFFFFFF) * prime)


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
        cell(mixed(np.uint32(seed + 0x632BE5AB * octave)), cosine, sine, work, cells)
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
    """Add the drag of some masses to ``force`` and write the power it takes from each."""
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
    """Sum of the powers, in a fixed order that can be vectorized."""
    size = LANES
    while size > 1:
        size //= 2
        for k in range(size):
            powers[k] += powers[size + k]
    return powers[0]


@kernel(TILE, inner=True)
def turbulence_tile(tile, t, y, rate, floats, ints):
    """Drag on the masses of a tile, from PART tile on; its power goes to floats[power_at + tile]."""
    position_at, velocity_at, inverse_at = ints[POSITION_AT], ints[VELOCITY_AT], ints[INVERSE_AT]
    speed, linear = floats[ints[SPEED_AT]], floats[ints[LINEAR_AT]]
    air_at, numbers_at = ints[AIR_AT], ints[NUMBERS_AT]
    scale, omega = 1.0 / floats[numbers_at], floats[numbers_at + 1]
    ax, ay, az = floats[air_at], floats[air_at + 1], floats[air_at + 2]
    drift = scale * t
    places = np.zeros(3 * LANES)
    powers = np.zeros(LANES)
    total = np.empty(3 * LANES, dtype=np.float32)
    work = np.empty(ROWS * LANES, dtype=np.float32)
    cells = np.empty(3 * LANES, dtype=np.uint32)
    power = 0.0
    last = min(ints[COUNT], PART * (tile + 1))
    for first in range(PART * tile, last, LANES):
        end = min(last, first + LANES)
        split(y[position_at + 3 * first : position_at + 3 * end], scale, drift * ax, drift * ay, drift * az, places)
        factor = speed * curl(places, ints[SEED], omega * t, ints[OCTAVES], work, cells, total)
        for k in range(end - first, LANES):
            powers[k] = 0.0
        push(
            y[velocity_at + 3 * first : velocity_at + 3 * end], floats[inverse_at + first : inverse_at + end],
            linear, factor, ax, ay, az, total, rate[velocity_at + 3 * first : velocity_at + 3 * end], powers,
        )  # fmt: skip
        power += summed(powers)
    floats[ints[POWER_AT] + tile] = power


@kernel(TERM)
def turbulence(t, y, rate, floats, ints):
    """Adds -c (v - u), and takes its power from the work."""
    tiles = (ints[COUNT] + PART - 1) // PART
    if tiles >= MANY:
        over_threads(ints[ENTRY], ints[THREADS], ints[TILE_AT], tiles, t, y, rate, floats, ints)
    else:
        for tile in range(tiles):
            turbulence_tile(tile, t, y, rate, floats, ints)
    for tile in range(tiles):
        rate[ints[WORK_AT]] += floats[ints[POWER_AT] + tile]
