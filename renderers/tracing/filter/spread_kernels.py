# mypy: ignore-errors
"""The sky's loss averaged over wider windows than the lights', since its net has four times as many samples."""

from numba import types

from renderers.tracing.camera_kernels import TILE
from renderers.tracing.filter import planes_kernels as chunks
from renderers.tracing.filter.filter_kernels import REACH, add_lanes
from renderers.tracing.filter.planes_kernels import HALO, LANES, WIDE, ZERO, F
from renderers.tracing.light.sampling_kernels import SIDE
from renderers.tracing.light.visibility_kernels import FIRST_LIGHT
from renderers.tracing.scene_kernels import part
from renderers.tracing.tiles_kernels import ACROSS, LOSSY, MARKS, busiest
from sceneql.compiled.kernels import kernel

_i = types.int64
PLAIN, WIDER = F(4.0 * SIDE * SIDE), F(16.0 * SIDE * SIDE)
"""Weights of whole windows of 16 x 16 and of 24 x 24 pixels."""
OF_SKY = (1 + FIRST_LIGHT) * LANES
"""Size of a chunk's sums: weight and weighted loss."""
ROOM = LANES + 2 * OF_SKY
"""Size of the working memory of ``spread_sky``."""


@part
def join(planes, means, y, row, at, mean_at, off, share, sums, same):
    """Add ``share`` times the 8 x 8 means of pixels ``off`` columns away, in a row, to ``sums``, where they are alike.

    The chunk begins at ``at`` in row y of the planes, at ``mean_at`` in the means.
    """
    if row < 0 or row >= planes.shape[0]:
        return
    if row == y and off == 0:
        chunks.itself(planes[y, at:], same)
    elif chunks.one_face(planes[y, at - HALO :], planes[row, at - HALO :]):
        chunks.both(planes[y, at:], planes[row, at + off :], same)
    else:
        chunks.alike_lanes(planes[y, at:], planes[row, at + off :], same)
    mean = means[row, mean_at + off :]
    for i in range(LANES):
        same[i] = share * same[i] * mean[i]
        sums[i] += same[i]
    add_lanes(same, F(1.0), mean[WIDE:], WIDE, sums[LANES:], LANES, FIRST_LIGHT)


@part
def narrower(planes, means, y, at, mean_at, sums, same):
    """A plain window of 16 x 16 pixels, from four means; where an edge cuts it the mean in its middle completes it."""
    for i in range(OF_SKY):
        sums[i] = ZERO
    for corner in range(4):
        off, down = REACH * (2 * (corner & 1) - 1), REACH * ((corner & 2) - 1)
        join(planes, means, y, y + down, at, mean_at, off, F(1.0), sums, same)
    mean = means[y, mean_at:]
    for i in range(LANES):
        same[i] = mean[i] if sums[i] < PLAIN else ZERO
        sums[i] += same[i]
    add_lanes(same, F(1.0), mean[WIDE:], WIDE, sums[LANES:], LANES, FIRST_LIGHT)


@kernel(types.void(_i, _i, _i, _i, MARKS, chunks.PLANES, chunks.PLANES, chunks.PLANES, chunks.LINE), _nrt=False)
def spread_sky(start, stop, width, columns, busy, planes, means, fine, memory):
    """The sky's loss over 24 x 24 pixels, from nine means over 8 x 8 of weights 1 2 1, 2 4 2, 1 2 1, into ``fine``.

    Each of its samples, one in 16 x 16 pixels, has the same weight in all, and samples that enter and leave as the
    window moves have half of their weight in a plain window, so that stripes are fainter. Near edges the window is a
    plain one. Where no tile around is LOSSY (``busy``, rows of tiles and tiles) there is nothing to spread. Planes and
    means are those of filter_kernels, ``fine`` is (n, V), ``memory`` (ROOM,).
    """
    size, of_means = chunks.KEYS + columns * WIDE, (1 + columns) * WIDE
    same, wide, narrow = memory[:LANES], memory[LANES : LANES + OF_SKY], memory[LANES + OF_SKY :]
    for y in range(start, stop):
        for chunk in range(means.shape[1] // of_means):
            at, mean_at = chunk * size + HALO, chunk * of_means + HALO
            a = planes[y, at:]
            most = busiest(busy, y // TILE, ACROSS * chunk, ACROSS * chunk + ACROSS - 1)
            if most == 0 or not chunks.known(a):
                continue
            if most < LOSSY:
                for i in range(min(LANES, width - chunk * LANES)):
                    for c in range(FIRST_LIGHT if a[chunks.OWN + i] > ZERO else 0):
                        fine[y * width + chunk * LANES + i, c] = ZERO
                continue
            for i in range(OF_SKY):
                wide[i] = ZERO
            for place in range(9):
                across, down = place % 3 - 1, place // 3 - 1
                share = F((2 - abs(across)) * (2 - abs(down)))
                join(planes, means, y, y + SIDE * down, at, mean_at, SIDE * across, share, wide, same)
            cut = False
            for i in range(LANES):
                cut = cut or (a[chunks.OWN + i] > ZERO and wide[i] < WIDER)
            if cut:
                narrower(planes, means, y, at, mean_at, narrow, same)
            for i in range(min(LANES, width - chunk * LANES)):
                if a[chunks.OWN + i] > ZERO:
                    sums = narrow if wide[i] < WIDER else wide
                    for c in range(FIRST_LIGHT):
                        fine[y * width + chunk * LANES + i, c] = sums[(1 + c) * LANES + i] / sums[i]
