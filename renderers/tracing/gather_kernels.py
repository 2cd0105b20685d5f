# mypy: ignore-errors
"""First stage of a picture: every pixel's records, the light that needs no filtering, and one sample of visibility."""

import numpy as np
from numba import types

from renderers.tracing.camera_kernels import camera_ray
from renderers.tracing.intersect_kernels import walk
from renderers.tracing.light_kernels import backdrop, dielectric, sharpness, sky_radiance, smoothstep
from renderers.tracing.path_kernels import behind, bend, describe, faded, mirrored, refracted
from renderers.tracing.record_kernels import OWNER, TINT, TRACED, WEIGHT, copy_record, erase, start_of
from renderers.tracing.sampling_kernels import sample_of
from renderers.tracing.scene_kernels import (
    INDEX,
    ITEMS,
    METALLIC,
    ROUGHNESS,
    ROW,
    SCENE,
    SCRATCH,
    SHAPE_COUNT,
    SURFACE_AT,
    TOLD,
    TRANSMISSION,
    WIDTH,
)
from renderers.tracing.shade_kernels import facing_ratio, mean_specular, shade
from renderers.tracing.visibility_kernels import look_around
from sceneql.kernels import kernel

_f = types.float64
_i = types.int64
_rows = types.float32[:, ::1]
_stack = types.float32[:, :, ::1]
BOUNCES = 8
"""Surfaces that a ray meets behind the first one, at the most."""
FAINT = 0.025
"""Weight of a mirrored ray below which the sky's reflection stands for what it would meet; above twice that not."""
QUICK = 8
"""Samples of light and sky on surfaces that are seen only in a thing seen in another."""


@kernel(types.UniTuple(_f, 3)(SCENE, SCRATCH, _f, _f, ROW, ROW, ROW, ROW), _nrt=False)
def gather(scene, scratch, px, py, first, second, spare, visibility):
    """Radiance (3) of the picture's point (px, py) but for its records ``first`` and ``second``, which it writes.

    ``first`` is of what the camera sees, ``second`` of the first matte thing seen in that. What is seen behind is lit
    by QUICK samples. ``spare`` (COLUMNS,) and ``visibility`` are working memory.
    """
    ox, oy, oz, dx, dy, dz, radius, spread = camera_ray(scene.reals, px, py)
    perspective = spread > 0.0
    erase(first)
    erase(second)
    wr, wg, wb = 1.0, 1.0, 1.0
    cr, cg, cb = 0.0, 0.0, 0.0
    straight = True  # the ray has only come through things, so that it sees the backdrop
    keep = True  # `second` is still to be found
    waiting = False  # glass is seen by two rays; the mirrored one waits here
    qx, qy, qz, rx, ry, rz, w2, radius2, spread2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    bounce = 0
    while True:
        t, item, _ = walk(scene, scratch, ox, oy, oz, dx, dy, dz, 0.0, np.inf, False)
        scratch[scratch.shape[0] - 1, TOLD] = 0.0
        goes_on = False
        if item < 0:
            r, g, b = backdrop(scene.reals, dy) if straight else sky_radiance(scene.reals, dy)
            cr, cg, cb = cr + wr * r, cg + wg * g, cb + wb * b
        else:
            radius += spread * t
            outside = describe(scene, scratch, item, t, ox, oy, oz, dx, dy, dz, radius, spare)
            fade = faded(scene, item, spare) if perspective or bounce > 0 else 1.0
            if fade < 1.0:
                r, g, b = backdrop(scene.reals, max(dy, 0.0)) if straight else sky_radiance(scene.reals, max(dy, 0.0))
                cr, cg, cb = cr + (1.0 - fade) * wr * r, cg + (1.0 - fade) * wg * g, cb + (1.0 - fade) * wb * b
                wr, wg, wb = fade * wr, fade * wg, fade * wb
            spare[WEIGHT], spare[WEIGHT + 1], spare[WEIGHT + 2] = wr, wg, wb
            s = scene.ints[ITEMS + 4 * item + SURFACE_AT]
            clear = scene.reals[s + TRANSMISSION]
            glass = clear > (0.0 if bounce == 0 else 0.5)
            nv = facing_ratio(spare)
            sr, sg, sb = 0.0, 0.0, 0.0
            traced = 0.0
            if glass:
                traced = 1.0 if bounce == 0 or not outside else 0.0
            elif bounce < BOUNCES:
                traced = sharpness(scene.reals[s + ROUGHNESS])
                if traced > 0.0:
                    sr, sg, sb = mean_specular(scene.reals, spare, nv)
                traced *= smoothstep(FAINT, 2.0 * FAINT, traced * max(wr * sr, max(wg * sg, wb * sb)))
            spare[TRACED] = traced
            if bounce == 0:
                copy_record(spare, first)
            elif keep and not glass and scene.reals[s + METALLIC] < 0.5:
                copy_record(spare, second)
                keep = False
            elif outside or not glass:
                look_around(scene, scratch, spare, 0, QUICK, QUICK, visibility)
                r, g, b = shade(scene, spare, visibility)
                cr, cg, cb = cr + r, cg + g, cb + b
            goes_on = (glass or traced > 0.0) and bounce < BOUNCES
            if goes_on:
                turn = bend(scene, scratch, spare)
                back = 1.0
                if glass:
                    ratio = 1.0 / scene.reals[s + INDEX] if outside else scene.reals[s + INDEX]
                    back = dielectric(nv, ratio)
                    sr, sg, sb = back, back, back
                if back < 1.0 and glass:
                    if bounce == 0:
                        waiting = True
                        qx, qy, qz = start_of(spare)
                        rx, ry, rz = mirrored(spare)
                        w2, radius2, spread2 = back * wr, radius, spread + 2.0 * turn
                    # What is mirrored inside is not followed: it leaves elsewhere, and is taken to leave here.
                    share = clear * (1.0 - back) if outside or bounce == 0 else clear
                    wr, wg, wb = share * wr, share * wg, share * wb
                    if outside:
                        wr, wg, wb = wr * spare[TINT], wg * spare[TINT + 1], wb * spare[TINT + 2]
                    ox, oy, oz = behind(spare)
                    dx, dy, dz = refracted(spare, ratio)
                    spread += turn * abs(1.0 - ratio)
                else:
                    straight = False
                    wr, wg, wb = traced * sr * wr, traced * sg * wg, traced * sb * wb
                    ox, oy, oz = start_of(spare)
                    dx, dy, dz = mirrored(spare)
                    spread += 2.0 * turn
                bounce += 1
        if not goes_on:
            if not waiting:
                return cr, cg, cb
            waiting, keep, straight, bounce = False, False, False, 1
            ox, oy, oz, dx, dy, dz = qx, qy, qz, rx, ry, rz
            wr, wg, wb, radius, spread = w2, w2, w2, radius2, spread2


@kernel(_i(SCENE, SCRATCH, _i, _i, _stack, _rows, _stack, ROW, _i[::1], _f[:, ::1]), _nrt=False)
def gather_rows(scene, scratch, start, stop, records, radiance, visibility, spare, shapes, roots):
    """Fill rows start..stop of a picture (h, w): records (2, h w, COLUMNS), radiance (h w, 3), visibility (2, h w, V).

    Returns the number of pixels with an undecided root. Radiance holds what needs no visibility. ``roots`` (k, n), by
    pixel of these rows, are where the camera's rays first meet implicit ``shapes`` (k,), NaN where that is not told.
    """
    width = int(scene.reals[WIDTH])
    counter = scratch.shape[0] - 1
    undecided = 0
    for row in range(counter - scene.ints[SHAPE_COUNT], counter):
        scratch[row, 0] = np.nan
    for y in range(start, stop):
        for x in range(width):
            k = y * width + x
            number = sample_of(x, y)
            scratch[counter, 0] = 0.0
            for m in range(len(shapes)):
                scratch[counter, TOLD] = 1.0
                scratch[counter - 1 - shapes[m], 0] = roots[m, k - start * width]
            r, g, b = gather(scene, scratch, x + 0.5, y + 0.5, records[0, k], records[1, k], spare, visibility[0, k])
            undecided += scratch[counter, 0] > 0.0
            radiance[k, 0], radiance[k, 1], radiance[k, 2] = r, g, b
            for layer in range(2):
                if records[layer, k, OWNER] > 0.0:
                    look_around(scene, scratch, records[layer, k], number, 1, 1, visibility[layer, k])
    return undecided
