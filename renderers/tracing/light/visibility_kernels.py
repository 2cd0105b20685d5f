# mypy: ignore-errors
"""Visibility of the lights and of the sky from a record."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.light.light_kernels import sky_ambient, sky_radiance
from renderers.tracing.light.sampling_kernels import COUNT, DISK, JITTER, SKY_COUNT, SKY_DISK, across
from renderers.tracing.record_kernels import NORMAL, PLACE, RADIUS, start_of
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
SHOWN = 1e-3
"""Part of a lamp's radius by which a ball that shows it may be larger."""
AGAIN = 0.5
"""Share of the sky that a surface which hides the sky is assumed to see itself."""


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
def bounced(scene, scratch, item, x, y, z, dx, dy, dz, radius):
    """Radiance (3) of a surface that hides the sky: its emission, and lights and sky reflected once, matte."""
    nx, ny, nz, fx, fy, fz, lift, red, green, blue = normal_at(scene, scratch, item, x, y, z)
    if dx * fx + dy * fy + dz * fz > 0.0:
        nx, ny, nz, fx, fy, fz = -nx, -ny, -nz, -fx, -fy, -fz
    r, g, b = color_at(scene, item, (red, green, blue), x, y, z, nx, ny, nz, dx, dy, dz, radius)
    er, eg, eb = sky_ambient(scene.reals, ny)
    er, eg, eb = AGAIN * er, AGAIN * eg, AGAIN * eb
    off = 0.05 * radius + 1e-6 * (abs(x) + abs(y) + abs(z)) + lift
    sx, sy, sz = x + off * fx, y + off * fy, z + off * fz
    for l in range(int(scene.ints[layout.LIGHT_COUNT])):
        lx, ly, lz, far, ir, ig, ib = light_at(scene.reals, l, sx, sy, sz)
        cosine = nx * lx + ny * ly + nz * lz
        if cosine > 0.0 and fx * lx + fy * ly + fz * lz > 0.0:
            if far < np.inf:
                far = reach(far, scene.reals[layout.LIGHTS + layout.LIGHT * l + 7], 1.0)
            _, _, share = walk(scene, scratch, sx, sy, sz, lx, ly, lz, 0.0, far, True)
            cosine *= share / np.pi
            er += cosine * ir
            eg += cosine * ig
            eb += cosine * ib
    r, g, b = r * er, g * eg, b * eb
    s = scene.ints[layout.ITEMS + 4 * item + layout.SURFACE_AT] + layout.EMISSION
    u = scene.reals
    if max(u[s], max(u[s + 1], u[s + 2])) > 0.0 and not in_a_lamp(scene, x, y, z):
        r, g, b = r + u[s], g + u[s + 1], b + u[s + 2]
    share = min(1.0, BRIGHTEST / max(max(r, g), max(b, BRIGHTEST)))
    return share * r, share * g, share * b


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
    r, g, b = bounced(scene, scratch, item, x + t * dx, y + t * dy, z + t * dz, dx, dy, dz, radius)
    hr, hg, hb = sky_radiance(scene.reals, dy)
    return hr - r, hg - g, hb - b


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
