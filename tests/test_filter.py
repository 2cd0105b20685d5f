"""The filter of light and sky in lanes, against sums over neighbors pixel by pixel."""

import numpy as np
import pytest

WIDTH, HEIGHT, COLUMNS = 83, 37, 5


@pytest.fixture(scope="module")
def records():
    """(n, columns) of a picture of two bent surfaces, one of them in a stripe, and of nothing in a corner."""
    from renderers.tracing.record_kernels import COLUMNS as WHOLE
    from renderers.tracing.record_kernels import NORMAL, OWNER, PLACE, RADIUS

    x, y = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    stripe = np.abs(x - y - 40) < 3
    owner = np.where(stripe, 2.0, 1.0)
    owner[(x > 70) & (y < 9)] = 0.0
    tilt = np.where(stripe, 0.3, 0.004 * x)
    out = np.zeros((HEIGHT, WIDTH, WHOLE), dtype=np.float32)
    out[..., NORMAL] = np.sin(tilt)
    out[..., NORMAL + 2] = np.cos(tilt)
    out[..., PLACE], out[..., PLACE + 1], out[..., PLACE + 2] = x, y, np.where(stripe, 4.0, -0.002 * x * x)
    out[..., RADIUS], out[..., OWNER] = 0.5, owner
    return out.reshape(-1, WHOLE)


def alike(records, k, m):
    """As record_kernels.alike tells it, and the width of the filter."""
    from renderers.tracing.record_kernels import NORMAL, OWNER, PLACE, RADIUS

    a, b = records[k].astype(float), records[m].astype(float)
    normal = slice(NORMAL, NORMAL + 3)
    off = (b[PLACE : PLACE + 3] - a[PLACE : PLACE + 3]) @ a[normal]
    return bool(a[OWNER] == b[OWNER] > 0.0 and a[normal] @ b[normal] >= 0.9 and abs(off) < 3.0 * a[RADIUS])


def joined(records, values, x, y, places):
    """(weight, weighted sum of ``values``) over ``places`` (dx, dy, share) about a pixel, of those alike."""
    weight, total, k = 0.0, np.zeros(values.shape[1]), y * WIDTH + x
    for dx, dy, share in places:
        i, j = x + dx, y + dy
        if 0 <= i < WIDTH and 0 <= j < HEIGHT and alike(records, k, j * WIDTH + i):
            weight += share * values[j * WIDTH + i, 0]
            total += share * values[j * WIDTH + i]
    return weight, total


def test_windows_join_the_pixels_of_one_surface(records):
    """Means along x, then y, and the sky's over wider windows, are those of sums pixel by pixel."""
    from renderers.tracing.camera_kernels import TILE
    from renderers.tracing.filter.filter_kernels import deepen, widen
    from renderers.tracing.filter.planes_kernels import HALO, KEYS, LANES, WIDE, lay_out
    from renderers.tracing.filter.spread_kernels import ROOM, spread_sky
    from renderers.tracing.record_kernels import OWNER
    from renderers.tracing.tiles_kernels import LOSSY

    count, chunks = WIDTH * HEIGHT, -(-WIDTH // LANES)
    visibility = np.random.default_rng(1).uniform(size=(count, COLUMNS)).astype(np.float32)
    planes = np.full((HEIGHT, chunks * (KEYS + COLUMNS * WIDE)), 7.0, dtype=np.float32)
    sums = np.full((HEIGHT, chunks * (1 + COLUMNS) * LANES), 7.0, dtype=np.float32)
    means = np.full((HEIGHT, chunks * (1 + COLUMNS) * WIDE), 7.0, dtype=np.float32)
    fine = np.zeros((count, COLUMNS), dtype=np.float32)
    marks, busy = np.full((2, -(-HEIGHT // TILE), -(-WIDTH // TILE)), LOSSY, dtype=np.int8)
    lay_out(0, HEIGHT, WIDTH, marks, records, visibility, planes)
    widen(0, HEIGHT, COLUMNS, marks, planes, sums, np.empty(LANES, dtype=np.float32))
    deepen(0, HEIGHT, COLUMNS, marks, planes, sums, means, np.empty(LANES, dtype=np.float32))
    spread_sky(0, HEIGHT, WIDTH, COLUMNS, busy, planes, means, fine, np.empty(ROOM, dtype=np.float32))

    ones = np.concatenate([np.ones((count, 1)), visibility], axis=1)
    ends = [(j, 0.5 if abs(j) == 4 else 1.0) for j in range(-4, 5)]
    rows = np.zeros((count, 1 + COLUMNS))
    for k in range(count):
        rows[k] = joined(records, ones, k % WIDTH, k // WIDTH, [(j, 0, share) for j, share in ends])[1]
    wanted = np.zeros((count, 1 + COLUMNS))
    for k in range(count):
        wanted[k] = joined(records, rows, k % WIDTH, k // WIDTH, [(0, j, share) for j, share in ends])[1]
    own = means.reshape(HEIGHT, chunks, 1 + COLUMNS, WIDE)[..., HALO : HALO + LANES]
    own = own.transpose(0, 1, 3, 2).reshape(HEIGHT, -1, 1 + COLUMNS)[:, :WIDTH].reshape(count, -1)
    assert np.allclose(own[:, 0], wanted[:, 0], atol=0)
    known = records[:, OWNER] > 0.0
    assert not own[~known].any()
    assert np.abs(own[known, 1:] - wanted[known, 1:] / wanted[known, :1]).max() < 1e-6

    wide = [(8 * i, 8 * j, float((2 - abs(i)) * (2 - abs(j)))) for j in (-1, 0, 1) for i in (-1, 0, 1)]
    narrow = [(4 * i, 4 * j, 1.0) for j in (-1, 1) for i in (-1, 1)]
    used = [0, 0, 0]
    for k in np.flatnonzero(known):
        at = k % WIDTH, k // WIDTH
        weight, total = joined(records, wanted, *at, wide)
        kind = 0
        if weight < 16 * 64:
            (weight, total), kind = joined(records, wanted, *at, narrow), 1
            if weight < 4 * 64:
                weight, total, kind = weight + wanted[k, 0], total + wanted[k], 2
        used[kind] += 1
        assert np.abs(fine[k, :3] - total[1:4] / weight).max() < 1e-5
    assert min(used) > 0
