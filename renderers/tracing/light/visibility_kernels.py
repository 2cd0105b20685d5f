# mypy: ignore-errors
"""Visibility of the lights and of the sky from a record."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.light.bounce_kernels import COUNT as COUNT_OF_ROW
from renderers.tracing.light.bounce_kernels import LIGHT, LIVE, OPEN_SKY, THROUGH, WAYS, follow, lost, set_out
from renderers.tracing.light.embers_kernels import NEARLY, ember_seen, met, sum_up
from renderers.tracing.light.light_kernels import sky_radiance
from renderers.tracing.light.lights_kernels import light_at, reach
from renderers.tracing.light.sampling_kernels import COUNT, DISK, JITTER, SKY_COUNT, SKY_DISK, across
from renderers.tracing.light.through_kernels import CLEAR, clearness, go_through
from renderers.tracing.record_kernels import NORMAL, PLACE, RADIUS, SURFACE, TINT, start_of
from renderers.tracing.scene_kernels import ASKED, ROW, SCENE, SCRATCH, mists_at, part
from renderers.tracing.solids.intersect_kernels import answer, seek
from sceneql.compiled.kernels import kernel

_i = types.int64
SKY = 0
"""First of three columns of visibility: mean radiance of the open sky less the incoming one (RGB)."""
FIRST_LIGHT = 3
"""Then two columns for each light: the visible share of it, and the width [m] of the penumbra here. Where there are
mists, one more for each light behind these: the share of it that mists leave."""
AWAITED = np.inf
"""First number of a row of visibility that lacks the light of its ways."""
EMBERS = 3
"""Least samples of the shadows of small spheres that glow, since the sum of their light is known without."""


@part
def toward(scene, l, x, y, z, disk_x, disk_y):
    """(direction, where along it to end) of a ray from a place to the point (disk_x, disk_y) of light l's disk."""
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
    return dx, dy, dz, far


@part
def shadow_width(scene, l, x, y, z, blocker):
    """Width [m] of the penumbra that an edge at distance ``blocker`` throws on a surface facing light l."""
    _, _, _, far, _, _, _ = light_at(scene.reals, l, x, y, z)
    if far == np.inf:
        return scene.reals[layout.LIGHTS + layout.LIGHT * l + 7] * blocker
    return 2.0 * scene.reals[layout.LIGHTS + layout.LIGHT * l + 7] * blocker / max(far - blocker, 1e-3 * far)


@part
def sky_loss(scene, scratch, asked, ways, record, sample):
    """The sky's radiance (3) less the incoming one in the direction of a sample, cosine-distributed.

    Where there is no sky that is what surfaces around reflect, less than zero. In TELLING a way that meets one of
    these is listed in ``ways``, and its loss is still to be added.
    """
    mode = asked[0, layout.MODE]
    if mode == layout.TELLING:
        ray = asked[int(asked[0, layout.NEXT])]
        x, y, z, dx, dy, dz = ray[0], ray[1], ray[2], ray[3], ray[4], ray[5]
        t, item, _ = answer(scene, scratch, asked, False)
    else:
        nx, ny, nz = float(record[NORMAL]), float(record[NORMAL + 1]), float(record[NORMAL + 2])
        ax, ay, az, bx, by, bz = across(nx, ny, nz)
        u, v = SKY_DISK[sample, 0], SKY_DISK[sample, 1]
        w = np.sqrt(max(1.0 - u * u - v * v, 0.0))
        dx, dy, dz = u * ax + v * bx + w * nx, u * ay + v * by + w * ny, u * az + v * bz + w * nz
        x, y, z = start_of(record)
        t, item, _ = seek(scene, scratch, asked, x, y, z, dx, dy, dz, np.inf, False)
    if item < 0 and (scene.mist == 0 or (mode == layout.ASKING and asked[0, layout.OPEN] != 0.0)):
        return 0.0, 0.0, 0.0
    if item >= 0 and mode == layout.ASKING:  # found when rays have answers
        asked[0, layout.OPEN] = 1.0
        return 0.0, 0.0, 0.0
    left, mr, mg, mb = 1.0, 0.0, 0.0, 0.0
    if scene.mist != 0:
        left, mr, mg, mb = mists_at(scene.mist)(scene, x, y, z, dx, dy, dz, 0.0, t, layout.LIGHT)
        if item < 0:
            r, g, b = sky_radiance(scene.reals, dy)
            return (1.0 - left) * r - mr, (1.0 - left) * g - mg, (1.0 - left) * b - mb
    way = ways[int(asked[0, layout.WAYS])]
    radius = record[RADIUS] + 0.05 * t
    way[OPEN_SKY], way[OPEN_SKY + 1], way[OPEN_SKY + 2] = sky_radiance(scene.reals, dy)
    way[THROUGH] = np.nan
    if clearness(scene, item) > CLEAR:
        t, item, glass = go_through(scene, scratch, x, y, z, dx, dy, dz, t, radius, item)
        for c in range(6):
            way[THROUGH + c] = glass[c]
    if scene.mist != 0:  # all of them before the glass
        veil(way, left, mr, mg, mb)
    share = met(scene, item, x, y, z) if item >= 0 else 0.0
    set_out(scene, way, item, x + t * dx, y + t * dy, z + t * dz, dx, dy, dz, radius, sample, share)
    if item < 0:  # through glass alone
        way[LIVE] = 0.0
        way[LIGHT], way[LIGHT + 1], way[LIGHT + 2] = way[OPEN_SKY], way[OPEN_SKY + 1], way[OPEN_SKY + 2]
    if mode == layout.TELLING:
        asked[0, layout.WAYS] += 1.0
        return 0.0, 0.0, 0.0
    follow(scene, scratch, asked, way)
    return lost(way)


@part
def veil(way, left, mr, mg, mb):
    """Put mists before what a way goes through: the share that they leave, and what they send (3)."""
    if way[THROUGH] != way[THROUGH]:
        for c in range(3):
            way[THROUGH + c] = 1.0
            way[THROUGH + 3 + c] = 0.0
    for c in range(6):
        way[THROUGH + c] *= left
    way[THROUGH + 3], way[THROUGH + 4], way[THROUGH + 5] = (
        way[THROUGH + 3] + mr,
        way[THROUGH + 4] + mg,
        way[THROUGH + 5] + mb,
    )


@part
def dim_lights(scene, record, number, samples, visibility):
    """Fill the columns of what mists leave of each light, means of so many samples of its disk, for look_around."""
    lights = int(scene.ints[layout.LIGHT_COUNT])
    x, y, z = start_of(record)
    for l in range(lights if samples > 0 else 0):
        total = 0.0
        lit = facing(scene, record, l)
        for k in range(samples if lit else 0):
            sample = (number * samples + k) % COUNT
            dx, dy, dz, far = toward(scene, l, x, y, z, DISK[sample, 0], DISK[sample, 1])
            total += mists_at(scene.mist)(scene, x, y, z, dx, dy, dz, 0.0, far, layout.LEFT)[0]
        visibility[FIRST_LIGHT + 2 * lights + l] = total / samples if lit else 1.0


@part
def add_lost(asked, ways, of_sky, visibility):
    """Sum up what the ``ways`` of a row of visibility, the next in the list, have lost of the sky."""
    for c in range(3):
        visibility[SKY + c] = 0.0
    first = int(asked[0, layout.NEXT])
    last = first + int(ways[first, COUNT_OF_ROW])
    for i in range(first, last):
        r, g, b = lost(ways[i])
        visibility[SKY] += r / of_sky
        visibility[SKY + 1] += g / of_sky
        visibility[SKY + 2] += b / of_sky
    asked[0, layout.NEXT] = last


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
    if asked[0, layout.MODE] == layout.TELLING:
        ray = asked[int(asked[0, layout.NEXT])]
        blocker, _, share = answer(scene, scratch, asked, True)
        return share, shadow_width(scene, l, ray[0], ray[1], ray[2], blocker) if blocker < np.inf else 0.0
    x, y, z = start_of(record)
    ax, ay, az, bx, by, bz = across(float(record[NORMAL]), float(record[NORMAL + 1]), float(record[NORMAL + 2]))
    u, v = 2.0 * jitter * record[RADIUS] * JITTER[sample, 0], 2.0 * jitter * record[RADIUS] * JITTER[sample, 1]
    x, y, z = x + u * ax + v * bx, y + u * ay + v * by, z + u * az + v * bz
    dx, dy, dz, far = toward(scene, l, x, y, z, DISK[sample, 0], DISK[sample, 1])
    blocker, _, share = seek(scene, scratch, asked, x, y, z, dx, dy, dz, far, True)
    width = shadow_width(scene, l, x, y, z, blocker) if blocker < np.inf else 0.0
    return share, width


@part
def light_sample(scene, scratch, asked, record, l, sample):
    """Share of light l for one sample of the sky's net, which has more points than that of lights' disks."""
    if not facing(scene, record, l):
        return 1.0
    if asked[0, layout.MODE] == layout.TELLING:
        return answer(scene, scratch, asked, True)[2]
    x, y, z = start_of(record)
    dx, dy, dz, far = toward(scene, l, x, y, z, SKY_DISK[sample, 0], SKY_DISK[sample, 1])
    return seek(scene, scratch, asked, x, y, z, dx, dy, dz, far, True)[2]


@kernel(types.boolean(SCENE, SCRATCH, ASKED, WAYS, ROW, _i, _i, _i, ROW), _nrt=False, inner=True)
def look_around(scene, scratch, asked, ways, record, number, of_sky, of_lights, visibility):
    """Fill a row of visibility with the means of so many samples of nets (powers of two), those of pixel ``number``.

    Several samples cover the pixel's area, one is at its center. Returns whether the row has just become final: in the
    mode ASKING a row without open rays is so at once, and stays; in TELLING others, but those with ``ways`` that light
    from around takes, which begin as AWAITED; these in ENDING, when the ways have ended. Until then rows are NaN.
    """
    mode, begin = asked[0, layout.MODE], asked[0, layout.NEXT]
    if mode == layout.TELLING and visibility[0] == visibility[0]:
        return False
    if mode == layout.ENDING:
        if visibility[0] != AWAITED:
            return False
        add_lost(asked, ways, of_sky, visibility)
        if scene.ints[layout.EMBERS] > 0:
            by_embers(scene, scratch, asked, record, number, of_sky, visibility)
        if scene.mist != 0:
            dim_lights(scene, record, number, of_lights, visibility)
        return True
    asked[0, layout.OPEN] = 0.0
    ways_before = asked[0, layout.WAYS]
    for column in range(FIRST_LIGHT + 2 * scene.ints[layout.LIGHT_COUNT]):
        visibility[column] = 0.0
    if scene.reals[layout.HAS_LIGHT] != 0.0:
        for k in range(of_sky):
            r, g, b = sky_loss(scene, scratch, asked, ways, record, (number * of_sky + k) % SKY_COUNT)
            visibility[SKY] += r / of_sky
            visibility[SKY + 1] += g / of_sky
            visibility[SKY + 2] += b / of_sky
        if scene.ints[layout.EMBERS] > 0 and asked[0, layout.WAYS] == ways_before:
            by_embers(scene, scratch, asked, record, number, of_sky, visibility)
    jitter = 0.0 if of_lights == 1 else 1.0
    for l in range(int(scene.ints[layout.LIGHT_COUNT])):
        column = FIRST_LIGHT + 2 * l
        for k in range(of_lights):
            share, width = shadow_sample(scene, scratch, asked, record, l, (number * of_lights + k) % COUNT, jitter)
            visibility[column] += share / of_lights
            visibility[column + 1] = max(visibility[column + 1], width)
    if asked[0, layout.WAYS] > ways_before:
        ways[int(ways_before), COUNT_OF_ROW] = asked[0, layout.WAYS] - ways_before
        visibility[0] = AWAITED
        return False
    final = mode != layout.ASKING
    if not final and asked[0, layout.OPEN] == 0.0 and visibility[0] == visibility[0]:
        asked[0, layout.NEXT] = begin
        final = True
    if final:
        if scene.mist != 0:
            dim_lights(scene, record, number, of_lights, visibility)
        return True
    visibility[0] = np.nan
    return False
