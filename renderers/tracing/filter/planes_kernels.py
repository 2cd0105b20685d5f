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
NX, NY, NZ, PX, PY, PZ, REACH, OWN, NOTES, KEYS = (WIDE * plane for plane in range(10))
"""Offsets of a chunk's planes: normal, point, distance from its tangent plane up to which others are alike, owner (0:
none; outside of the picture NONE). Other planes may follow these keys. In place of a plane NOTES on the whole chunk."""
FACE, UPRIGHT, HEIGHT, NARROW, EVEN = NOTES, NOTES + 1, NOTES + 4, NOTES + 5, NOTES + 6
"""Of the notes: the owner, if all that the chunk and its halo show is one flat face of it, else 0; that face's normal
(3), its distance from the origin along that, a number below each REACH; for each further plane, up to MOST, the one
number 0 or 1 that it has where there is a record, or MIXED."""
MOST = WIDE - (EVEN - NOTES)
MIXED = F(2.0)
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


@part
def note_face(out):
    """Note whether a chunk shows one flat face and nothing else, all of it within a tenth of NARROW of a plane."""
    out[FACE] = ZERO
    first = 0
    while first < WIDE and out[OWN + first] < ZERO:
        first += 1
    last = min(first + 1, WIDE - 1)
    if first == WIDE or out[OWN + first] == ZERO or out[NX + first] != out[NX + last]:
        return
    own, nx, ny, nz = out[OWN + first], out[NX + first], out[NY + first], out[NZ + first]
    height = out[PX + first] * nx + out[PY + first] * ny + out[PZ + first] * nz
    narrow, odd = F(0.5) * out[REACH + first], 0
    for i in range(WIDE):
        off = out[PX + i] * nx + out[PY + i] * ny + out[PZ + i] * nz - height
        same = (out[OWN + i] == own) & (out[NX + i] == nx) & (out[NY + i] == ny) & (out[NZ + i] == nz)
        same &= (abs(off) < F(0.1) * narrow) & (out[REACH + i] >= narrow)
        odd += 0 if same | (out[OWN + i] < ZERO) else 1
    if odd == 0:
        out[FACE], out[UPRIGHT], out[UPRIGHT + 1], out[UPRIGHT + 2] = own, nx, ny, nz
        out[HEIGHT], out[NARROW] = height, narrow


@part
def note_even(out, columns):
    """Note which of the planes behind the keys have one number, 0 or 1."""
    for column in range(min(columns, MOST)):
        zeros = ones = 0
        for i in range(WIDE):
            own, none = out[KEYS + column * WIDE + i], out[OWN + i] <= ZERO
            zeros += 1 if none | (own == ZERO) else 0
            ones += 1 if none | (own == ONE) else 0
        out[EVEN + column] = ZERO if zeros == WIDE else (ONE if ones == WIDE else MIXED)


@part
def even(chunk, column):
    """The one number of a plane behind the keys, or MIXED."""
    return chunk[EVEN + column] if column < MOST else MIXED


@part
def one_face(a, b):
    """Whether two chunks show the same flat face alone, so that any two pixels of theirs with records are alike.

    Their distances from the face's plane, and their rounding, are then far less than what ``alike_lanes`` allows.
    """
    if a[FACE] == ZERO or a[FACE] != b[FACE]:
        return False
    if a[UPRIGHT] != b[UPRIGHT] or a[UPRIGHT + 1] != b[UPRIGHT + 1] or a[UPRIGHT + 2] != b[UPRIGHT + 2]:
        return False
    near = abs(a[HEIGHT] - b[HEIGHT]) + F(1e-6) * abs(a[HEIGHT]) < F(0.2) * a[NARROW]
    return near and b[NARROW] < F(4.0) * a[NARROW]


@part
def both(a, b, same):
    """Set ``same`` to 1 where LANES pixels ``a`` and ``b`` have records, else to 0."""
    for i in range(LANES):
        same[i] = ONE if (a[OWN + i] > ZERO) & (b[OWN + i] > ZERO) else ZERO


@kernel(types.void(_i, _i, _i, MARKS, PLANES, PLANES, PLANES), _nrt=False)
def lay_out(start, stop, width, marks, records, visibility, planes):
    """Write rows of records (n, COLUMNS) and their visibility (n, V) as planes (h, chunks (9 + V) WIDE).

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
                    for plane in range(8):
                        out[plane * WIDE + i] = ZERO
                    for column in range(columns):
                        out[KEYS + column * WIDE + i] = ZERO
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
            note_face(out)
            note_even(out, columns)


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
