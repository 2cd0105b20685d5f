# mypy: ignore-errors
"""Paths in waves: all paths of a band list their next ray, and go on when packets have answered."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.camera_kernels import place_of
from renderers.tracing.gather_kernels import DARK, DOUBTED, GATHERED, LIVE, QUICK, advance, begin, light_behind
from renderers.tracing.light.sampling_kernels import sample_of
from renderers.tracing.light.visibility_kernels import look_around
from renderers.tracing.record_kernels import OWNER, UNSURE
from renderers.tracing.scene_kernels import ASKED, SCENE, SCRATCH
from renderers.tracing.solids.intersect_kernels import put_ray, tell
from sceneql.compiled.kernels import kernel

_i = types.int64
_rows = types.float32[:, ::1]
_stack = types.float32[:, :, ::1]
_paths = types.float64[:, ::1]
_many = types.int64[::1]


@kernel(_i(SCENE, _i, _i, _i, _stack, _paths, _many), _nrt=False)
def begin_paths(scene, start, stop, first, records, paths, at):
    """Begin paths of rows start..stop, at most TILE, from their ``first`` pixel on in the order of tiles.

    As many as there is room for; returns their number. Path i is of pixel ``at[i]``.
    """
    width = int(scene.reals[layout.WIDTH])
    n = 0
    for i in range(first, first + paths.shape[0]):
        x, y = place_of(i)
        if x < width and start + y < stop:
            k = (start + y) * width + x
            begin(scene.reals, x + 0.5, start + y + 0.5, paths[n], records[0, k], records[1, k], 0)
            at[n] = k
            n += 1
    return n


@kernel(_i(_paths, ASKED), _nrt=False)
def ask_paths(paths, asked):
    """List the next ray of all live paths; returns their number."""
    row = 1
    for i in range(paths.shape[0]):
        if paths[i, LIVE] != 0.0:
            path = paths[i]
            put_ray(asked, row, path[0], path[1], path[2], path[3], path[4], path[5], np.inf, layout.FIRST)
            row += 1
    asked[0, layout.NEXT] = row
    return row - 1


@kernel(_i(SCENE, SCRATCH, ASKED, _paths, _many, _stack, _rows), _nrt=False)
def advance_paths(scene, scratch, asked, paths, at, records, spares):
    """Advance all live paths by the answers for their rays; path i has the records ``at[i]``.

    Returns the number of paths whose surface beyond these, left in ``spares`` (n, COLUMNS), is to be lit.
    """
    row = 1
    dark = 0
    for i in range(paths.shape[0]):
        if paths[i, LIVE] != 0.0:
            k = at[i]
            tell(scratch, asked, row)
            row += 1
            advance(scene, scratch, paths[i], records[0, k], records[1, k], spares[i])
            dark += paths[i, DARK] > 0.0
    return dark


@kernel(_i(SCENE, SCRATCH, ASKED, _i, _i, _paths, _rows, _rows), _nrt=False)
def light_paths(scene, scratch, asked, first, last, paths, spares, visibility):
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
        if light_behind(scene, scratch, asked, paths[i], spares[i], visibility[i]):
            paths[i, DARK] = 0.0
        if scratch[counter, 0] > 0.0:
            paths[i, DOUBTED] = 1.0
    return last


@kernel(types.UniTuple(_i, 2)(_paths, _many, _stack, _rows), _nrt=False)
def end_paths(paths, at, records, radiance):
    """Write the radiance of the pixels ``at`` without their records' light, and whether they are UNSURE.

    Returns the number of pixels that are, and of those with a second record.
    """
    doubted = seconds = 0
    for i in range(paths.shape[0]):
        doubted += paths[i, DOUBTED] > 0.0
        seconds += records[1, at[i], OWNER] > 0.0
        records[0, at[i], UNSURE] = paths[i, DOUBTED]
        for c in range(3):
            radiance[at[i], c] = paths[i, GATHERED + c]
    return doubted, seconds


@kernel(_i(SCENE, SCRATCH, ASKED, _i, _i, _many, _stack, _stack), _nrt=False)
def look_from(scene, scratch, asked, first, last, at, records, visibility):
    """The visibility of the pixels ``at[first:last]``, one sample of each light and of the sky.

    Stops where ``asked`` has no room for more rays; returns where it ends.
    """
    width = int(scene.reals[layout.WIDTH])
    room = asked.shape[0] - 2 * (1 + scene.ints[layout.LIGHT_COUNT])
    for i in range(first, last):
        if asked[0, layout.MODE] == layout.ASKING and asked[0, layout.NEXT] > room:
            return i
        k = at[i]
        number = sample_of(k % width, k // width)
        for layer in range(2):
            if records[layer, k, OWNER] > 0.0:
                look_around(scene, scratch, asked, records[layer, k], number, 1, 1, visibility[layer, k])
    return last
