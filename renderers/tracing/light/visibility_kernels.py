# mypy: ignore-errors
"""Visibility of the lights and of the sky from a record."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.light.embers_kernels import NEARLY, ROUGHLY, ember_seen, met, sum_up
from renderers.tracing.light.light_kernels import sky_ambient, sky_radiance
from renderers.tracing.light.sampling_kernels import COUNT, DISK, JITTER, NEXT_DISK, SKY_COUNT, SKY_DISK, across
from renderers.tracing.light.through_kernels import CLEAR, clearness, go_through
from renderers.tracing.record_kernels import NORMAL, PLACE, RADIUS, SURFACE, TINT, start_of
from renderers.tracing.scene_kernels import ASKED, ROW, SCENE, SCRATCH, part
from renderers.tracing.solids.intersect_kernels import ask, walk
from renderers.tracing.solids.surface_kernels import color_at, normal_at
from sceneql.compiled.kernels import kernel

_i = types.int64
SKY = 0
"""First of three columns of visibility: mean radiance of the open sky less the incoming one (RGB)."""
FIRST_LIGHT = 3
"""Then two columns for each light: the visible share of it, and the width [m] of the penumbra here."""
BARELY = 1e-6
"""Part of its length by which a ray to a lamp ends before its ball, so that a sphere of the same radius is not hit."""
BRIGHTEST = 4.0
"""Limit of the radiance of surfaces that hide the sky: small spots near a lamp, hit by few samples, left blotches."""
BRIGHTEST_AGAIN = 1.0
"""The same of lamps' light on surfaces seen from these, of which samples tell even less."""
SHOWN = 1e-3
"""Part of a lamp's radius by which a ball that shows it may be larger."""
AGAIN = 0.25
"""Share of the sky that the last of SURFACES on the way of light from there is assumed to see."""
SURFACES, LEAST = 64, 0.02
"""Most surfaces beside the lit one that light from around is followed to, and its share of what the last of them
gives below which it is followed no further: in closed rooms the sky is far, and in white corners."""
BLURRED = 2
"""Of these those behind which the cone of a way widens: it tells how far from a surface the way goes on too."""
EMBERS = 3
"""Least samples of the shadows of small spheres that glow, since the sum of their light is known without."""
FACTOR, STEP = 55, 67
"""Of the orders of ``shuffled``."""


@part
def light_at(reals, l, x, y, z):
    """(direction, distance, irradiance per channel of a surface facing it) of light l from a point."""
    k = layout.LIGHTS + layout.LIGHT * l
    ir, ig, ib = reals[k + 4], reals[k + 5], reals[k + 6]
    if reals[k] == layout.SUN:
        return reals[k + 1], reals[k + 2], reals[k + 3], np.inf, ir, ig, ib
    dx, dy, dz = reals[k + 1] - x, reals[k + 2] - y, reals[k + 3] - z
    d2 = max(dx * dx + dy * dy + dz * dz, 1e-12)
    d = np.sqrt(d2)
    return dx / d, dy / d, dz / d, d, ir / d2, ig / d2, ib / d2


@part
def reach(far, radius, square):
    """Parameter at which a ray enters a lamp's ball, of squared direction ``square`` and component 1 along ``far``.

    ``far`` is the distance of the ball's center, in the plane of the disk that the ray goes to. Objects in the ball,
    such as a sphere that shows the lamp, throw no shadow in its light.
    """
    inside = max(square * radius * radius - (square - 1.0) * far * far, 0.0)
    return max((1.0 - BARELY) * (far - np.sqrt(inside)) / square, 0.0)


@part
def seen(scene, scratch, asked, l, x, y, z, disk_x, disk_y):
    """(share, distance of the blocker) of the point (disk_x, disk_y) of light l's disk from a place."""
    dx, dy, dz, far, _, _, _ = light_at(scene.reals, l, x, y, z)
    ax, ay, az, bx, by, bz = across(dx, dy, dz)
    size = scene.reals[layout.LIGHTS + layout.LIGHT * l + 8]
    if far < np.inf:
        size = min(size / far, 1.0)
    u, v = size * disk_x, size * disk_y
    dx, dy, dz = dx + u * ax + v * bx, dy + u * ay + v * by, dz + u * az + v * bz
    if far == np.inf:
        length = np.sqrt(dx * dx + dy * dy + dz * dz)
        dx, dy, dz = dx / length, dy / length, dz / length
    else:
        far = reach(far, scene.reals[layout.LIGHTS + layout.LIGHT * l + 7], 1.0 + u * u + v * v)
    blocker, _, share = ask(scene, scratch, asked, x, y, z, dx, dy, dz, far, True)
    return share, blocker


@part
def shadow_width(scene, l, x, y, z, blocker):
    """Width [m] of the penumbra that an edge at distance ``blocker`` throws on a surface facing light l."""
    _, _, _, far, _, _, _ = light_at(scene.reals, l, x, y, z)
    if far == np.inf:
        return scene.reals[layout.LIGHTS + layout.LIGHT * l + 7] * blocker
    return 2.0 * scene.reals[layout.LIGHTS + layout.LIGHT * l + 7] * blocker / max(far - blocker, 1e-3 * far)


@part
def in_a_lamp(scene, x, y, z):
    """Whether a place is on what shows a lamp: a ball where that stands, as large, whose light counts as the lamp's."""
    for l in range(int(scene.ints[layout.LIGHT_COUNT])):
        _, _, _, far, _, _, _ = light_at(scene.reals, l, x, y, z)
        if far < (1.0 + SHOWN) * scene.reals[layout.LIGHTS + layout.LIGHT * l + 7]:
            return True
    return False


@part
def shuffled(sample, number):
    """A sample's number in another order of the net for each surface that its light has met; 0 leaves it."""
    return (sample * (2 * FACTOR * number + 1) + number * (number + 1) // 2 * STEP) % SKY_COUNT


@part
def bounced(scene, scratch, item, x, y, z, dx, dy, dz, radius, sample, told):
    """Radiance (3) of a surface that hides the sky: its emission, and light reflected by it and others, as if matte.

    Light goes on in one direction from each, and those beyond the first are lit by one lamp in place of all. After
    SURFACES, all of them bright, the last sees a part of the sky between neighbors as bright as itself, so that nothing
    is lost in white corners. ``told`` is the share of the emission that counts, if the item is a small sphere.
    """
    u = scene.reals
    red, green, blue = 0.0, 0.0, 0.0
    wr, wg, wb = 1.0, 1.0, 1.0
    for number in range(SURFACES):
        nx, ny, nz, fx, fy, fz, lift, sink, pr, pg, pb = normal_at(scene, scratch, item, x, y, z)
        if dx * fx + dy * fy + dz * fz > 0.0:
            nx, ny, nz, fx, fy, fz, lift = -nx, -ny, -nz, -fx, -fy, -fz, sink
        s = scene.ints[layout.ITEMS + 4 * item + layout.SURFACE_AT] + layout.EMISSION
        if max(u[s], max(u[s + 1], u[s + 2])) > 0.0 and not in_a_lamp(scene, x, y, z):
            hr, hg, hb = told * u[s], told * u[s + 1], told * u[s + 2]
            red, green, blue = red + wr * hr, green + wg * hg, blue + wb * hb
        r, g, b = color_at(scene, item, (pr, pg, pb), x, y, z, nx, ny, nz, dx, dy, dz, radius)
        wr, wg, wb = wr * r, wg * g, wb * b
        if max(wr, max(wg, wb)) < LEAST:
            break
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
                _, _, share = walk(scene, scratch, sx, sy, sz, lx, ly, lz, 0.0, far, True)
                cosine *= share / np.pi
                er, eg, eb = er + cosine * ir, eg + cosine * ig, eb + cosine * ib
        if scene.ints[layout.EMBERS] > 0:
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
            hr, hg, hb = AGAIN * hr, AGAIN * hg, AGAIN * hb
            er += hr / (1.0 - (1.0 - AGAIN) * min(r, 1.0))
            eg += hg / (1.0 - (1.0 - AGAIN) * min(g, 1.0))
            eb += hb / (1.0 - (1.0 - AGAIN) * min(b, 1.0))
        else:
            ax, ay, az, bx, by, bz = across(nx, ny, nz)
            v, w = NEXT_DISK[shuffled(sample, number), 0], NEXT_DISK[shuffled(sample, number), 1]
            up = np.sqrt(max(1.0 - v * v - w * w, 0.0))
            dx, dy, dz = v * ax + w * bx + up * nx, v * ay + w * by + up * ny, v * az + w * bz + up * nz
            t, item, _ = walk(scene, scratch, sx, sy, sz, dx, dy, dz, 0.0, np.inf, False)
            if item >= 0 and clearness(scene, item) > CLEAR:
                t, item, way = go_through(scene, scratch, sx, sy, sz, dx, dy, dz, t, radius, item)
                er, eg, eb = er + way[3], eg + way[4], eb + way[5]
                vr, vg, vb = way[0], way[1], way[2]
            ended = item < 0
            if ended:
                hr, hg, hb = sky_radiance(u, dy)
                er, eg, eb = er + vr * hr, eg + vg * hg, eb + vb * hb
            else:
                told = met(scene, item, sx, sy, sz)
                x, y, z = sx + t * dx, sy + t * dy, sz + t * dz
                if number < BLURRED:
                    radius += 0.05 * t
        red, green, blue = red + wr * er, green + wg * eg, blue + wb * eb
        if ended:
            break
        wr, wg, wb = wr * vr, wg * vg, wb * vb
    share = min(1.0, BRIGHTEST / max(max(red, green), max(blue, BRIGHTEST)))
    return share * red, share * green, share * blue


@part
def sky_loss(scene, scratch, asked, record, sample):
    """The sky's radiance (3) less the incoming one in the direction of a sample, cosine-distributed.

    Where there is no sky that is what surfaces around reflect, less than zero.
    """
    nx, ny, nz = float(record[NORMAL]), float(record[NORMAL + 1]), float(record[NORMAL + 2])
    ax, ay, az, bx, by, bz = across(nx, ny, nz)
    u, v = SKY_DISK[sample, 0], SKY_DISK[sample, 1]
    w = np.sqrt(max(1.0 - u * u - v * v, 0.0))
    dx, dy, dz = u * ax + v * bx + w * nx, u * ay + v * by + w * ny, u * az + v * bz + w * nz
    x, y, z = start_of(record)
    t, item, _ = ask(scene, scratch, asked, x, y, z, dx, dy, dz, np.inf, False)
    if item < 0:
        return 0.0, 0.0, 0.0
    if asked[0, layout.MODE] == layout.ASKING:  # found when rays have answers
        asked[0, layout.OPEN] = 1.0
        return 0.0, 0.0, 0.0
    radius = record[RADIUS] + 0.05 * t
    hr, hg, hb = sky_radiance(scene.reals, dy)
    glass = clearness(scene, item) > CLEAR
    way = 1.0, 1.0, 1.0, 0.0, 0.0, 0.0
    if glass:
        t, item, way = go_through(scene, scratch, x, y, z, dx, dy, dz, t, radius, item)
    r, g, b = hr, hg, hb
    if item >= 0:
        told = met(scene, item, x, y, z)
        r, g, b = bounced(scene, scratch, item, x + t * dx, y + t * dy, z + t * dz, dx, dy, dz, radius, sample, told)
    if glass:
        r, g, b = way[3] + way[0] * r, way[4] + way[1] * g, way[5] + way[2] * b
    return hr - r, hg - g, hb - b


@part
def by_embers(scene, scratch, asked, record, number, samples, visibility):
    """Add the light of small spheres that glow, their shadows by as many samples at least, to a row of visibility."""
    x, y, z = float(record[PLACE]), float(record[PLACE + 1]), float(record[PLACE + 2])
    nx, ny, nz = float(record[NORMAL]), float(record[NORMAL + 1]), float(record[NORMAL + 2])
    tint = max(record[TINT], max(record[TINT + 1], record[TINT + 2]))
    if tint <= 0.0 and scene.reals[int(record[SURFACE]) + layout.SPECULAR] == 0.0:
        return
    if asked[0, layout.MODE] == layout.ASKING:  # found when rays have answers
        asked[0, layout.OPEN] = 1.0
        return
    r, g, b, total, _, _ = sum_up(scene, x, y, z, nx, ny, nz, NEARLY, 0, 0.0, np.inf)
    if total == 0.0:
        return
    sx, sy, sz = start_of(record)
    share, done, node, some = 0.0, 0.0, 0, max(samples, EMBERS)
    for k in range(some):
        until = (k + (number % SKY_COUNT + 0.5) / SKY_COUNT) / some * total
        _, _, _, done, node, rest = sum_up(scene, x, y, z, nx, ny, nz, NEARLY, node, done, until)
        share += ember_seen(scene, scratch, sx, sy, sz, node, rest) / some
    visibility[SKY] -= share * r
    visibility[SKY + 1] -= share * g
    visibility[SKY + 2] -= share * b


@part
def facing(scene, record, l):
    """Whether some of light l may reach the front of a record."""
    x, y, z = float(record[PLACE]), float(record[PLACE + 1]), float(record[PLACE + 2])
    dx, dy, dz, _, _, _, _ = light_at(scene.reals, l, x, y, z)
    return record[NORMAL] * dx + record[NORMAL + 1] * dy + record[NORMAL + 2] * dz > 0.0


@part
def shadow_sample(scene, scratch, asked, record, l, sample, jitter):
    """(share, width of the penumbra) of light l for one sample, from a point up to ``jitter`` pixels off.

    A surface that faces away counts as lit: shading darkens it, and the filter must see no edge of shadow there.
    """
    if not facing(scene, record, l):
        return 1.0, 0.0
    x, y, z = start_of(record)
    ax, ay, az, bx, by, bz = across(float(record[NORMAL]), float(record[NORMAL + 1]), float(record[NORMAL + 2]))
    u, v = 2.0 * jitter * record[RADIUS] * JITTER[sample, 0], 2.0 * jitter * record[RADIUS] * JITTER[sample, 1]
    x, y, z = x + u * ax + v * bx, y + u * ay + v * by, z + u * az + v * bz
    share, blocker = seen(scene, scratch, asked, l, x, y, z, DISK[sample, 0], DISK[sample, 1])
    width = shadow_width(scene, l, x, y, z, blocker) if blocker < np.inf else 0.0
    return share, width


@kernel(types.boolean(SCENE, SCRATCH, ASKED, ROW, _i, _i, _i, ROW), _nrt=False, inner=True)
def look_around(scene, scratch, asked, record, number, of_sky, of_lights, visibility):
    """Fill a row of visibility with the means of so many samples of nets (powers of two), those of pixel ``number``.

    Several samples cover the pixel's area, one is at its center. Returns whether the row has just become final: in the
    mode ASKING a row without open rays is so at once, and stays in TELLING; others are NaN until then.
    """
    mode, begin = asked[0, layout.MODE], asked[0, layout.NEXT]
    if mode == layout.TELLING and visibility[0] == visibility[0]:
        return False
    asked[0, layout.OPEN] = 0.0
    for column in range(FIRST_LIGHT + 2 * scene.ints[layout.LIGHT_COUNT]):
        visibility[column] = 0.0
    if scene.reals[layout.HAS_LIGHT] != 0.0:
        for k in range(of_sky):
            r, g, b = sky_loss(scene, scratch, asked, record, (number * of_sky + k) % SKY_COUNT)
            visibility[SKY] += r / of_sky
            visibility[SKY + 1] += g / of_sky
            visibility[SKY + 2] += b / of_sky
        if scene.ints[layout.EMBERS] > 0:
            by_embers(scene, scratch, asked, record, number, of_sky, visibility)
    jitter = 0.0 if of_lights == 1 else 1.0
    for l in range(int(scene.ints[layout.LIGHT_COUNT])):
        column = FIRST_LIGHT + 2 * l
        for k in range(of_lights):
            share, width = shadow_sample(scene, scratch, asked, record, l, (number * of_lights + k) % COUNT, jitter)
            visibility[column] += share / of_lights
            visibility[column + 1] = max(visibility[column + 1], width)
    if mode != layout.ASKING:
        return True
    if asked[0, layout.OPEN] == 0.0 and visibility[0] == visibility[0]:
        asked[0, layout.NEXT] = begin
        return True
    visibility[0] = np.nan
    return False
