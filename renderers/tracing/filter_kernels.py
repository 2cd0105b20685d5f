# mypy: ignore-errors
"""Second stage: visibility averaged over 8 x 8 pixels of the same surface, where each sample of the net stands once."""

from numba import types

from renderers.tracing.record_kernels import OWNER, alike
from renderers.tracing.sampling_kernels import SIDE
from sceneql.kernels import kernel

_i = types.int64
_rows = types.float32[:, ::1]
REACH = SIDE // 2
SLACK = 3.0
"""Distance off a plane [pixel radii] up to which a neighbor counts as of the same surface."""


@kernel(types.void(_i, _i, _i, _rows, _rows, _rows), _nrt=False)
def widen(start, stop, width, records, visibility, sums):
    """Rows of ``sums`` (n, 1 + V) from one row of pixels each: weight and weighted visibility, along x."""
    columns = visibility.shape[1]
    for y in range(start, stop):
        for x in range(width):
            k = y * width + x
            for c in range(columns + 1):
                sums[k, c] = 0.0
            if records[k, OWNER] == 0.0:
                continue
            for j in range(max(-REACH, -x), min(REACH, width - 1 - x) + 1):
                m = k + j
                if j != 0 and not alike(records[k], records[m], SLACK):
                    continue
                share = 0.5 if abs(j) == REACH else 1.0
                sums[k, 0] += share
                for c in range(columns):
                    sums[k, 1 + c] += share * visibility[m, c]


@kernel(types.void(_i, _i, _i, _i, _rows, _rows, _rows), _nrt=False)
def deepen(start, stop, width, height, records, sums, means):
    """Rows of ``means`` (n, 1 + V): number of pixels joined, and their mean visibility, from ``sums`` along y."""
    columns = sums.shape[1]
    for y in range(start, stop):
        for x in range(width):
            k = y * width + x
            for c in range(columns):
                means[k, c] = 0.0
            if records[k, OWNER] == 0.0:
                continue
            for j in range(max(-REACH, -y), min(REACH, height - 1 - y) + 1):
                m = k + j * width
                if j != 0 and not alike(records[k], records[m], SLACK):
                    continue
                share = 0.5 if abs(j) == REACH else 1.0
                for c in range(columns):
                    means[k, c] += share * sums[m, c]
            for c in range(1, columns):
                means[k, c] /= means[k, 0]
