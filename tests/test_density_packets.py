"""Densities of points in packets of rays: what they cost, and how near their roots are to the true ones."""

from __future__ import annotations

import numpy as np
import pytest

from plain_tapes import kernels
from ray_bundles import cast_together
from sceneql.field.packets.packets import Memory
from sceneql.field.tape.tape_ops import HIT

RADIUS, THRESHOLD = 0.4, 0.3


def blobs(count=40):
    """Centers of points and the tape of where their density is more than the threshold."""
    centers = np.random.default_rng(4).uniform(-0.8, 0.8, (count, 3))
    return centers, kernels(centers, THRESHOLD, RADIUS)


def tile(x, y):
    """256 rays in columns of 16, down on a square of 0.1 m at x, y."""
    across, down = np.meshgrid(np.linspace(0.0, 0.1, 16), np.linspace(0.0, 0.1, 16))
    origins = np.column_stack([x + across.ravel(), y + down.ravel(), np.full(256, 3.0)])
    return origins, np.tile([0.0, 0.0, -1.0], (256, 1))


def density(centers, places):
    """D and its slope downward at places (n, 3), by its formula."""
    away = places[:, None] - centers
    u = np.maximum(1.0 - (away**2).sum(axis=2) / RADIUS**2, 0.0)
    return (u**3).sum(axis=1), (6.0 * u**2 * away[:, :, 2] / RADIUS**2).sum(axis=1)


def test_where_a_density_rises_no_segment_is_cut_to_prove_it():
    _, tape = blobs()
    memory = Memory(tape, 256)
    spent = rays = 0
    for x in np.arange(-0.8, 0.8, 0.1):
        origins, ways = tile(x, 0.1)
        memory.rays[:3], memory.rays[3:6], memory.rays[6], memory.rays[7] = origins.T, ways.T, 0.0, 6.0
        segments, _ = memory.settle(256, anywhere=False)
        spent += segments
        rays += (memory.found[0] == HIT).sum()
    assert rays > 2000
    assert spent < 2.5 * rays


@pytest.mark.parametrize("length", [1.0, 3.0])
def test_roots_of_densities_are_polished_to_float64(length):
    """Along directions of any length."""
    centers, tape = blobs()
    for x in (-0.4, 0.0, 0.3):
        origins, ways = tile(x, 0.1)
        status, t = cast_together(tape, origins, length * ways, np.zeros(256), np.full(256, 6.0 / length))
        hit = status == HIT
        assert hit.sum() > 200
        places = origins[hit] + (length * t[hit])[:, None] * ways[hit]
        value, slope = density(centers, places)
        assert np.abs((value - THRESHOLD) / slope).max() < 1e-11
