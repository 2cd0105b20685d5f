# mypy: ignore-errors
"""The last stage in waves: as edges_kernels, with all rays of some pixels' samples met in packets."""

from numba import types

from renderers.tracing.edges_kernels import ANEW, BRIGHTEST, CONTRAST, TRIAL, borrow, contrast, jagged
from renderers.tracing.filter_kernels import SLACK
from renderers.tracing.gather_kernels import GATHERED, begin
from renderers.tracing.record_kernels import OWNER, alike
from renderers.tracing.sampling_kernels import sample_of
from renderers.tracing.scene_kernels import ASKED, ASKING, HEIGHT, LIGHT_COUNT, MODE, NEXT, SCENE, SCRATCH, WIDTH
from renderers.tracing.shade_kernels import shade
from renderers.tracing.visibility_kernels import look_around
from renderers.tracing.waves_kernels import place_of
from sceneql.kernels import kernel

_i = types.int64
_rows = types.float32[:, ::1]
_stack = types.float32[:, :, ::1]
_reals = types.float64[:, ::1]
_many = types.int64[::1]


@kernel(_i(SCENE, _i, _i, _stack, _rows, _rows, _many), _nrt=False)
def list_edges(scene, start, stop, records, radiance, picture, edges):
    """The pixels of rows start..stop, no more than TILE, that are to be drawn anew; the others go to the picture."""
    width, height = int(scene.reals[WIDTH]), int(scene.reals[HEIGHT])
    n = 0
    for i in range(len(edges)):
        x, y = place_of(i)
        y += start
        if x >= width or y >= stop:
            continue
        k = y * width + x
        if jagged(records, radiance, k, x, y, width, height):
            edges[n] = k
            n += 1
        else:
            for c in range(3):
                picture[k, c] = radiance[k, c]
    return n


@kernel(types.void(SCENE, _reals, _many, _reals, _stack), _nrt=False)
def begin_samples(scene, points, edges, paths, own):
    """Begin paths through ``points`` (s, 2) of each of the pixels ``edges``, which have the records ``own``."""
    width = int(scene.reals[WIDTH])
    each = len(points)
    for i in range(each * len(edges)):
        k, s = edges[i // each], i % each
        px, py = k % width + points[s, 0], k // width + points[s, 1]
        begin(scene.reals, px, py, paths[i], own[0, i], own[1, i])


@kernel(_i(SCENE, SCRATCH, ASKED, _i, _i, _i, _many, _stack, _stack, _stack, _stack), _nrt=False)
def look_from_samples(scene, scratch, asked, first, last, each, edges, records, visibility, own, found):
    """The visibility ``found`` of the records ``own`` of samples first..last: that of neighbors alike, else anew.

    Of as many as ``asked`` has room for the rays of; returns where it ends.
    """
    width, height = int(scene.reals[WIDTH]), int(scene.reals[HEIGHT])
    room = asked.shape[0] - 2 * ANEW * (1 + scene.ints[LIGHT_COUNT])
    for i in range(first, last):
        if asked[0, MODE] == ASKING and asked[0, NEXT] > room:
            return i
        x, y = edges[i // each] % width, edges[i // each] // width
        for layer in range(2):
            if own[layer, i, OWNER] == 0.0:
                continue
            if not borrow(records[layer], visibility[layer], own[layer, i], x, y, width, height, found[layer, i]):
                look_around(scene, scratch, asked, own[layer, i], sample_of(x, y), ANEW, ANEW, found[layer, i])
    return last


@kernel(_i(SCENE, _i, _i, _i, _many, _stack, _rows, _reals, _stack, _stack, _reals, _rows), _nrt=False)
def add_samples(scene, each, used, whole, edges, records, radiance, paths, own, found, sums, picture):
    """Add ``each`` samples of the pixels ``edges`` to ``sums`` (n, 4): radiance, and whether all show one smooth thing.

    ``used`` samples there are then, ``whole`` there shall be. Pixels that need no more go to the picture, the others
    to the front of ``edges``; how many these are.
    """
    left = 0
    for p in range(len(edges)):
        k = edges[p]
        red, green, blue, plain = sums[p, 0], sums[p, 1], sums[p, 2], sums[p, 3] != 0.0
        for i in range(p * each, (p + 1) * each):
            r, g, b = 0.0, 0.0, 0.0
            for layer in range(2):
                if own[layer, i, OWNER] != 0.0:
                    dr, dg, db = shade(scene, own[layer, i], found[layer, i])
                    r, g, b = r + dr, g + dg, b + db
            r, g, b = paths[i, GATHERED] + r, paths[i, GATHERED + 1] + g, paths[i, GATHERED + 2] + b
            r, g, b = min(r, BRIGHTEST), min(g, BRIGHTEST), min(b, BRIGHTEST)
            red, green, blue = red + r, green + g, blue + b
            plain = plain and alike(records[0, k], own[0, i], SLACK) and contrast(radiance, k, r, g, b) < 0.5 * CONTRAST
        if used == whole or (used == TRIAL and plain):
            picture[k, 0], picture[k, 1], picture[k, 2] = red / used, green / used, blue / used
        else:
            edges[left] = k
            sums[left, 0], sums[left, 1], sums[left, 2], sums[left, 3] = red, green, blue, 1.0 if plain else 0.0
            left += 1
    return left
