# mypy: ignore-errors
"""Light that surfaces reflect to what hides the sky: followed from surface to surface, one at a time or in waves.

A way is a row of numbers, from the surface that a sample of the sky has met. Waves of them list the rays of a step
first, so that packets can intersect them.
"""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.certified import BOUNCES
from renderers.tracing.light.embers_kernels import ROUGHLY, ember_seen, met, sum_up
from renderers.tracing.light.light_kernels import sky_ambient, sky_radiance
from renderers.tracing.light.lights_kernels import in_a_lamp, light_at, reach
from renderers.tracing.light.sampling_kernels import NEXT_DISK, SKY_COUNT, across
from renderers.tracing.light.through_kernels import CLEAR, clearness, go_through
from renderers.tracing.scene_kernels import ASKED, SCENE, SCRATCH, mists_at, part
from renderers.tracing.solids.intersect_kernels import ask
from renderers.tracing.solids.surface_kernels import color_at, normal_at, skin_of
from sceneql.compiled.kernels import kernel

_i = types.int64
WAYS = types.float64[:, ::1]
AT, TOWARD, ITEM, RADIUS, SAMPLE, NUMBER, SHARE, WEIGHT, LIGHT, SKIN = 0, 3, 6, 7, 8, 9, 10, 11, 14, 17
OPEN_SKY, THROUGH, LIVE, COUNT, WAY = 28, 31, 37, 38, 39
"""Columns: the point that it has come to and the direction in which; the item there; radius of the ray's cone; number
of the sample, and of surfaces before; share of the item's emission that counts, if it is a small sphere; weight and sum
of the light (3 each); what ``normal_at`` says of the point (11). Radiance of the sky in the sample's direction, which
becomes what is lost of it; share (3) and radiance (3) of glass before the first surface; whether it goes on; in the
first way of a row of visibility how many it has. Their number."""
BRIGHTEST = 4.0
"""Limit of the radiance of surfaces that hide the sky: small spots near a lamp, hit by few samples, left blotches."""
BRIGHTEST_AGAIN = 1.0
"""The same of lamps' light on surfaces seen from these, of which samples tell even less."""
AGAIN = 1 / 64
"""Share of the sky that the last of SURFACES is assumed to see: little, since none before it has led out."""
SURFACES, LEAST = BOUNCES, 0.02
"""Most surfaces beside the lit one that light from around is followed to, and its share of what the last of them
gives below which it is followed no further: in closed rooms the sky is far, and in white corners."""
BLURRED = 2
"""Of these those behind which the cone of a way widens: it tells how far from a surface the way goes on too."""
FACTOR, STEP = 55, 67
"""Of the orders of ``shuffled``."""


@part
def shuffled(sample, number):
    """A sample's number in another order of the net for each surface that its light has met; 0 leaves it."""
    return (sample * (2 * FACTOR * number + 1) + number * (number + 1) // 2 * STEP) % SKY_COUNT


@part
def set_out(scene, way, item, x, y, z, dx, dy, dz, radius, sample, share):
    """Begin a way at a surface that hides the sky; ``share`` of the emission counts, if the item is a small sphere."""
    way[AT], way[AT + 1], way[AT + 2] = x, y, z
    way[TOWARD], way[TOWARD + 1], way[TOWARD + 2] = dx, dy, dz
    way[ITEM], way[RADIUS], way[SAMPLE], way[NUMBER], way[SHARE], way[LIVE] = item, radius, sample, 0.0, share, 1.0
    for c in range(3):
        way[WEIGHT + c] = 1.0
        way[LIGHT + c] = 0.0


@part
def dress(way, skin):
    """Keep what ``normal_at`` says of the point that a way has come to."""
    for c in range(11):
        way[SKIN + c] = skin[c]


@part
def step(scene, scratch, asked, way):
    """Follow a way from its surface to the next one, in the mode of ``asked``; it is not LIVE when it has ended.

    Light goes on in one direction from each surface, and those beyond the first are lit by one lamp in place of all.
    Surfaces behind as many as the scene has BOUNCES send what they emit alone.
    After SURFACES, all of them bright, the last sees a little of the sky between neighbors as bright as the first, so
    that nothing is lost in white corners and closed rooms. In ASKING the rays are listed alone.
    """
    u = scene.reals
    x, y, z, dx, dy, dz = way[AT], way[AT + 1], way[AT + 2], way[TOWARD], way[TOWARD + 1], way[TOWARD + 2]
    item, radius, sample, number = int(way[ITEM]), way[RADIUS], int(way[SAMPLE]), int(way[NUMBER])
    wr, wg, wb = way[WEIGHT], way[WEIGHT + 1], way[WEIGHT + 2]
    nx, ny, nz, fx, fy, fz = way[SKIN], way[SKIN + 1], way[SKIN + 2], way[SKIN + 3], way[SKIN + 4], way[SKIN + 5]
    lift = way[SKIN + 6]
    asking = asked[0, layout.MODE] == layout.ASKING
    if dx * fx + dy * fy + dz * fz > 0.0:
        nx, ny, nz, fx, fy, fz, lift = -nx, -ny, -nz, -fx, -fy, -fz, way[SKIN + 7]
    s = scene.ints[layout.ITEMS + 4 * item + layout.SURFACE_AT] + layout.EMISSION
    if not asking and max(u[s], max(u[s + 1], u[s + 2])) > 0.0 and not in_a_lamp(scene, x, y, z):
        hr, hg, hb = way[SHARE] * u[s], way[SHARE] * u[s + 1], way[SHARE] * u[s + 2]
        way[LIGHT], way[LIGHT + 1], way[LIGHT + 2] = (
            way[LIGHT] + wr * hr,
            way[LIGHT + 1] + wg * hg,
            way[LIGHT + 2] + wb * hb,
        )
    if number >= scene.ints[layout.BOUNCES]:
        way[LIVE] = way[LIVE] if asking else 0.0
        return
    paint = way[SKIN + 8], way[SKIN + 9], way[SKIN + 10]
    r, g, b = color_at(scene, item, paint, x, y, z, nx, ny, nz, dx, dy, dz, radius)
    wr, wg, wb = wr * r, wg * g, wb * b
    if max(wr, max(wg, wb)) < LEAST:
        way[LIVE] = way[LIVE] if asking else 0.0
        return
    off = 0.05 * radius + 1e-6 * (abs(x) + abs(y) + abs(z)) + lift
    sx, sy, sz = x + off * fx, y + off * fy, z + off * fz
    er, eg, eb = 0.0, 0.0, 0.0
    lights = int(scene.ints[layout.LIGHT_COUNT])
    for l in range(lights if number == 0 else min(lights, 1)):
        of = 1.0
        if number > 0:  # one for all
            l, of = (sample + number) % lights, float(lights)
        lx, ly, lz, far, ir, ig, ib = light_at(u, l, sx, sy, sz)
        cosine = of * (nx * lx + ny * ly + nz * lz)
        if cosine > 0.0 and fx * lx + fy * ly + fz * lz > 0.0:
            if far < np.inf:
                far = reach(far, u[layout.LIGHTS + layout.LIGHT * l + 7], 1.0)
            _, _, share = ask(scene, scratch, asked, sx, sy, sz, lx, ly, lz, far, True)
            if scene.mist != 0 and not asking:
                share *= mists_at(scene.mist)(scene, sx, sy, sz, lx, ly, lz, 0.0, far, layout.LEFT)[0]
            cosine *= share / np.pi
            er, eg, eb = er + cosine * ir, eg + cosine * ig, eb + cosine * ib
    if scene.ints[layout.EMBERS] > 0 and not asking:
        ir, ig, ib, total, _, _ = sum_up(scene, x, y, z, nx, ny, nz, ROUGHLY, 0, 0.0, np.inf)
        if total > 0.0:
            until = (shuffled(sample, number + 1) + 0.5) / SKY_COUNT * total
            _, _, _, _, node, rest = sum_up(scene, x, y, z, nx, ny, nz, ROUGHLY, 0, 0.0, until)
            share = ember_seen(scene, scratch, sx, sy, sz, node, rest)
            er, eg, eb = er + share * ir, eg + share * ig, eb + share * ib
    if number > 0:
        share = min(1.0, BRIGHTEST_AGAIN / max(max(er, eg), max(eb, BRIGHTEST_AGAIN)))
        er, eg, eb = share * er, share * eg, share * eb
    vr, vg, vb = 1.0, 1.0, 1.0  # what comes through glass on the way on
    ended = number == SURFACES - 1
    if ended:
        hr, hg, hb = sky_ambient(u, ny)
        er, eg, eb = er + AGAIN * hr, eg + AGAIN * hg, eb + AGAIN * hb
    else:
        ax, ay, az, bx, by, bz = across(nx, ny, nz)
        v, w = NEXT_DISK[shuffled(sample, number), 0], NEXT_DISK[shuffled(sample, number), 1]
        up = np.sqrt(max(1.0 - v * v - w * w, 0.0))
        dx, dy, dz = v * ax + w * bx + up * nx, v * ay + w * by + up * ny, v * az + w * bz + up * nz
        t, item, _ = ask(scene, scratch, asked, sx, sy, sz, dx, dy, dz, np.inf, False)
        if asking:
            return
        if item >= 0 and clearness(scene, item) > CLEAR:
            t, item, glass = go_through(scene, scratch, sx, sy, sz, dx, dy, dz, t, radius, item)
            er, eg, eb = er + glass[3], eg + glass[4], eb + glass[5]
            vr, vg, vb = glass[0], glass[1], glass[2]
        ended = item < 0
        if ended:
            hr, hg, hb = sky_radiance(u, dy)
            er, eg, eb = er + vr * hr, eg + vg * hg, eb + vb * hb
        else:
            way[SHARE] = met(scene, item, sx, sy, sz)
            way[AT], way[AT + 1], way[AT + 2] = sx + t * dx, sy + t * dy, sz + t * dz
            if number < BLURRED:
                way[RADIUS] = radius + 0.05 * t
    if asking:
        return
    way[LIGHT], way[LIGHT + 1], way[LIGHT + 2] = (
        way[LIGHT] + wr * er,
        way[LIGHT + 1] + wg * eg,
        way[LIGHT + 2] + wb * eb,
    )
    if number == SURFACES - 1:
        for c in range(3):
            way[LIGHT + c] /= 1.0 - (1.0 - AGAIN) * min((wr, wg, wb)[c], 1.0)
    way[WEIGHT], way[WEIGHT + 1], way[WEIGHT + 2] = wr * vr, wg * vg, wb * vb
    way[TOWARD], way[TOWARD + 1], way[TOWARD + 2], way[ITEM], way[NUMBER] = dx, dy, dz, item, number + 1
    way[LIVE] = 0.0 if ended else 1.0


@part
def lost(way):
    """The sky's radiance (3) less that of the way, which has ended, and of glass before it."""
    r, g, b = way[LIGHT], way[LIGHT + 1], way[LIGHT + 2]
    share = min(1.0, BRIGHTEST / max(max(r, g), max(b, BRIGHTEST)))
    r, g, b = share * r, share * g, share * b
    if way[THROUGH] == way[THROUGH]:
        r, g, b = (
            way[THROUGH + 3] + way[THROUGH] * r,
            way[THROUGH + 4] + way[THROUGH + 1] * g,
            way[THROUGH + 5] + way[THROUGH + 2] * b,
        )
    return way[OPEN_SKY] - r, way[OPEN_SKY + 1] - g, way[OPEN_SKY + 2] - b


@kernel(types.void(SCENE, SCRATCH, ASKED, types.float64[::1]), _nrt=False, inner=True)
def follow(scene, scratch, asked, way):
    """Follow a way to its end, in the mode PLAIN."""
    while way[LIVE] != 0.0:
        dress(way, normal_at(scene, scratch, int(way[ITEM]), way[AT], way[AT + 1], way[AT + 2]))
        step(scene, scratch, asked, way)


@kernel(types.void(SCENE, SCRATCH, ASKED, WAYS, types.int64[::1]), _nrt=False)
def follow_all(scene, scratch, asked, ways, live):
    """``follow`` the ways ``live``."""
    for i in live:
        follow(scene, scratch, asked, ways[i])


@kernel(types.UniTuple(_i, 2)(SCENE, SCRATCH, WAYS, types.int64[::1], _i, types.int64[::1], WAYS), _nrt=False)
def look_about(scene, scratch, ways, live, count, hits, met):
    """Drop the ways that have ended from the first ``count`` of the list ``live``, and find normals where others stand.

    Where they stand on implicit solids, they are listed in ``hits``, with their items and points in ``met``. Returns
    the numbers of ways that are left and of hits.
    """
    left = listed = 0
    for j in range(count):
        i = live[j]
        way = ways[i]
        if way[LIVE] == 0.0:
            continue
        live[left] = i
        left += 1
        item = int(way[ITEM])
        if scene.ints[layout.ITEMS + 4 * item + layout.KIND] == layout.IMPLICIT:
            hits[listed] = i
            listed += 1
            met[i, 1], met[i, 2], met[i, 3], met[i, 4] = item, way[AT], way[AT + 1], way[AT + 2]
        else:
            dress(way, skin_of(scene, scratch, item, way[AT], way[AT + 1], way[AT + 2]))
    return left, listed


@kernel(types.void(WAYS, types.int64[::1], WAYS), _nrt=False)
def dress_hits(ways, hits, skins):
    """Write normals and colors of solids, as ``skins_kernels.skin_hits`` finds them, to the ways ``hits``."""
    for i in hits:
        nx, ny, nz = skins[i, 0], skins[i, 1], skins[i, 2]
        dress(ways[i], (nx, ny, nz, nx, ny, nz, 0.0, 0.0, skins[i, 3], skins[i, 4], skins[i, 5]))


@kernel(_i(SCENE, SCRATCH, ASKED, WAYS, types.int64[::1], _i, _i), _nrt=False)
def step_all(scene, scratch, asked, ways, live, first, last):
    """``step`` for the ways ``live[first:last]``; stops where ``asked`` has no room for more, and returns where."""
    room = asked.shape[0] - 1 - scene.ints[layout.LIGHT_COUNT]
    for j in range(first, last):
        if asked[0, layout.MODE] == layout.ASKING and asked[0, layout.NEXT] > room:
            return j
        step(scene, scratch, asked, ways[live[j]])
    return last
