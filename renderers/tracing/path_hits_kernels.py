# mypy: ignore-errors
"""What paths meet next, where packets tell it, so that normals of implicit solids there are found in lanes.

Two of each hit: where the ray ends, and a pixel's radius beside it, by which reflections spread.
"""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.gather_kernels import (
    BENT,
    BOUNCE,
    DRESSED,
    HIT_AT,
    HIT_ITEM,
    HIT_SKIN,
    HIT_TURNED,
    KNOWN,
    LIVE,
    MET,
    NARROW,
    RADIUS,
    ROW,
    SPREAD,
    dressed,
)
from renderers.tracing.light.light_kernels import sharpness
from renderers.tracing.path_kernels import beside, describe_by
from renderers.tracing.record_kernels import RADIUS as BROAD
from renderers.tracing.scene_kernels import ASKED, SCENE, SCRATCH
from renderers.tracing.solids.intersect_kernels import join
from sceneql.compiled.kernels import kernel

_i = types.int64
_rows = types.float32[:, ::1]
_paths = types.float64[:, ::1]
_many = types.int64[::1]


@kernel(_i(SCENE, SCRATCH, ASKED, _paths, _many, _paths), _nrt=False)
def meet_paths(scene, scratch, asked, paths, hits, met):
    """Note what live paths meet, where their rays' rows tell it; those on implicit solids are listed in ``hits``.

    Hit i is of path i, with (t, item, point) in ``met[i]``. Returns their number.
    """
    told_here = asked[0, layout.ALONE] != 0.0 and scene.ints[layout.HAS_THIN] == 0
    n = 0
    for i in range(paths.shape[0]):
        path = paths[i]
        if path[LIVE] == 0.0:
            continue
        if path[KNOWN] == 0.0 and told_here:
            told, t, item, _ = join(scene, scratch, asked, int(path[ROW]), np.inf, False)
            if told:
                path[KNOWN], path[HIT_AT], path[HIT_ITEM] = MET, t, item
        item = int(path[HIT_ITEM])
        if path[KNOWN] != 0.0 and item >= 0 and scene.ints[layout.ITEMS + 4 * item + layout.KIND] == layout.IMPLICIT:
            t = path[HIT_AT]
            met[i, 0], met[i, 1] = t, item
            for axis in range(3):
                met[i, 2 + axis] = path[axis] + t * path[3 + axis]
            hits[n] = i
            n += 1
    return n


@kernel(_i(SCENE, _paths, _many, _paths, _paths, _rows), _nrt=False)
def dress_paths(scene, paths, hits, met, skins, spares):
    """Hand ``skins`` (n, 6) of ``hits`` to their paths; list the points beside them that tell how normals turn there.

    They come into ``met``, their paths to the front of ``hits``; returns their number. ``spares`` (n, COLUMNS) is
    working memory.
    """
    n = 0
    for j in range(len(hits)):
        i = hits[j]
        path, record = paths[i], spares[i]
        for c in range(6):
            path[HIT_SKIN + c] = skins[i, c]
        path[KNOWN] = DRESSED
        item, t, dx, dy, dz = int(path[HIT_ITEM]), path[HIT_AT], path[3], path[4], path[5]
        s = scene.ints[layout.ITEMS + 4 * item + layout.SURFACE_AT]
        glass = scene.reals[s + layout.TRANSMISSION] > 0.0
        if not glass and sharpness(scene.reals[s + layout.ROUGHNESS]) == 0.0:
            continue
        radius = abs(path[RADIUS] + path[SPREAD] * t)
        x, y, z = path[0] + t * dx, path[1] + t * dy, path[2] + t * dz
        outside = describe_by(scene, item, dressed(path), x, y, z, dx, dy, dz, radius, record)
        if glass and not outside:  # perhaps something else lies at its face
            continue
        if path[BOUNCE] > 0.0:
            record[BROAD] = min(record[BROAD], NARROW * t)
        met[i, 2], met[i, 3], met[i, 4], _ = beside(record)
        hits[n] = i
        n += 1
    return n


@kernel(types.void(_paths, _many, _paths), _nrt=False)
def bend_paths(paths, hits, skins):
    """Hand the normals beside hits to their paths."""
    for i in hits:
        path = paths[i]
        for axis in range(3):
            path[HIT_TURNED + axis] = skins[i, axis]
        path[KNOWN] = BENT
