# mypy: ignore-errors
"""Second stage: visibility averaged over 8 x 8 pixels of one surface, which have each sample of the net once."""

from numba import types

from renderers.tracing.camera_kernels import TILE
from renderers.tracing.filter import planes_kernels as chunks
from renderers.tracing.filter.planes_kernels import HALO, LANES, WIDE, ZERO, F
from renderers.tracing.light.sampling_kernels import SIDE
from renderers.tracing.tiles_kernels import BLANK, LAY, MARKS
from sceneql.compiled.kernels import kernel

_i = types.int64
REACH = SIDE // 2


@kernel(types.void(chunks.LINE, types.float32, chunks.LINE, _i, chunks.LINE, _i, _i), _nrt=False, inner=True)
def add_lanes(same, share, values, apart, sums, own_apart, columns):
    """Add ``share`` times planes of ``values``, ``apart`` numbers apart, to those of ``sums``, where ``same`` is 1."""
    for column in range(columns):
        value, total = values[column * apart :], sums[column * own_apart :]
        for i in range(LANES):
            total[i] += share * same[i] * value[i]


@kernel(types.void(_i, _i, _i, MARKS, chunks.PLANES, chunks.PLANES, chunks.LINE), _nrt=False)
def widen(start, stop, columns, marks, planes, sums, same):
    """Filter along x: weight and weighted visibility of rows start..stop into ``sums``.

    ``planes`` are those of planes_kernels with the visibility (V columns) behind the keys, ``sums`` has 1 + V planes of
    LANES a chunk. ``same`` (LANES,) is working memory.
    """
    size, own = chunks.KEYS + columns * WIDE, (1 + columns) * LANES
    for y in range(start, stop):
        for chunk in range(sums.shape[1] // own):
            if marks[y // TILE, chunk] == BLANK:
                continue
            a, out = planes[y, chunk * size + HALO :], sums[y, chunk * own :]
            for i in range(own):
                out[i] = ZERO
            if not chunks.known(a):
                continue
            for j in range(-REACH, REACH + 1):
                b = planes[y, chunk * size + HALO + j :]
                if j == 0:
                    chunks.itself(a, same)
                else:
                    chunks.alike_lanes(a, b, same)
                share = F(0.5) if abs(j) == REACH else F(1.0)
                for i in range(LANES):
                    out[i] += share * same[i]
                add_lanes(same, share, b[chunks.KEYS :], WIDE, out[LANES:], LANES, columns)


@kernel(types.void(_i, _i, _i, MARKS, chunks.PLANES, chunks.PLANES, chunks.PLANES, chunks.LINE), _nrt=False)
def deepen(start, stop, columns, marks, planes, sums, means, same):
    """Filter along y: number of pixels joined, and their mean visibility, of rows start..stop into ``means``.

    It has 1 + V planes of WIDE a chunk, with the neighbors' at both its ends.
    """
    size, of_sums, of_means = chunks.KEYS + columns * WIDE, (1 + columns) * LANES, (1 + columns) * WIDE
    across = sums.shape[1] // of_sums
    for y in range(start, stop):
        for chunk in range(across):
            if marks[y // TILE, chunk] == BLANK:
                continue
            for i in range(chunk * of_means, (chunk + 1) * of_means):
                means[y, i] = ZERO
            a, out = planes[y, chunk * size + HALO :], means[y, chunk * of_means + HALO :]
            if not chunks.known(a):
                continue
            for j in range(max(-REACH, -y), min(REACH, planes.shape[0] - 1 - y) + 1):
                if j == 0:
                    chunks.itself(a, same)
                else:
                    chunks.alike_lanes(a, planes[y + j, chunk * size + HALO :], same)
                share = F(0.5) if abs(j) == REACH else F(1.0)
                add_lanes(same, share, sums[y + j, chunk * of_sums :], LANES, out, WIDE, 1 + columns)
            for column in range(1, 1 + columns):
                total = out[column * WIDE :]
                for i in range(LANES):
                    total[i] = total[i] / out[i] if out[i] > ZERO else ZERO
        for chunk in range(across):
            for plane in range(1 + columns if marks[y // TILE, chunk] == LAY else 0):
                at = chunk * of_means + plane * WIDE
                for i in range(HALO):
                    if chunk > 0:
                        means[y, at + i] = means[y, at - of_means + LANES + i]
                    if chunk + 1 < across:
                        means[y, at + HALO + LANES + i] = means[y, at + of_means + HALO + i]
