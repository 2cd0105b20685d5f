# mypy: ignore-errors
"""The sample of each pixel: one point of a net for each pixel of a block, 8 x 8 for lights, 16 x 16 for the sky.

The index of pixel (x, y)'s point is linear over GF(2) in the bits of its place in the block. Any window of the block's
size then has each point once. The filter's window moves by whole rows and columns of the block, so these are nets as
well, as nearly as their number of points allows, and so are aligned blocks of 2 x 2 and 4 x 4 pixels (Ahmed and Wonka
2020 order the points along a curve, which leaves stripes: its rows and columns lie on few lines).
"""

import numpy as np

from renderers.tracing.scene_kernels import part

SIDE = 8
COUNT = SIDE * SIDE
"""Samples of a light."""
SKY_COUNT = 4 * COUNT
"""Samples of the sky."""


def _radical_inverse(bits, index):
    return sum(((index >> k) & 1) << (bits - 1 - k) for k in range(bits)) / (1 << bits)


def _second(index):
    """The second coordinate of Sobol's (0, 2)-sequence (Sobol 1967) in 32 bits."""
    result, direction = 0, 1 << 31
    while index:
        if index & 1:
            result ^= direction
        index >>= 1
        direction ^= direction >> 1
    return result / 2.0**32


def _sobol(degree, middle, starts, index):
    """A further coordinate of Sobol's sequence, by the inner coefficients of its primitive polynomial as bits."""
    m = list(starts)
    while len(m) < 32:
        new = m[-degree] ^ (m[-degree] << degree)
        for k in range(1, degree):
            new ^= (middle >> (degree - 1 - k) & 1) * (m[-k] << k)
        m.append(new)
    result = 0
    for k in range(32):
        result ^= (index >> k & 1) * (m[k] << (31 - k))
    return result / 2.0**32


def _net(count):
    """(count, 2) points of [0, 1)^2, in the middle of their cells: the first of Sobol's sequence, which make a net."""
    bits = count.bit_length() - 1
    return np.array([(_radical_inverse(bits, k), _second(k)) for k in range(count)]) + 0.5 / count


def _further(count):
    """(count, 2): the third and fourth coordinate of the same points (Joe and Kuo 2008)."""
    return np.array([(_sobol(2, 1, (1, 3), k), _sobol(3, 1, (1, 3, 1), k)) for k in range(count)]) + 0.5 / count


def _disk(points):
    """Points of [0, 1)^2 mapped to the unit disk with equal areas."""
    radius, angle = np.sqrt(points[:, 0]), 2.0 * np.pi * points[:, 1]
    return np.ascontiguousarray(np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1))


DISK = _disk(_net(COUNT))
"""(COUNT, 2) points of a light's disk."""
SKY_DISK = _disk(_net(SKY_COUNT))
"""(SKY_COUNT, 2) points of the unit disk; lifted to the hemisphere they are cosine-distributed (Malley)."""
NEXT_DISK = _disk(_further(SKY_COUNT))
"""(SKY_COUNT, 2) points of the disk for the directions in which those of SKY_DISK go on from what they meet."""
JITTER = _net(COUNT)[np.arange(COUNT) * 37 % COUNT, ::-1] - 0.5
"""(COUNT, 2) offsets from a pixel's center, in another order than the points of DISK."""


def subpixels(samples: int):
    """(samples, 2) points of a pixel, 0..1, one in each of ``samples`` rows and columns."""
    return _net(samples)


ACROSS, DOWN = (1, 135, 29, 64), (2, 11, 165, 128)
"""Summand of the index for each bit of x and of y, found by search; bits beyond SIDE leave the lights' index."""


def _number(x, y):
    """The index by its bits."""
    number = 0
    for bit in range(4):
        number ^= ((x >> bit) & 1) * ACROSS[bit] ^ ((y >> bit) & 1) * DOWN[bit]
    return number


NUMBERS = np.array([[_number(x, y) for x in range(16)] for y in range(16)], dtype=np.uint8)
"""(16, 16) indices by y and x, which repeat: to look them up takes less than to put their bits together."""


@part
def sample_of(x, y):
    """Index of the sky's sample of pixel (x, y); modulo COUNT it is that of the lights' sample."""
    return int(NUMBERS[y & 15, x & 15])


@part
def across(nx, ny, nz):
    """Two unit vectors that make a right-handed frame with a unit normal (Duff et al. 2017)."""
    sign = np.copysign(1.0, nz)
    a = -1.0 / (sign + nz)
    b = nx * ny * a
    return 1.0 + sign * nx * nx * a, sign * b, -sign * nx, b, sign + ny * ny * a, -ny
