# mypy: ignore-errors
"""One sample of the sky and of each light for many pixels, whose rays are made in lanes.

For scenes of which packets and lanes know all, without mists and small spheres that glow. Rays, their order and what
is found are those of ``visibility_kernels.look_around``, which does what is not just free or dark: light from around.
"""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.camera_kernels import next_place
from renderers.tracing.light.bounce_kernels import COUNT as COUNT_OF_ROW
from renderers.tracing.light.bounce_kernels import WAYS
from renderers.tracing.light.lights_kernels import light_at
from renderers.tracing.light.sampling_kernels import COUNT, DISK, SKY_COUNT, SKY_DISK, across, sample_of
from renderers.tracing.light.visibility_kernels import (
    AWAITED,
    FIRST_LIGHT,
    SKY,
    shadow_sample,
    shadow_width,
    sky_loss,
    toward,
)
from renderers.tracing.record_kernels import LIFT, NORMAL, OWNER, PLACE, RADIUS
from renderers.tracing.scene_kernels import ASKED, SCENE, SCRATCH, part
from renderers.tracing.solids.intersect_kernels import join, put_ray
from renderers.tracing.tiles_kernels import ball_of
from sceneql.compiled.kernels import kernel

_i = types.int64
_many = types.int64[::1]
_stack = types.float32[:, :, ::1]
LANES = 128
NX, NY, NZ, PX, PY, PZ, OFF, RADII, OX, OY, OZ, DX, DY, DZ, FAR, U, V, SHOWN, ROW, NUMBER, PIXEL, LAYER, ROOM = (
    LANES * row for row in range(23)
)
"""Offsets in the memory of a batch, LANES numbers each: normal and place of a record, how far off it rays start, the
radius of its pixel's cone, and where rays start; direction of a ray, its end, its point of the net; whether the record
faces the light at hand; row of its next ray in the list; number of the pixel's sample, its place in the list of pixels,
and the layer of the record; its size. Loops over lanes end by ``min(n, LANES)``, by which no index is looked at for
being negative."""
MOST_LIGHTS = 8
MOST_NODES = 16
"""Boxes that are looked at to tell that a batch's rays to a light meet nothing."""


@part
def load(record, number, i, lanes):
    """Copy a record and its sample's number into lane i."""
    for axis in range(3):
        lanes[NX + axis * LANES + i] = record[NORMAL + axis]
        lanes[PX + axis * LANES + i] = record[PLACE + axis]
    lanes[OFF + i], lanes[RADII + i] = record[LIFT], record[RADIUS]
    lanes[NUMBER + i] = number


@part
def gather(width, start, last, at, records, lanes):
    """Copy the records of the pixels ``at[start:last]`` into lanes, until these are full; (their number, the next)."""
    n, i, layers = 0, start, len(records)
    while i < last and n + layers <= LANES:
        k = at[i]
        for layer in range(layers):
            if records[layer, k, OWNER] > 0.0:
                lanes[PIXEL + n], lanes[LAYER + n] = i, layer
                n += 1
        i += 1
    until = i
    before, x, y = -2, 0, 0
    for i in range(min(n, LANES)):
        k = at[int(lanes[PIXEL + i])]
        if k != before:
            x, y = next_place(k, before, x, y, width)
            before = k
        load(records[int(lanes[LAYER + i]), k], sample_of(x, y), i, lanes)
    for i in range(min(n, LANES)):
        # In single precision, as records have them.
        px, py, pz = np.float32(lanes[PX + i]), np.float32(lanes[PY + i]), np.float32(lanes[PZ + i])
        off = max(0.05 * lanes[RADII + i], 1e-6 * (abs(px) + abs(py) + abs(pz))) + lanes[OFF + i]
        lanes[OX + i] = lanes[PX + i] + off * lanes[NX + i]
        lanes[OY + i] = lanes[PY + i] + off * lanes[NY + i]
        lanes[OZ + i] = lanes[PZ + i] + off * lanes[NZ + i]
    return n, until


@part
def face(scene, l, n, lanes):
    """Tell which of n records face light l: as ``visibility_kernels.facing``."""
    u = scene.reals
    if u[layout.LIGHTS + layout.LIGHT * l] == layout.SUN:
        dx, dy, dz, _, _, _, _ = light_at(u, l, 0.0, 0.0, 0.0)
        for i in range(min(n, LANES)):
            lanes[SHOWN + i] = 1.0 if lanes[NX + i] * dx + lanes[NY + i] * dy + lanes[NZ + i] * dz > 0.0 else 0.0
        return
    for i in range(min(n, LANES)):
        dx, dy, dz, _, _, _, _ = light_at(u, l, lanes[PX + i], lanes[PY + i], lanes[PZ + i])
        lanes[SHOWN + i] = 1.0 if lanes[NX + i] * dx + lanes[NY + i] * dy + lanes[NZ + i] * dz > 0.0 else 0.0


@part
def past_floors(scene, l, n, lanes):
    """Whether no ray from n places to sun l meets an endless item: from all of these it leads away."""
    u, k = scene.reals, layout.LIGHTS + layout.LIGHT * l
    for item in range(scene.ints[layout.ENDLESS_COUNT]):
        h = scene.ints[layout.ITEMS + 4 * item + layout.REALS_AT]
        if scene.ints[layout.ITEMS + 4 * item + layout.KIND] != layout.HALF_SPACE:
            return False
        if not u[h] * u[k + 1] + u[h + 1] * u[k + 2] + u[h + 2] * u[k + 3] > 1.001 * u[k + 8] + 1e-6:
            return False
        below = 0
        for i in range(min(n, LANES)):
            off = u[h + 3] - u[h] * lanes[OX + i] - u[h + 1] * lanes[OY + i] - u[h + 2] * lanes[OZ + i]
            below += 0 if off < 0.0 else 1
        if below > 0:
            return False
    return True


@part
def beam(n, lanes):
    """(center, radius) of a ball around n places."""
    low, high = (np.inf, np.inf, np.inf), (-np.inf, -np.inf, -np.inf)
    for i in range(min(n, LANES)):
        x, y, z = lanes[OX + i], lanes[OY + i], lanes[OZ + i]
        low = min(low[0], x), min(low[1], y), min(low[2], z)
        high = max(high[0], x), max(high[1], y), max(high[2], z)
    dx, dy, dz = 0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1]), 0.5 * (high[2] - low[2])
    return low[0] + dx, low[1] + dy, low[2] + dz, np.sqrt(dx * dx + dy * dy + dz * dz)


@part
def passes(scene, link, box, l, ball):
    """Whether no ray to sun l from within a ``ball`` (center, radius) meets what a leaf or node holds, in its box.

    They are parted by a direction at right angles to the sun's; rays go aside by the sun's size.
    """
    u, k = scene.reals, layout.LIGHTS + layout.LIGHT * l
    sx, sy, sz, size = u[k + 1], u[k + 2], u[k + 3], u[k + 8]
    hx, hy, hz = 0.5 * (u[box + 3] - u[box]), 0.5 * (u[box + 4] - u[box + 1]), 0.5 * (u[box + 5] - u[box + 2])
    x, y, z = u[box] + hx - ball[0], u[box + 1] + hy - ball[1], u[box + 2] + hz - ball[2]
    along = x * sx + y * sy + z * sz
    wx, wy, wz = x - along * sx, y - along * sy, z - along * sz
    apart = np.sqrt(wx * wx + wy * wy + wz * wz)
    deep = hx * abs(sx) + hy * abs(sy) + hz * abs(sz)
    wide = (hx * abs(wx) + hy * abs(wy) + hz * abs(wz)) / apart if apart > 0.0 else np.inf
    far = max(along + deep, 0.0) + ball[3]
    if not apart < np.inf:
        return False
    if apart > (wide + ball[3] + size * far) * 1.001 or along + deep + ball[3] < -1e-3 * (abs(along) + deep):
        return True
    inner = ball_of(scene, link)
    if inner < 0:
        return False
    x, y, z, radius = u[inner] - ball[0], u[inner + 1] - ball[1], u[inner + 2] - ball[2], u[inner + 3]
    along = x * sx + y * sy + z * sz
    wx, wy, wz = x - along * sx, y - along * sy, z - along * sz
    aside = radius + ball[3] + size * (max(along + radius, 0.0) + ball[3])
    return np.sqrt(wx * wx + wy * wy + wz * wz) > 1.001 * aside


@part
def unhindered(scene, l, n, lanes):
    """Whether no ray from n places to light l, a sun, meets anything, as far as a few boxes tell."""
    if scene.reals[layout.LIGHTS + layout.LIGHT * l] != layout.SUN or not past_floors(scene, l, n, lanes):
        return False
    ball = beam(n, lanes)
    node, looked = 1, 0
    while node < scene.ints[layout.NODE_COUNT]:
        link = scene.ints[layout.LINKS_AT] + layout.LINK * node
        looked += 1
        if passes(scene, link, scene.ints[layout.NODES_AT] + 6 * node, l, ball):
            node = scene.ints[link]
        elif scene.ints[link + 2] == 0 and looked < MOST_NODES:
            node += 1
        else:
            return False
    return True


@part
def note(column, hidden, n, at, visibility, lanes):
    """Write for n records that a light is seen whole, or NaN where rays are to tell, those SHOWN if ``hidden``."""
    for i in range(min(n, LANES)):
        own = visibility[int(lanes[LAYER + i]), at[int(lanes[PIXEL + i])]]
        own[column], own[column + 1] = (np.nan if hidden and lanes[SHOWN + i] != 0.0 else 1.0), 0.0


@part
def to_sky(n, lanes):
    """Directions of rays to the sky, cosine-distributed: as ``visibility_kernels.sky_loss``."""
    for i in range(min(n, LANES)):
        sample = int(lanes[NUMBER + i])
        lanes[U + i], lanes[V + i] = SKY_DISK[sample, 0], SKY_DISK[sample, 1]
    for i in range(min(n, LANES)):
        # In single precision, as records have them: products of two of these are rounded so.
        nx, ny, nz = np.float32(lanes[NX + i]), np.float32(lanes[NY + i]), np.float32(lanes[NZ + i])
        u, v = lanes[U + i], lanes[V + i]
        ax, ay, az, bx, by, bz = across(nx, ny, nz)
        w = np.sqrt(max(1.0 - u * u - v * v, 0.0))
        lanes[DX + i] = u * ax + v * bx + w * nx
        lanes[DY + i] = u * ay + v * by + w * ny
        lanes[DZ + i] = u * az + v * bz + w * nz
        lanes[FAR + i] = np.inf


@part
def to_light(scene, l, n, lanes):
    """Rays to light l: as ``visibility_kernels.shadow_sample``."""
    u = scene.reals
    for i in range(min(n, LANES)):
        sample = int(lanes[NUMBER + i]) % COUNT
        lanes[U + i], lanes[V + i] = DISK[sample, 0], DISK[sample, 1]
    if u[layout.LIGHTS + layout.LIGHT * l] == layout.SUN:
        sx, sy, sz, far, _, _, _ = light_at(u, l, 0.0, 0.0, 0.0)
        ax, ay, az, bx, by, bz = across(sx, sy, sz)
        size = u[layout.LIGHTS + layout.LIGHT * l + 8]
        for i in range(min(n, LANES)):
            x, y = size * lanes[U + i], size * lanes[V + i]
            dx, dy, dz = sx + x * ax + y * bx, sy + x * ay + y * by, sz + x * az + y * bz
            length = np.sqrt(dx * dx + dy * dy + dz * dz)
            lanes[DX + i], lanes[DY + i], lanes[DZ + i], lanes[FAR + i] = dx / length, dy / length, dz / length, far
        return
    for i in range(min(n, LANES)):
        lanes[DX + i], lanes[DY + i], lanes[DZ + i], lanes[FAR + i] = toward(
            scene, l, lanes[OX + i], lanes[OY + i], lanes[OZ + i], lanes[U + i], lanes[V + i]
        )


@part
def put(asked, n, want, every, lanes):
    """List the rays of n lanes, of all or of those SHOWN, in their rows."""
    for i in range(min(n, LANES)):
        if every or lanes[SHOWN + i] != 0.0:
            row = int(lanes[ROW + i])
            put_ray(
                asked, row, lanes[OX + i], lanes[OY + i], lanes[OZ + i], lanes[DX + i], lanes[DY + i], lanes[DZ + i],
                lanes[FAR + i], want,
            )  # fmt: skip
            lanes[ROW + i] = float(row + 1)


@kernel(_i(SCENE, ASKED, _i, _i, _many, _stack, _stack, types.float64[::1]), _nrt=False)
def list_looks(scene, asked, first, last, at, records, visibility, lanes):
    """List the rays by which the pixels ``at[first:last]`` look around, one sample of each light and of the sky.

    Lights that are known to be seen whole get no rays, see ``note``. Stops where ``asked`` has no room for more rays;
    returns where it ends. ``lanes`` (ROOM,) is working memory.
    """
    width, lights = int(scene.reals[layout.WIDTH]), int(scene.ints[layout.LIGHT_COUNT])
    sky = scene.reals[layout.HAS_LIGHT] != 0.0
    room = asked.shape[0] - 2 * (1 + lights)
    row, start = int(asked[0, layout.NEXT]), first
    while start < last:
        n, start = gather(width, start, last, at, records, lanes)
        for i in range(min(n, LANES)):
            lanes[ROW + i] = 1.0 if sky else 0.0
        free = 0
        for l in range(lights):
            face(scene, l, n, lanes)
            hidden = not unhindered(scene, l, n, lanes)
            note(FIRST_LIGHT + 2 * l, hidden, n, at, visibility, lanes)
            free |= 0 if hidden else 1 << l
            for i in range(min(n, LANES) if hidden else 0):
                lanes[ROW + i] += lanes[SHOWN + i]
        for i in range(min(n, LANES)):
            if row > room and (i == 0 or lanes[PIXEL + i] != lanes[PIXEL + i - 1]):
                n, last = i, int(lanes[PIXEL + i])
                break
            count = int(lanes[ROW + i])
            lanes[ROW + i] = float(row)
            row += count
        if sky:
            to_sky(n, lanes)
            put(asked, n, layout.FIRST, True, lanes)
        for l in range(lights):
            if free >> l & 1:
                continue
            if lights > 1:
                face(scene, l, n, lanes)
            to_light(scene, l, n, lanes)
            put(asked, n, layout.ANYWHERE, False, lanes)
    asked[0, layout.NEXT] = row
    return last


@part
def is_free(scene, scratch, asked, visibility):
    """Fill a row of visibility by the next answers, unless light from around is to be followed, or they do not tell."""
    row = int(asked[0, layout.NEXT])
    if scene.reals[layout.HAS_LIGHT] != 0.0:
        told, _, item, _ = join(scene, scratch, asked, row, np.inf, False)
        if not told or item >= 0:
            return False
        row += 1
    for c in range(3):
        visibility[SKY + c] = 0.0
    listed = 0
    for l in range(int(scene.ints[layout.LIGHT_COUNT])):
        column = FIRST_LIGHT + 2 * l
        if visibility[column] == visibility[column]:
            continue
        listed |= 1 << l
        told, blocker, _, share = join(scene, scratch, asked, row, asked[row, layout.FAR], True)
        if not told:
            for m in range(l):
                if listed >> m & 1:
                    visibility[FIRST_LIGHT + 2 * m] = np.nan
            return False
        visibility[column] = share
        if blocker < np.inf:
            x, y, z = asked[row, 0], asked[row, 1], asked[row, 2]
            visibility[column + 1] = max(0.0, shadow_width(scene, l, x, y, z, blocker))
        row += 1
    asked[0, layout.NEXT] = row
    return True


@part
def look_on(scene, scratch, asked, ways, record, number, visibility):
    """As ``visibility_kernels.look_around`` with one sample of each, in TELLING, of what ``note`` has not told."""
    before = asked[0, layout.WAYS]
    for c in range(3):
        visibility[SKY + c] = 0.0
    if scene.reals[layout.HAS_LIGHT] != 0.0:
        r, g, b = sky_loss(scene, scratch, asked, ways, record, number % SKY_COUNT)
        visibility[SKY], visibility[SKY + 1], visibility[SKY + 2] = r, g, b
    for l in range(int(scene.ints[layout.LIGHT_COUNT])):
        column = FIRST_LIGHT + 2 * l
        if visibility[column] != visibility[column]:
            share, width = shadow_sample(scene, scratch, asked, record, l, number % COUNT, 0.0)
            visibility[column], visibility[column + 1] = share, max(0.0, width)
    if asked[0, layout.WAYS] > before:
        ways[int(before), COUNT_OF_ROW] = asked[0, layout.WAYS] - before
        visibility[0] = AWAITED


@kernel(_i(SCENE, SCRATCH, ASKED, WAYS, _i, _i, _many, _stack, _stack), _nrt=False)
def tell_looks(scene, scratch, asked, ways, first, last, at, records, visibility):
    """The visibility of the pixels ``at[first:last]``, whose listed rays have answers; returns ``last``."""
    width = int(scene.reals[layout.WIDTH])
    for i in range(first, last):
        k = at[i]
        for layer in range(len(records)):
            record, own = records[layer, k], visibility[layer, k]
            if record[OWNER] > 0.0 and not is_free(scene, scratch, asked, own):
                look_on(scene, scratch, asked, ways, record, sample_of(k % width, k // width), own)
    return last
