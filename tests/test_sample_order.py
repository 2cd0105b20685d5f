"""Which sample a pixel takes: windows hold each once, and rows, columns and blocks are nets."""

from __future__ import annotations

import numpy as np
import pytest

from renderers.tracing.light.sampling_kernels import COUNT, DISK, SIDE, SKY_COUNT, SKY_DISK, sample_of

ORDER = np.array([[sample_of.py_func(x, y) for x in range(4 * SIDE)] for y in range(4 * SIDE)])
"""By y and x."""


def unit(disk):
    """Points of the disk brought back to the square."""
    return np.stack([(disk**2).sum(axis=1), np.arctan2(disk[:, 1], disk[:, 0]) / (2 * np.pi) % 1.0], axis=1)


def fullest(points):
    """The largest number of 2^k points in an elementary interval of area 2^-k; 1: a net."""
    bits = len(points).bit_length() - 1
    counts = []
    for k in range(bits + 1):
        cells = (points * [2**k, 2 ** (bits - k)]).astype(int)
        counts.append(np.unique(cells, axis=0, return_counts=True)[1].max())
    return max(counts)


@pytest.mark.parametrize(("left", "top"), [(0, 0), (5, 3), (15, 9)])
def test_any_window_has_each_sample_once(left, top):
    sky = ORDER[top : top + 2 * SIDE, left : left + 2 * SIDE]
    lights = ORDER[top : top + SIDE, left : left + SIDE] % COUNT
    assert sorted(sky.ravel()) == list(range(SKY_COUNT))
    assert sorted(lights.ravel()) == list(range(COUNT))


@pytest.mark.parametrize("at", range(2 * SIDE))
def test_rows_and_columns_are_nets_of_lights_and_nearly_of_the_sky(at):
    for line in (ORDER[at], ORDER[:, at]):
        for start in range(0, 2 * SIDE, SIDE):
            assert fullest(unit(DISK)[line[start : start + SIDE] % COUNT]) == 1
        assert fullest(unit(SKY_DISK)[line[3 : 3 + 2 * SIDE]]) <= 2


@pytest.mark.parametrize("side", [2, 4])
def test_aligned_blocks_are_nets(side):
    for top in range(0, 2 * SIDE, side):
        for left in range(0, 2 * SIDE, side):
            block = ORDER[top : top + side, left : left + side].ravel()
            assert fullest(unit(DISK)[block % COUNT]) == 1
            assert fullest(unit(SKY_DISK)[block]) == 1
