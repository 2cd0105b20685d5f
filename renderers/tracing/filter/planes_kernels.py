# mypy: ignore-errors
"""Records as planes of float32 in chunks of pixels, so that neighbors are compared in vector lanes.

A chunk is LANES pixels of a row, with HALO more on both sides, so that neighbors in the row stand in the same chunk.
"""

import numpy as np
from numba import types

from renderers.tracing.camera_kernels import TILE
from renderers.tracing.light.sampling_kernels import SIDE
from renderers.tracing.record_kernels import FLATTEST, NORMAL, OWNER, PLACE, RADIUS
from renderers.tracing.scene_kernels import part
from renderers.tracing.tiles_kernels import BLANK, MARKS
from sceneql.compiled.kernels import kernel

F = np.float32
LANES, HALO = 64, SIDE
WIDE = LANES + 2 * HALO
NX, NY, NZ, PX, PY, PZ, REACH, OWN, KEYS = (WIDE * plane for plane in range(9))
"""Offsets of a chunk's planes: normal, point, distance from its tangent plane up to which others are alike, owner (0:
none; outside of the picture NONE). Other planes may follow these keys."""
NONE = F(-1.0)
ZERO, ONE = F(0.0), F(1.0)
NEAR = F(np.nextafter(F(FLATTEST), F(2.0)))
"""The least float32 not below FLATTEST."""
SLACK = 3.0
"""Distance from a plane [pixel radii] up to which a neighbor counts as of the same surface."""
_i = types.int64
LINE = types.float32[::1]
PLANES = types.float32[:, ::1]
"""Type of planes: for each row of the picture one chunk after the other."""


@kernel(types.void(_i, _i, _i, MARKS, PLANES, PLANES, PLANES), _nrt=False)
def lay_out(start, stop, width, marks, records, visibility, planes):
    """Write rows of records (n, COLUMNS) and their visibility (n, V) as planes (h, chunks (8 + V) WIDE).

    ``marks`` (rows / TILE, chunks), here and in the stages that follow, say which chunks are left as they are, being
    BLANK, and which are wiped.
    """
    columns = visibility.shape[1]
    size = KEYS + columns * WIDE
    for y in range(start, stop):
        for chunk in range(planes.shape[1] // size):
            if marks[y // TILE, chunk] == BLANK:
                continue
            out = planes[y, chunk * size : (chunk + 1) * size]
            for i in range(WIDE):
                x = chunk * LANES - HALO + i
                if x < 0 or x >= width or records[y * width + x, OWNER] == ZERO:
                    for plane in range(8 + columns):
                        out[plane * WIDE + i] = ZERO
                    if x < 0 or x >= width:
                        out[OWN + i] = NONE
                    continue
                record = records[y * width + x]
                for axis in range(3):
                    out[NX + axis * WIDE + i] = record[NORMAL + axis]
                    out[PX + axis * WIDE + i] = record[PLACE + axis]
                out[REACH + i] = SLACK * record[RADIUS]
                out[OWN + i] = record[OWNER]
                for column in range(columns):
                    out[KEYS + column * WIDE + i] = visibility[y * width + x, column]


@kernel(types.void(LINE, LINE, LINE), _nrt=False, inner=True)
def alike_lanes(a, b, same):
    """Set ``same`` to 1 where LANES pixels ``a`` and ``b`` (slices of planes) lie on one smooth surface, else to 0.

    As record_kernels.alike; pixels without a record are alike to none.
    """
    for i in range(LANES):
        dot = a[NX + i] * b[NX + i] + a[NY + i] * b[NY + i] + a[NZ + i] * b[NZ + i]
        off = (b[PX + i] - a[PX + i]) * a[NX + i]
        off += (b[PY + i] - a[PY + i]) * a[NY + i]
        off += (b[PZ + i] - a[PZ + i]) * a[NZ + i]
        near = (a[OWN + i] == b[OWN + i]) & (dot >= NEAR) & (abs(off) < a[REACH + i])
        same[i] = ONE if near else ZERO


@part
def itself(a, same):
    """Set ``same`` to 1 where LANES pixels have a record, else to 0."""
    for i in range(LANES):
        same[i] = ONE if a[OWN + i] > ZERO else ZERO


@part
def known(a):
    """Whether any of LANES pixels has a record."""
    for i in range(LANES):
        if a[OWN + i] > ZERO:
            return True
    return False
