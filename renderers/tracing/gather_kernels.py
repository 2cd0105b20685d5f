# mypy: ignore-errors
"""Paths: from a point of the picture from surface to surface to the path's end.

They give the point's records, and the light that needs no filtering.
"""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.light.lamps_kernels import mirrored_lamps
from renderers.tracing.light.light_kernels import backdrop, dielectric, polish, sharpness, sky_radiance, smoothstep
from renderers.tracing.light.shade_kernels import facing_ratio, mean_specular, shade
from renderers.tracing.light.soft_boxes_kernels import soft_boxes
from renderers.tracing.light.through_kernels import CLEAR
from renderers.tracing.light.visibility_kernels import look_around
from renderers.tracing.path_kernels import (
    behind,
    bend,
    beneath,
    beside,
    describe,
    describe_by,
    faded,
    mirrored,
    refracted,
    refracted_spread,
)
from renderers.tracing.record_kernels import IMAGED, ITEM, SURFACE, TINT, TRACED, WEIGHT, copy_record, enough, start_of
from renderers.tracing.record_kernels import RADIUS as BROAD
from renderers.tracing.scene_kernels import ROW as RECORD
from renderers.tracing.scene_kernels import SCENE, SCRATCH, mists_at, part
from renderers.tracing.solids.intersect_kernels import walk
from renderers.tracing.solids.surface_kernels import normal_at
from renderers.tracing.solids.thin_capsules_kernels import coverage
from sceneql.compiled.kernels import kernel

PLACES = types.float64[::1]
BOUNCES = 16
"""Most surfaces that a ray meets behind the first one: a mirror behind three panes of glass, and back through these."""
FAINT = 0.025
"""Weight of a mirrored ray below which the sky's reflection replaces it; from twice that on it counts in full."""
MOST_LINES, AT_A_LINE = 6, 2
"""Most capsules thinner than a pixel that a path goes through; samples of light and sky at each."""
FAINT_LINE = 2.0
"""Of a path that is DARK at such a capsule, in place of 1."""
FAINTLY = -1.0
"""In place of doubt about a root: the path goes through a capsule thinner than a pixel."""
WIDEST = 0.02
"""Spread of a ray's cone, after several mirrors or glass, from which on it sees no lamps: they would be smeared."""
WIDE = 0.32
"""Spread of a ray's cone, after several mirrors, from which on it sees what a rough surface does: the sky, blurred."""
NARROW = 0.5
"""Radius of a cone behind the first surface, by the length of its ray, up to which surfaces are left by some of it."""
QUICK = 8
"""Samples of light and sky on surfaces beyond the second record: seen in a reflection or refraction of another."""
RADIUS, SPREAD, LIGHT_WEIGHT, GATHERED, STRAIGHT, KEEP, BOUNCE, PERSPECTIVE, LIVE, DOUBTED, DARK = (
    6,
    7,
    8,
    11,
    *range(14, 21),
)
"""Offsets in a path, after its ray: the ray's cone, whose radius is below 0 behind a focus; weight and sum of its light
(3 each); whether it was only refracted, so that it sees the backdrop; whether its second record is still to be found;
surfaces so far; whether the camera is a perspective one; whether it goes on; whether a root was undecided; whether its
last surface is still to be lit."""
WAITING, LATER, LATER_WEIGHT, LATER_RADIUS, LATER_SPREAD, LATER_LAMPS, LAMPS, PAST, LINES, SAMPLE, CLEARED, ROW = (
    21,
    22,
    *range(28, 38),
)
"""Glass splits a ray: whether the mirrored one waits, and its begin. Share of the lamps that a ray sees: none unless it
was mirrored, and has met nothing but clear glass since then. Distance up to which a camera's ray is through with thin
capsules, and how many it has met; number of the path's sample in its pixel; distance up to which mists on the ray are
counted; row of its ray in the list."""
KNOWN, HIT_AT, HIT_ITEM, HIT_SKIN, HIT_TURNED, PATH = 38, 39, 40, 41, 47, 50
"""What is known of the next hit: how much, its t, its item, normal and paint (6), the normal beside it. Numbers of a
path."""
MET, DRESSED, BENT = 1.0, 2.0, 3.0
"""Values of KNOWN, beside 0: t and item, normal and paint too, all of it."""


@part
def begin(path, ray, cone):
    """Start a path (PATH,) at the camera by a ``ray`` (6,) and its ``cone``: radius, spread and number in its pixel."""
    for k in range(6):
        path[k] = ray[k]
    path[RADIUS], path[SPREAD], path[SAMPLE] = cone[0], cone[1], cone[2]
    for c in range(3):
        path[LIGHT_WEIGHT + c] = 1.0
        path[GATHERED + c] = 0.0
    path[STRAIGHT], path[KEEP], path[BOUNCE], path[LIVE] = 1.0, 1.0, 0.0, 1.0
    path[PERSPECTIVE] = 1.0 if cone[1] > 0.0 else 0.0
    path[KNOWN] = path[WAITING] = path[DOUBTED] = path[DARK] = path[LAMPS] = path[PAST] = path[LINES] = path[
        CLEARED
    ] = 0.0


@part
def dressed(path):
    """What ``surface_kernels.normal_at`` says of the hit of a path that is DRESSED."""
    nx, ny, nz = path[HIT_SKIN], path[HIT_SKIN + 1], path[HIT_SKIN + 2]
    return nx, ny, nz, nx, ny, nz, 0.0, 0.0, path[HIT_SKIN + 3], path[HIT_SKIN + 4], path[HIT_SKIN + 5]


@part
def turn_of(scene, scratch, path, record):
    """Turn of the normal within a pixel's radius along the ray of a path that has come to a record."""
    x, y, z, nv = beside(record)
    if path[KNOWN] == BENT:
        return bend(record, nv, path[HIT_TURNED], path[HIT_TURNED + 1], path[HIT_TURNED + 2])
    mx, my, mz, _, _, _, _, _, _, _, _ = normal_at(scene, scratch, int(record[ITEM]), x, y, z)
    return bend(record, nv, mx, my, mz)


@kernel(types.void(SCENE, SCRATCH, PLACES, RECORD, RECORD, RECORD), _nrt=False, inner=True)
def advance(scene, scratch, path, first, second, spare):
    """Take a path to the surface that its ray meets, and let it go on from there or end.

    It writes its records: ``first`` is of the surface that the camera sees, ``second`` of the first matte one seen in
    that. One beyond is left in ``spare`` (COLUMNS,), for ``light_behind``; the path is DARK until it is lit.
    """
    ox, oy, oz, dx, dy, dz = path[0], path[1], path[2], path[3], path[4], path[5]
    radius, spread = path[RADIUS], path[SPREAD]
    wr, wg, wb = path[LIGHT_WEIGHT], path[LIGHT_WEIGHT + 1], path[LIGHT_WEIGHT + 2]
    cr, cg, cb = path[GATHERED], path[GATHERED + 1], path[GATHERED + 2]
    straight, perspective, keep = path[STRAIGHT] != 0.0, path[PERSPECTIVE] != 0.0, path[KEEP] != 0.0
    bounce = int(path[BOUNCE])
    counter = scratch.shape[0] - 1
    scratch[counter, 0] = 0.0
    widens = bounce == 0 and scene.ints[layout.HAS_THIN] != 0 and path[LINES] < MOST_LINES
    if widens:
        scratch[counter, layout.WIDE_RADIUS], scratch[counter, layout.WIDE_SPREAD] = radius, spread
    if bounce == 0:
        scratch[counter, layout.WIDE_FROM] = path[PAST]
    if path[KNOWN] != 0.0:
        t, item = path[HIT_AT], int(path[HIT_ITEM])
    else:
        t, item, _ = walk(scene, scratch, ox, oy, oz, dx, dy, dz, 0.0, np.inf, False)
    scratch[counter, layout.TOLD] = scratch[counter, layout.WIDE_FROM] = 0.0
    if widens:
        scratch[counter, layout.WIDE_RADIUS] = scratch[counter, layout.WIDE_SPREAD] = 0.0
    if scene.mist != 0:
        left, r, g, b = mists_at(scene.mist)(scene, ox, oy, oz, dx, dy, dz, path[CLEARED], t, layout.SEEN)
        cr, cg, cb = cr + wr * r, cg + wg * g, cb + wb * b
        wr, wg, wb = left * wr, left * wg, left * wb
        path[LIGHT_WEIGHT], path[LIGHT_WEIGHT + 1], path[LIGHT_WEIGHT + 2] = wr, wg, wb
        path[GATHERED], path[GATHERED + 1], path[GATHERED + 2], path[CLEARED] = cr, cg, cb, t
    if widens:
        if item >= 0:
            share, past = coverage(scene, item, radius, spread, ox, oy, oz, dx, dy, dz)
            if share < 1.0:
                describe(scene, scratch, item, t, ox, oy, oz, dx, dy, dz, radius + spread * t, spare)
                s = int(spare[SURFACE])
                clear = scene.reals[s + layout.TRANSMISSION]
                if clear > 0.0:  # light goes straight through glass so thin
                    clear *= clear * (1.0 - dielectric(facing_ratio(spare), 1.0 / scene.reals[s + layout.INDEX]))
                for c in range(3):
                    spare[WEIGHT + c] = share * path[LIGHT_WEIGHT + c]
                    path[LIGHT_WEIGHT + c] *= 1.0 - share + share * clear * spare[TINT + c]
                path[PAST], path[DARK] = past, FAINT_LINE
                path[LINES] += 1.0
                path[DOUBTED] = 1.0 if scratch[counter, 0] > 0.0 or path[DOUBTED] > 0.0 else FAINTLY
                return
    goes_on = False
    if path[LAMPS] > 0.0:
        r, g, b = mirrored_lamps(scene, ox, oy, oz, dx, dy, dz, radius, spread, t)
        cr, cg, cb = cr + path[LAMPS] * wr * r, cg + path[LAMPS] * wg * g, cb + path[LAMPS] * wb * b
    if item < 0:
        r, g, b = backdrop(scene.reals, dy) if straight else sky_radiance(scene.reals, dy)
        if not straight:
            br, bg, bb = soft_boxes(scene, dx, dy, dz, abs(spread))
            r, g, b = r + br, g + bg, b + bb
        cr, cg, cb = cr + wr * r, cg + wg * g, cb + wb * b
    else:
        radius += spread * t
        x, y, z = ox + t * dx, oy + t * dy, oz + t * dz
        skin = dressed(path) if path[KNOWN] >= DRESSED else normal_at(scene, scratch, item, x, y, z)
        outside = describe_by(scene, item, skin, x, y, z, dx, dy, dz, abs(radius), spare)
        if not outside and scene.reals[int(spare[SURFACE]) + layout.TRANSMISSION] > 0.0:
            under = beneath(scene, scratch, spare)
            if under >= 0:
                item = under
                outside = describe(scene, scratch, item, t, ox, oy, oz, dx, dy, dz, abs(radius), spare)
        if bounce > 0:
            spare[BROAD] = min(spare[BROAD], NARROW * t)
        fade = faded(scene, item, spare) if perspective or bounce > 0 else 1.0
        if fade < 1.0:
            r, g, b = backdrop(scene.reals, max(dy, 0.0)) if straight else sky_radiance(scene.reals, max(dy, 0.0))
            cr, cg, cb = cr + (1.0 - fade) * wr * r, cg + (1.0 - fade) * wg * g, cb + (1.0 - fade) * wb * b
            wr, wg, wb = fade * wr, fade * wg, fade * wb
        spare[WEIGHT], spare[WEIGHT + 1], spare[WEIGHT + 2] = wr, wg, wb
        s = scene.ints[layout.ITEMS + 4 * item + layout.SURFACE_AT]
        clear = scene.reals[s + layout.TRANSMISSION]
        glass = clear > (0.0 if bounce == 0 else CLEAR)
        nv = facing_ratio(spare)
        sr, sg, sb = 0.0, 0.0, 0.0
        traced = turn = lamps = 0.0
        if glass:
            traced = 1.0 if bounce == 0 or not outside else 0.0
        elif bounce < BOUNCES:
            traced = sharpness(scene.reals[s + layout.ROUGHNESS])
            if traced > 0.0:
                turn = turn_of(scene, scratch, path, spare)
                if bounce > 0:
                    traced *= 1.0 - smoothstep(0.5 * WIDE, WIDE, abs(spread) + 2.0 * turn)
                sr, sg, sb = mean_specular(scene.reals, spare, nv)
            traced *= smoothstep(FAINT, 2.0 * FAINT, traced * max(wr * sr, max(wg * sg, wb * sb)))
        spare[TRACED] = traced
        goes_on = (glass or traced > 0.0) and bounce < BOUNCES
        if goes_on:
            if glass:
                turn = turn_of(scene, scratch, path, spare)
            if outside or not glass:
                lamps = polish(scene.reals[s + layout.ROUGHNESS])
            if bounce > 0:
                lamps *= 1.0 - smoothstep(0.5 * WIDEST, WIDEST, abs(spread) + 2.0 * turn)
        spare[IMAGED] = traced * lamps
        if bounce == 0:
            copy_record(spare, first)
        elif keep and not glass and scene.reals[s + layout.METALLIC] < 0.5:
            copy_record(spare, second)
            keep = False
        elif outside or not glass:
            path[DARK] = 1.0
        if goes_on:
            back = 1.0
            if glass:
                ratio = 1.0 / scene.reals[s + layout.INDEX] if outside else scene.reals[s + layout.INDEX]
                back = dielectric(nv, ratio)
                sr, sg, sb = back, back, back
            if back < 1.0 and glass:
                if bounce == 0:
                    path[WAITING] = 1.0
                    path[LATER], path[LATER + 1], path[LATER + 2] = start_of(spare)
                    path[LATER + 3], path[LATER + 4], path[LATER + 5] = mirrored(spare)
                    path[LATER_WEIGHT], path[LATER_RADIUS] = back * wr, radius
                    path[LATER_SPREAD] = spread + 2.0 * turn
                    path[LATER_LAMPS] = lamps
                # Reflections inside are not followed: their light is taken to leave here, though it leaves elsewhere.
                share = clear * (1.0 - back) if outside or bounce == 0 else clear
                wr, wg, wb = share * wr, share * wg, share * wb
                if outside:
                    wr, wg, wb = wr * spare[TINT], wg * spare[TINT + 1], wb * spare[TINT + 2]
                ox, oy, oz = behind(spare)
                dx, dy, dz = refracted(spare, ratio)
                spread = refracted_spread(scene, scratch, spare, ratio, radius, spread)
                path[LAMPS] *= 1.0 - smoothstep(0.5 * WIDEST, WIDEST, abs(spread))
            else:
                straight = False
                path[LAMPS] = lamps
                wr, wg, wb = traced * sr * wr, traced * sg * wg, traced * sb * wb
                ox, oy, oz = start_of(spare)
                dx, dy, dz = mirrored(spare)
                radius, spread = abs(radius), abs(spread) + 2.0 * turn
            bounce += 1
    if scratch[counter, 0] > 0.0:
        path[DOUBTED] = 1.0
    path[GATHERED], path[GATHERED + 1], path[GATHERED + 2] = cr, cg, cb
    if not goes_on:
        if path[WAITING] == 0.0:
            path[LIVE] = 0.0
            return
        path[WAITING], keep, straight, bounce = 0.0, False, False, 1
        for k in range(6):
            path[k] = path[LATER + k]
        wr = wg = wb = path[LATER_WEIGHT]
        radius, spread, path[LAMPS] = path[LATER_RADIUS], path[LATER_SPREAD], path[LATER_LAMPS]
    else:
        path[0], path[1], path[2], path[3], path[4], path[5] = ox, oy, oz, dx, dy, dz
    path[RADIUS], path[SPREAD], path[BOUNCE], path[CLEARED] = radius, spread, bounce, 0.0
    path[LIGHT_WEIGHT], path[LIGHT_WEIGHT + 1], path[LIGHT_WEIGHT + 2] = wr, wg, wb
    path[STRAIGHT], path[KEEP] = (1.0 if straight else 0.0), (1.0 if keep else 0.0)


@part
def light_behind(scene, scratch, asked, ways, path, record, visibility):
    """Add the light of a surface beyond a path's records to what it has GATHERED, by QUICK samples, or fewer at lines.

    Returns False where the sampled rays have no answers yet.
    """
    line = path[DARK] == FAINT_LINE  # each of a pixel's samples lights it by others
    number, some = (int(path[SAMPLE]), AT_A_LINE) if line else (0, enough(record, QUICK))
    if not look_around(scene, scratch, asked, ways, record, number, some, some, visibility):
        return False
    r, g, b = shade(scene, record, visibility)
    path[GATHERED] += r
    path[GATHERED + 1] += g
    path[GATHERED + 2] += b
    return True
