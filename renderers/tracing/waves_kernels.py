# mypy: ignore-errors
"""Rays of the camera, and their paths, in waves: all list their next ray, and go on when packets have answered."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.camera_kernels import TILE, camera_ray, next_place, place_of
from renderers.tracing.gather_kernels import (
    DARK,
    DOUBTED,
    GATHERED,
    HIT_AT,
    HIT_ITEM,
    KNOWN,
    LIVE,
    MET,
    QUICK,
    ROW,
    advance,
    begin,
    light_behind,
)
from renderers.tracing.light.bounce_kernels import WAYS
from renderers.tracing.light.light_kernels import backdrop, sharpness
from renderers.tracing.light.sampling_kernels import sample_of
from renderers.tracing.light.shade_kernels import is_dark, reflects, shade, shade_matte, sky_on
from renderers.tracing.light.visibility_kernels import AWAITED, look_around
from renderers.tracing.path_kernels import describe_by, describe_plain, faded, is_plain
from renderers.tracing.record_kernels import OWNER, SURFACE, UNSURE, WEIGHT, erase
from renderers.tracing.scene_kernels import ASKED, SCENE, SCRATCH, mists_at, part
from renderers.tracing.solids.intersect_kernels import join, put_ray, tell, walk
from renderers.tracing.solids.surface_kernels import skin_of
from renderers.tracing.tiles_kernels import LOSSY, MARKS, mark_of
from sceneql.compiled.kernels import kernel

_i = types.int64
_rows = types.float32[:, ::1]
_stack = types.float32[:, :, ::1]
_paths = types.float64[:, ::1]
_many = types.int64[::1]


@part
def list_ray(scene, asked, cones, n, px, py, sample):
    """List the camera's ray through a point (px, py) of the picture [pixels] as number n, and its cone."""
    ox, oy, oz, dx, dy, dz, radius, spread = camera_ray(scene.reals, px, py)
    put_ray(asked, 1 + n, ox, oy, oz, dx, dy, dz, np.inf, layout.FIRST)
    cones[n, 0], cones[n, 1], cones[n, 2] = radius, spread, sample


@part
def matte(scene, item):
    """Whether rays end at an item: it is no glass, and mirrors nothing that is traced."""
    s = scene.ints[layout.ITEMS + 4 * item + layout.SURFACE_AT]
    clear = scene.reals[s + layout.TRANSMISSION] > 0.0
    return not clear and sharpness(scene.reals[s + layout.ROUGHNESS]) == 0.0


@kernel(_i(SCENE), _nrt=False)
def layers_of(scene):
    """How many records pixels need: two, unless no item mirrors or refracts anything."""
    for item in range(scene.ints[layout.ITEM_COUNT]):
        if not matte(scene, item):
            return 2
    return 1


@part
def see_mist(scene, ray, t, gathered):
    """Add what mists send on a camera's ray up to t to what it has ``gathered``; returns what is left of light."""
    left, r, g, b = mists_at(scene.mist)(scene, ray[0], ray[1], ray[2], ray[3], ray[4], ray[5], 0.0, t, layout.SEEN)
    gathered[0], gathered[1], gathered[2] = gathered[0] + r, gathered[1] + g, gathered[2] + b
    return left


@part
def see_matte(scene, item, skin, t, ray, cone, record, gathered):
    """Write the record of a matte item that a camera's ray meets at t."""
    x, y, z = ray[0] + t * ray[3], ray[1] + t * ray[4], ray[2] + t * ray[5]
    describe_by(scene, item, skin, x, y, z, ray[3], ray[4], ray[5], abs(cone[0] + cone[1] * t), record)
    weigh(scene, item, t, ray, cone, record, gathered)


@part
def see_plain(scene, item, t, ray, cone, record, gathered):
    """Write the record of a matte item that ``is_plain``."""
    x, y, z = ray[0] + t * ray[3], ray[1] + t * ray[4], ray[2] + t * ray[5]
    describe_plain(scene, item, x, y, z, ray[3], ray[4], ray[5], abs(cone[0] + cone[1] * t), record)
    weigh(scene, item, t, ray, cone, record, gathered)


@part
def weigh(scene, item, t, ray, cone, record, gathered):
    """Write the weight of the record of a camera's ray that ends at t; endless items fade into the backdrop."""
    weight = 1.0
    if scene.mist != 0:
        weight = see_mist(scene, ray, t, gathered)
    fade = faded(scene, item, record) if cone[1] > 0.0 else 1.0
    if fade < 1.0:
        r, g, b = backdrop(scene.reals, max(ray[4], 0.0))
        lost = weight * (1.0 - fade)
        gathered[0], gathered[1], gathered[2] = gathered[0] + lost * r, gathered[1] + lost * g, gathered[2] + lost * b
        weight *= fade
    record[WEIGHT], record[WEIGHT + 1], record[WEIGHT + 2] = weight, weight, weight


@kernel(_i(SCENE, _i, _i, _many, ASKED, _paths, _many), _nrt=False)
def list_pixels(scene, start, stop, tiles, asked, cones, at):
    """List the camera's rays of ``tiles`` of rows start..stop, at most TILE; returns their number.

    Row 1 + i of ``asked`` is the ray of pixel ``at[i]``, and ``cones[i]`` its cone: radius, spread, number of the
    sample in its pixel.
    """
    width = int(scene.reals[layout.WIDTH])
    n = 0
    for tile in tiles:
        for i in range(tile * TILE * TILE, (tile + 1) * TILE * TILE):
            x, y = place_of(i)
            if x < width and start + y < stop:
                list_ray(scene, asked, cones, n, x + 0.5, start + y + 0.5, 0)
                at[n] = (start + y) * width + x
                n += 1
    asked[0, layout.NEXT] = 1 + n
    return n


@kernel(types.UniTuple(_i, 2)(SCENE, SCRATCH, ASKED, _i, _paths, _many, _stack, _paths, _paths, _many, _many, _paths),
        _nrt=False)  # fmt: skip
def meet_first(scene, scratch, asked, count, cones, at, records, gathered, paths, of, hits, met):
    """Follow ``count`` listed rays of the camera to what they meet first; ray i has the records ``at[i]``.

    What is seen without more rays, the background and matte surfaces, is done then: its light but for the records is
    in ``gathered[i]`` (r, g, b, and as DOUBTED). Of matte hits of solids that packets know the records are left to
    ``describe_hits``: they are listed in ``hits``, with (t, item, point) in ``met``. The rest begin as paths, of rays
    ``of``. Further layers of records, which paths alone write, are empty before. Returns the numbers of paths and hits.
    """
    counter = scratch.shape[0] - 1
    together = asked.shape[1] > layout.ANSWERS
    alone = asked[0, layout.ALONE] != 0.0
    paths_now = hits_now = 0
    thin = scene.ints[layout.HAS_THIN] != 0
    seen, ends, even = -1, False, False  # the item met last, whether rays end at it, and whether it ``is_plain``
    for i in range(count):
        k, ray = at[i], asked[1 + i]
        first = records[0, k]
        item, plain = -1, False
        if not thin:
            scratch[counter, 0] = 0.0
            told, t, item = False, np.inf, -1
            if alone:
                told, t, item, _ = join(scene, scratch, asked, 1 + i, np.inf, False)
            if not told:
                tell(scratch, asked, 1 + i)
                t, item, _ = walk(scene, scratch, ray[0], ray[1], ray[2], ray[3], ray[4], ray[5], 0.0, np.inf, False)
            if item >= 0 and item != seen:
                seen, ends, even = item, matte(scene, item), is_plain(scene, item)
            plain = item < 0 or ends
        if item < 0 or not plain:
            erase(first)
        if not plain:
            path = paths[paths_now]
            begin(path, ray, cones[i])
            path[ROW] = 1 + i
            if not thin:
                path[KNOWN], path[HIT_AT], path[HIT_ITEM] = MET, t, item
                path[DOUBTED] = 1.0 if scratch[counter, 0] > 0.0 else 0.0
                scratch[counter, layout.TOLD] = 0.0
            of[paths_now] = i
            paths_now += 1
            continue
        scratch[counter, layout.TOLD] = 0.0
        own = gathered[i]
        own[0], own[1], own[2] = 0.0, 0.0, 0.0
        if item < 0:
            r, g, b = backdrop(scene.reals, ray[4])
            left = see_mist(scene, ray, np.inf, own) if scene.mist != 0 else 1.0
            own[0], own[1], own[2] = own[0] + left * r, own[1] + left * g, own[2] + left * b
        elif together and scene.ints[layout.ITEMS + 4 * item + layout.KIND] == layout.IMPLICIT:
            hits[hits_now], met[i, 0], met[i, 1] = i, t, item
            for axis in range(3):
                met[i, 2 + axis] = ray[axis] + t * ray[3 + axis]
            hits_now += 1
        elif even:
            see_plain(scene, item, t, ray, cones[i], first, own)
        else:
            skin = skin_of(scene, scratch, item, ray[0] + t * ray[3], ray[1] + t * ray[4], ray[2] + t * ray[5])
            see_matte(scene, item, skin, t, ray, cones[i], first, own)
        own[3] = 1.0 if scratch[counter, 0] > 0.0 else 0.0
    return paths_now, hits_now


@kernel(types.void(SCENE, ASKED, _paths, _many, _stack, _paths, _many, _paths, _paths), _nrt=False)
def describe_hits(scene, asked, cones, at, records, gathered, hits, met, skins):
    """Write the records of ``hits`` by their normals and colors in ``skins`` (n, 6), as ``skin_kernels.skin``."""
    for i in hits:
        nx, ny, nz, r, g, b = skins[i, 0], skins[i, 1], skins[i, 2], skins[i, 3], skins[i, 4], skins[i, 5]
        skin = nx, ny, nz, nx, ny, nz, 0.0, 0.0, r, g, b
        see_matte(scene, int(met[i, 1]), skin, met[i, 0], asked[1 + i], cones[i], records[0, at[i]], gathered[i])


@kernel(_i(_paths, ASKED), _nrt=False)
def ask_paths(paths, asked):
    """List the next ray of all live paths; returns their number."""
    row = 1
    for i in range(paths.shape[0]):
        if paths[i, LIVE] != 0.0:
            path = paths[i]
            put_ray(asked, row, path[0], path[1], path[2], path[3], path[4], path[5], np.inf, layout.FIRST)
            path[ROW], path[KNOWN] = row, 0.0
            row += 1
    asked[0, layout.NEXT] = row
    return row - 1


@kernel(_i(SCENE, SCRATCH, ASKED, _paths, _many, _stack, _rows), _nrt=False)
def advance_paths(scene, scratch, asked, paths, at, records, spares):
    """Advance all live paths by the answers for their rays; path i has the records ``at[i]``.

    Returns the number of paths whose surface beyond these, left in ``spares`` (n, COLUMNS), is to be lit.
    """
    dark = 0
    for i in range(paths.shape[0]):
        if paths[i, LIVE] != 0.0:
            k = at[i]
            if paths[i, KNOWN] == 0.0:
                tell(scratch, asked, int(paths[i, ROW]))
            advance(scene, scratch, paths[i], records[0, k], records[len(records) - 1, k], spares[i])
            dark += paths[i, DARK] > 0.0
    return dark


@kernel(_i(SCENE, SCRATCH, ASKED, WAYS, _i, _i, _paths, _rows, _rows), _nrt=False)
def light_paths(scene, scratch, asked, ways, first, last, paths, spares, visibility):
    """Light the surfaces beyond the records of paths first..last, while ``asked`` has room for more rays.

    Returns where it ends. ``visibility`` (n, V) is working memory.
    """
    room = asked.shape[0] - QUICK * (1 + scene.ints[layout.LIGHT_COUNT])
    counter = scratch.shape[0] - 1
    for i in range(first, last):
        if paths[i, DARK] == 0.0:
            continue
        if asked[0, layout.MODE] == layout.ASKING and asked[0, layout.NEXT] > room:
            return i
        scratch[counter, 0] = 0.0
        if light_behind(scene, scratch, asked, ways, paths[i], spares[i], visibility[i]):
            paths[i, DARK] = 0.0
        if scratch[counter, 0] > 0.0:
            paths[i, DOUBTED] = 1.0
    return last


@kernel(types.void(_paths, _many, _paths), _nrt=False)
def end_paths(paths, of, gathered):
    """Write what paths have gathered to that of their rays."""
    for i in range(paths.shape[0]):
        for c in range(3):
            gathered[of[i], c] = paths[i, GATHERED + c]
        gathered[of[i], 3] = paths[i, DOUBTED]


@kernel(types.UniTuple(_i, 2)(SCENE, _paths, _many, _stack, _stack, types.boolean, _rows, MARKS, MARKS),
        _nrt=False)  # fmt: skip
def end_pixels(scene, gathered, at, records, visibility, final, radiance, busy, mirrored):
    """Write the radiance of the pixels ``at`` without their records' light, and whether they are UNSURE.

    Their light is added where their visibility is ``final``. Their tiles become ``busy``, and ``mirrored`` where
    one has a second record. Returns the number of pixels
    that are unsure, and of those with a second record.
    """
    u, width = scene.reals, int(scene.reals[layout.WIDTH])
    doubted = seconds = 0
    before, x, y = -2, 0, 0
    dark, lights = is_dark(u), int(scene.ints[layout.LIGHT_COUNT]) if final else 0
    tile_x = tile_y = -1
    mark = 0  # of the tile at hand
    for i in range(gathered.shape[0]):
        k = at[i]
        x, y = next_place(k, before, x, y, width)
        before = k
        doubted += gathered[i, 3] > 0.0
        if len(records) > 1 and records[len(records) - 1, k, OWNER] > 0.0:
            seconds += 1
            mirrored[y // TILE, x // TILE] = 1
        records[0, k, UNSURE] = gathered[i, 3]
        for c in range(3):
            radiance[k, c] = gathered[i, c]
        for layer in range(len(records) if final else 0):
            record = records[layer, k]
            if record[OWNER] != 0.0:
                s = int(record[SURFACE])
                if reflects(u, s):
                    r, g, b = shade(scene, record, visibility[layer, k])
                else:
                    r, g, b = shade_matte(scene, record, visibility[layer, k], s, sky_on(u, record, dark))
                radiance[k, 0], radiance[k, 1], radiance[k, 2] = (
                    radiance[k, 0] + r,
                    radiance[k, 1] + g,
                    radiance[k, 2] + b,
                )
        if y // TILE != tile_y or x // TILE != tile_x:
            if mark > 0:
                busy[tile_y, tile_x] = max(busy[tile_y, tile_x], mark)
            tile_x, tile_y, mark = x // TILE, y // TILE, 0
        if mark != LOSSY:
            mark = max(mark, mark_of(records, visibility, k, lights))
    if mark > 0:
        busy[tile_y, tile_x] = max(busy[tile_y, tile_x], mark)
    return doubted, seconds


@kernel(_i(SCENE, SCRATCH, ASKED, WAYS, _i, _i, _many, _stack, _stack), _nrt=False)
def look_from(scene, scratch, asked, ways, first, last, at, records, visibility):
    """The visibility of the pixels ``at[first:last]``, one sample of each light and of the sky.

    Stops where ``asked`` has no room for more rays; returns where it ends.
    """
    width = int(scene.reals[layout.WIDTH])
    room = asked.shape[0] - 2 * (1 + scene.ints[layout.LIGHT_COUNT])
    ending = asked[0, layout.MODE] == layout.ENDING
    for i in range(first, last):
        if asked[0, layout.MODE] == layout.ASKING and asked[0, layout.NEXT] > room:
            return i
        k = at[i]
        for layer in range(len(records)):
            if ending and visibility[layer, k, 0] != AWAITED:
                continue
            if records[layer, k, OWNER] > 0.0:
                number = sample_of(k % width, k // width)
                look_around(scene, scratch, asked, ways, records[layer, k], number, 1, 1, visibility[layer, k])
    return last
