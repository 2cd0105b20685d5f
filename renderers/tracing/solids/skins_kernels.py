# mypy: ignore-errors
"""Normals and colors of implicit solids at many hits of neighboring rays, in lanes."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.scene_kernels import SCENE
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
    types.int64[::1],
)  # fmt: skip
"""Types of what ``skin_hits`` takes: hits, and memory."""


@lean(types.void(*HITS, *MEMORY))
def skin_hits(scene, hits, met, skins, registers, slopes, points, codes, near, blocks, bases, listed):
    """Normals and colors of ``hits`` into ``skins`` (n, 6), as ``skin_kernels.skin`` finds them one by one.

    Hit i is of item ``met[i, 1]``, of a solid, at the point ``met[i, 2:5]``. The hits of an item come to stand in a row
    in the list. ``registers`` (rows, LANES), ``slopes`` (rows, 3, LANES), ``points`` (3, LANES),
    ``codes``, ``near`` and ``listed``, as ``near_gradient_kernels.gradients`` has them, are working memory. In
    ``blocks`` those of the shapes' skeletons stand where ``bases`` tell by shape.
    """
    start = 0
    while start < len(hits):
        item = met[hits[start], 1]
        n = 0
        for other in range(start, len(hits)):
            i = hits[other]
            if n < LANES and met[i, 1] == item:
                hits[other], hits[start + n] = hits[start + n], i
                for axis in range(3):
                    points[axis, n] = met[i, 2 + axis]
                n += 1
        k = scene.ints[layout.ITEMS + 4 * int(item) + layout.REALS_AT]
        code, constants, parts = tape_of(scene, k)
        base = bases[scene.ints[layout.ITEMS + 4 * int(item) + layout.SHAPE]]
        gradients(code, constants, parts, registers, slopes, points, codes, near, blocks, base, listed, n)
        slope = slopes[code.shape[0] - 1]
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
            evaluate(code, constants, parts, registers, points, n)
            for j in range(n):
                for c in range(3):
                    skins[hits[start + j], 3 + c] = registers[last - 2 + c, j]
        start += n
