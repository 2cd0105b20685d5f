# mypy: ignore-errors
"""Normals and colors of implicit solids at many hits of neighboring rays, in lanes."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.scene_kernels import SCENE, part
from renderers.tracing.solids.ranges_kernels import tape_of
from renderers.tracing.solids.skin_kernels import face_normal
from renderers.tracing.solids.surface_kernels import unit
from sceneql.compiled.kernels import lean
from sceneql.field.tape.batch_kernels import evaluate
from sceneql.field.tape.near_gradient_kernels import gradients

_rows = types.float64[:, ::1]
LANES = 64
"""Hits of a batch."""


HITS = (SCENE, types.int64[::1], _rows, _rows)
MEMORY = (
    _rows, types.float64[:, :, ::1], _rows, types.int32[:, :, ::1], _rows, types.float32[:, ::1], types.int64[::1],
    types.int64[::1], _rows, types.int32[:, ::1], types.int32[::1], types.float64[::1],
)  # fmt: skip
"""Types of what ``skin_hits`` takes: hits, and memory."""


@part
def own_tape(ranges, ints, reals):
    """(code, constants, parts) of a tape of which ``own_tapes`` made the ``ranges`` (6,), ``ints`` and ``reals``."""
    code, rows, constants, count, parts, some = ranges[0], ranges[1], ranges[2], ranges[3], ranges[4], ranges[5]
    return (
        ints[code : code + 4 * rows].reshape(rows, 4),
        reals[constants : constants + count],
        reals[parts : parts + 8 * some].reshape(some, 8),
    )


@lean(types.void(*HITS, *MEMORY))
def skin_hits(
    scene, hits, met, skins, registers, slopes, points, codes, near, blocks, bases, listed, matrices, ranges, ints,
    reals,
):  # fmt: skip
    """Normals and colors of ``hits`` into ``skins`` (n, 6), as ``skin_kernels.skin`` finds them one by one.

    Hit i is of item ``met[i, 1]``, of a solid, at the point ``met[i, 2:5]``. The hits of an item come to stand in a row
    in the list. ``registers`` (rows, LANES), ``slopes`` (rows, 3, LANES), ``points`` (6, LANES),
    ``codes``, ``near`` and ``listed``, as ``near_gradient_kernels.gradients`` has them, are working memory. In
    ``blocks`` those of the shapes' skeletons stand where ``bases`` tell by shape. Where its row of ``ranges`` is not 0
    a shape's slopes are taken in its own coordinates, in which its tape has less rows: see ``own_tape``; a row of
    ``matrices`` (shapes, 12) leads there.
    """
    start = 0
    while start < len(hits):
        item = met[hits[start], 1]
        n = 0
        for other in range(start, len(hits)):
            if n == LANES:
                break
            i = hits[other]
            if met[i, 1] == item:
                hits[other], hits[start + n] = hits[start + n], i
                for axis in range(3):
                    points[axis, n] = met[i, 2 + axis]
                n += 1
        k = scene.ints[layout.ITEMS + 4 * int(item) + layout.REALS_AT]
        shape = scene.ints[layout.ITEMS + 4 * int(item) + layout.SHAPE]
        base, moved, m = bases[shape], ranges[shape, 1] > 0, matrices[shape]
        code, constants, parts = own_tape(ranges[shape], ints, reals) if moved else tape_of(scene, k)
        places = points[3:] if moved else points[:3]
        for axis in range(3 if moved else 0):
            a, b, c, d = m[4 * axis], m[4 * axis + 1], m[4 * axis + 2], m[4 * axis + 3]
            for j in range(n):
                places[axis, j] = a * points[0, j] + b * points[1, j] + c * points[2, j] + d
        gradients(code, constants, parts, registers, slopes, places, codes, near, blocks, base, listed, n)
        slope = slopes[code.shape[0] - 1]
        for j in range(n if moved else 0):
            u, v, w = slope[0, j], slope[1, j], slope[2, j]
            for axis in range(3):
                slope[axis, j] = m[axis] * u + m[4 + axis] * v + m[8 + axis] * w
        for j in range(n):
            own = skins[hits[start + j]]
            own[0], own[1], own[2] = unit(slope[0, j], slope[1, j], slope[2, j])
            on_face, fx, fy, fz = face_normal(scene.reals, k, points[0, j], points[1, j], points[2, j])
            if on_face:
                own[0], own[1], own[2] = fx, fy, fz
            own[3] = own[4] = own[5] = np.nan
        code, constants, parts = tape_of(scene, k, layout.PAINT)
        last = code.shape[0] - 1
        if last >= 0:
            evaluate(code, constants, parts, registers, points[:3], n)
            for j in range(n):
                for c in range(3):
                    skins[hits[start + j], 3 + c] = registers[last - 2 + c, j]
        start += n
