"""Which sample a pixel takes: one point of a 64-point net for each pixel of an 8 x 8 block.

Pixel (x, y) takes the point whose index is the Morton code of (x mod 8, y mod 8). Any window of 8 x 8 pixels then has
each point once, and every aligned 2 x 2 or 4 x 4 block a net of its own (Ahmed and Wonka 2020), so that the filter
leaves nothing of the pattern.
"""

import numpy as np

from renderers.tracing.scene_kernels import part

SIDE = 8
COUNT = SIDE * SIDE


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


def _net():
    """(COUNT, 4) points of [0, 1)^4: a (0, 2)-net, and another order of it."""
    points = np.empty((COUNT, 4))
    for k in range(COUNT):
        points[k, :2] = _radical_inverse(6, k), _second(k)
        other = (k * 37 + 11) % COUNT
        points[k, 2:] = _second(other), _radical_inverse(6, other)
    return points + 0.5 / COUNT


def _disk(points):
    """Points of [0, 1)^2 brought to the unit disk with equal areas."""
    radius, angle = np.sqrt(points[:, 0]), 2.0 * np.pi * points[:, 1]
    return np.ascontiguousarray(np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1))


_NET = _net()
DISK = _disk(_NET)
"""(COUNT, 2) points of the unit disk."""
JITTER = np.ascontiguousarray(_NET[:, 2:] - 0.5)
"""(COUNT, 2) points of a pixel, from its center."""


def subpixels(samples):
    """(samples, 2) points of a pixel, 0..1, one in each of ``samples`` rows and columns."""
    bits = samples.bit_length() - 1
    points = [(_radical_inverse(bits, k), _second(k)) for k in range(samples)]
    return np.array(points) + 0.5 / samples


@part
def morton(x, y):
    """Index of the sample of pixel (x, y)."""
    return (x & 1) | ((y & 1) << 1) | ((x & 2) << 1) | ((y & 2) << 2) | ((x & 4) << 2) | ((y & 4) << 3)


@part
def across(nx, ny, nz):
    """Two unit vectors that make a right-handed frame with a unit normal (Duff et al. 2017)."""
    sign = np.copysign(1.0, nz)
    a = -1.0 / (sign + nz)
    b = nx * ny * a
    return 1.0 + sign * nx * nx * a, sign * b, -sign * nx, b, sign + ny * ny * a, -ny
