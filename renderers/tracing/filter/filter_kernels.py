# mypy: ignore-errors
"""Second stage: visibility averaged over 8 x 8 pixels of one surface, which have each sample of the net once."""

from numba import types

from renderers.tracing.camera_kernels import TILE
from renderers.tracing.filter import planes_kernels as chunks
from renderers.tracing.filter.planes_kernels import HALO, LANES, WIDE, ZERO, F
from renderers.tracing.light.sampling_kernels import SIDE
from renderers.tracing.scene_kernels import part
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
            whole, out = planes[y, chunk * size :], sums[y, chunk * own :]
            a, flat = whole[HALO:], chunks.one_face(whole, whole)
            for i in range(own):
                out[i] = ZERO
            if not chunks.known(a):
                continue
            mixed = columns
            while mixed > 0 and chunks.even(whole, mixed - 1) != chunks.MIXED:
                mixed -= 1
            for j in range(-REACH, REACH + 1):
                b = whole[HALO + j :]
                if j == 0:
                    chunks.itself(a, same)
                elif flat:
                    chunks.both(a, b, same)
                else:
                    chunks.alike_lanes(a, b, same)
                share = F(0.5) if abs(j) == REACH else F(1.0)
                for i in range(LANES):
                    out[i] += share * same[i]
                add_lanes(same, share, b[chunks.KEYS :], WIDE, out[LANES:], LANES, mixed)
            for column in range(mixed, columns):
                if chunks.even(whole, column) == chunks.ONE:
                    total = out[(1 + column) * LANES :]
                    for i in range(LANES):
                        total[i] = out[i]


@part
def evenly(planes, first, last, at, column):
    """Whether a column of the visibility of a chunk has one number, 0 or 1, in all rows first..last."""
    place = at + chunks.EVEN + column
    if column >= chunks.MOST or planes[first, place] == chunks.MIXED:
        return False
    for row in range(first + 1, last + 1):
        if planes[row, place] != planes[first, place]:
            return False
    return True


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
            whole, out = planes[y, chunk * size :], means[y, chunk * of_means + HALO :]
            a, first, last = whole[HALO:], max(-REACH, -y), min(REACH, planes.shape[0] - 1 - y)
            if not chunks.known(a):
                continue
            mixed = columns
            while mixed > 0 and evenly(planes, y + first, y + last, chunk * size, mixed - 1):
                mixed -= 1
            for j in range(first, last + 1):
                b = planes[y + j, chunk * size :]
                if j == 0:
                    chunks.itself(a, same)
                elif chunks.one_face(whole, b):
                    chunks.both(a, b[HALO:], same)
                else:
                    chunks.alike_lanes(a, b[HALO:], same)
                share = F(0.5) if abs(j) == REACH else F(1.0)
                add_lanes(same, share, sums[y + j, chunk * of_sums :], LANES, out, WIDE, 1 + mixed)
            for column in range(mixed):
                total = out[(1 + column) * WIDE :]
                for i in range(LANES):
                    total[i] = total[i] / out[i] if out[i] > ZERO else ZERO
            for column in range(mixed, columns):
                total, value = out[(1 + column) * WIDE :], chunks.even(whole, column)
                for i in range(LANES):
                    total[i] = value if out[i] > ZERO else ZERO
        for chunk in range(across):
            for plane in range(1 + columns if marks[y // TILE, chunk] == LAY else 0):
                at = chunk * of_means + plane * WIDE
                for i in range(HALO):
                    if chunk > 0:
                        means[y, at + i] = means[y, at - of_means + LANES + i]
                    if chunk + 1 < across:
                        means[y, at + HALO + LANES + i] = means[y, at + of_means + HALO + i]
