# mypy: ignore-errors
"""Last stage: pixels on edges are drawn anew by several rays, lit by the visibility found before."""

from numba import types

from renderers.tracing import layout
from renderers.tracing.camera_kernels import TILE, place_of
from renderers.tracing.filter.planes_kernels import HALO, LANES, LINE, ONE, OWN, SLACK, ZERO, alike_lanes, one_face
from renderers.tracing.light.bounce_kernels import WAYS
from renderers.tracing.light.sampling_kernels import sample_of
from renderers.tracing.light.shade_kernels import shade
from renderers.tracing.light.visibility_kernels import look_around
from renderers.tracing.record_kernels import OWNER, TRACED, UNSURE, alike, enough
from renderers.tracing.scene_kernels import ASKED, SCENE, SCRATCH, part
from renderers.tracing.tiles_kernels import ACROSS, MARKS, busiest
from renderers.tracing.waves_kernels import list_ray
from sceneql.compiled.kernels import kernel

_i = types.int64
_rows = types.float32[:, ::1]
_stack = types.float32[:, :, ::1]
_reals = types.float64[:, ::1]
_many = types.int64[::1]
BEYOND = 0.25
"""How much brighter than white a ray may count in the mean of a pixel: about as much as the eye sees."""
CONTRAST = 0.08
"""Relative difference of radiance from which on neighboring pixels with reflections count as an edge."""
TRIAL = 4
"""Rays after which a pixel is finished if all of them show one smooth surface."""
ANEW = 8
"""Samples of light and sky for a ray that meets a surface that no neighboring pixel shows."""


@part
def tamed(r, g, b):
    """A radiance brighter than white, compressed from its brightest channel p to 1 + BEYOND (1 - 1/p).

    Rays of a pixel are averaged so (after Karis 2013): in a plain mean one of eight that meets a highlight of radiance
    16 would make the pixel as white as if all met it, and bright edges and lines would be jagged.
    """
    peak = max(r, max(g, b))
    if peak <= 1.0:
        return r, g, b
    share = (1.0 + BEYOND * (1.0 - 1.0 / peak)) / peak
    return share * r, share * g, share * b


@part
def untamed(r, g, b):
    """The inverse of ``tamed``."""
    peak = max(r, max(g, b))
    if peak <= 1.0:
        return r, g, b
    share = 1.0 / (max(1.0 - (peak - 1.0) / BEYOND, 1e-4) * peak)
    return share * r, share * g, share * b


@part
def contrast(radiance, k, red, green, blue):
    """Largest relative difference of a pixel from a radiance over the channels."""
    r, g, b = min(radiance[k, 0], 4.0), min(radiance[k, 1], 4.0), min(radiance[k, 2], 4.0)
    red, green, blue = min(red, 4.0), min(green, 4.0), min(blue, 4.0)
    worst = max(abs(r - red) / (0.1 + r + red), abs(g - green) / (0.1 + g + green))
    return max(worst, abs(b - blue) / (0.1 + b + blue))


@part
def mark_edges(y, planes, size, chunk, same, marks):
    """Set marks to 1 for the pixels of a chunk in row y whose neighbors show another surface, else to 0."""
    a, flat = planes[y, chunk * size + HALO :], True
    for i in range(LANES):
        marks[i] = ZERO
    for row in range(max(y - 1, 0), min(y + 1, planes.shape[0] - 1) + 1):
        flat = flat and one_face(planes[y, chunk * size :], planes[row, chunk * size :])
    if flat:
        return
    for place in range(9):
        row, off = y + place // 3 - 1, place % 3 - 1
        if place == 4 or row < 0 or row >= planes.shape[0]:
            continue
        b = planes[row, chunk * size + HALO + off :]
        alike_lanes(a, b, same)
        for i in range(LANES):
            nothing = (a[OWN + i] == ZERO) & (b[OWN + i] == ZERO)
            marks[i] = marks[i] if nothing | (same[i] > ZERO) | (b[OWN + i] < ZERO) else ONE


@part
def marked(marks, first, start, stop):
    """Whether any pixel of a tile is marked, the rows start..stop of TILE columns from the ``first`` one on."""
    found = False
    for y in range(stop - start):
        for x in range(first, first + TILE):
            found = found | (marks[y, x] > ZERO)
    return found


@part
def unlike(records, radiance, k, x, y, width, height):
    """Whether a pixel's neighborhood has an undecided root, a thin capsule or, if it is a mirror, another radiance."""
    glossy = records[0, k, TRACED] > 0.0
    for j in range(max(y - 1, 0), min(y + 1, height - 1) + 1):
        for i in range(max(x - 1, 0), min(x + 1, width - 1) + 1):
            m = j * width + i
            if records[0, m, UNSURE] != 0.0:
                return True
            if m == k or not glossy:
                continue
            if contrast(radiance, k, radiance[m, 0], radiance[m, 1], radiance[m, 2]) > CONTRAST:
                return True
    return False


@part
def borrow(records, visibility, record, x, y, width, height, found):
    """Fill ``found`` with the mean visibility of pixels around (x, y) alike a record; returns whether there are any.

    For a record of which one sample is ``enough`` the pixel itself will do.
    """
    count, k = 0, y * width + x
    if enough(record, ANEW) == 1 and records[k, OWNER] > 0.0 and alike(record, records[k], SLACK):
        for c in range(len(found)):
            found[c] = visibility[k, c]
        return True
    for j in range(max(y - 1, 0), min(y + 1, height - 1) + 1):
        for i in range(max(x - 1, 0), min(x + 1, width - 1) + 1):
            m = j * width + i
            if records[m, OWNER] > 0.0 and alike(record, records[m], SLACK):
                for c in range(len(found)):
                    found[c] = visibility[m, c] + (found[c] if count > 0 else 0.0)
                count += 1
    for c in range(len(found) if count > 0 else 0):
        found[c] /= count
    return count > 0


@kernel(_i(_i, _i, _i, _i, _i, MARKS, _rows, _stack, _rows, _rows, _rows, LINE, _many), _nrt=False)
def list_edges(start, stop, width, size, undecided, busy, planes, records, radiance, picture, marks, same, edges):
    """List the pixels of rows start..stop, at most TILE, that are to be drawn anew; all get their light in the picture.

    ``size`` of a chunk of ``planes``, those of the first records; ``undecided`` roots in the picture, or thin capsules:
    pixels with one are drawn anew as well. ``busy`` (rows of tiles, tiles) are 0 of tiles of nothing but background.
    ``marks`` (TILE, chunks LANES) and ``same`` (LANES,) are working memory.
    """
    row = start // TILE
    for chunk in range(planes.shape[1] // size):
        if busiest(busy, row, ACROSS * chunk, ACROSS * chunk + ACROSS - 1) != 0:
            for y in range(start, stop):
                mark_edges(y, planes, size, chunk, same, marks[y - start, chunk * LANES :])
    for k in range(start * width, stop * width):
        for c in range(3):
            picture[k, c] = radiance[k, c]
    mirrors = len(records) > 1  # see waves_kernels.layers_of
    n, i = 0, -1
    while i + 1 < len(edges):
        i += 1
        if i % (TILE * TILE) == 0 and (
            busiest(busy, row, i // (TILE * TILE), i // (TILE * TILE)) == 0
            or not (mirrors or undecided > 0 or marked(marks, i // TILE, start, stop))
        ):
            i += TILE * TILE - 1
            continue
        x, y = place_of(i)
        y += start
        if x >= width or y >= stop:
            continue
        k = y * width + x
        edge = marks[y - start, x] > 0.0
        if not edge and (undecided > 0 or (mirrors and records[0, k, TRACED] > 0.0)):
            edge = unlike(records, radiance, k, x, y, width, planes.shape[0])
        if edge:
            edges[n] = k
            n += 1
    return n


@kernel(types.void(SCENE, _reals, _many, ASKED, _reals), _nrt=False)
def list_samples(scene, points, edges, asked, cones):
    """List the camera's rays through ``points`` (s, 2) of each of the pixels ``edges``, as ``list_pixels``."""
    width = int(scene.reals[layout.WIDTH])
    each = len(points)
    for i in range(each * len(edges)):
        k, s = edges[i // each], i % each
        list_ray(scene, asked, cones, i, k % width + points[s, 0], k // width + points[s, 1], s)
    asked[0, layout.NEXT] = 1 + each * len(edges)


@kernel(_i(SCENE, SCRATCH, ASKED, WAYS, _i, _i, _i, _many, _stack, _stack, _stack, _stack), _nrt=False)
def look_from_samples(scene, scratch, asked, ways, first, last, each, edges, records, visibility, own, found):
    """The visibility ``found`` of the records ``own`` of samples first..last: borrowed from neighbors, or else sampled.

    Stops where ``asked`` has no room for more rays; returns where it ends.
    """
    width, height = int(scene.reals[layout.WIDTH]), int(scene.reals[layout.HEIGHT])
    room = asked.shape[0] - 2 * ANEW * (1 + scene.ints[layout.LIGHT_COUNT])
    mode = asked[0, layout.MODE]
    first_time = mode == layout.ASKING or mode == layout.PLAIN
    for i in range(first, last):
        if mode == layout.ASKING and asked[0, layout.NEXT] > room:
            return i
        x, y = edges[i // each] % width, edges[i // each] // width
        for layer in range(len(own)):
            if own[layer, i, OWNER] == 0.0:
                continue
            told = first_time and borrow(
                records[layer], visibility[layer], own[layer, i], x, y, width, height, found[layer, i]
            )
            if not told:  # look_around leaves the rows alone that are final already
                some = enough(own[layer, i], ANEW)
                look_around(scene, scratch, asked, ways, own[layer, i], sample_of(x, y), some, some, found[layer, i])
    return last


@kernel(_i(SCENE, _i, _i, _i, _many, _stack, _rows, _reals, _stack, _stack, _reals, _rows), _nrt=False)
def add_samples(scene, each, used, whole, edges, records, radiance, gathered, own, found, sums, picture):
    """Add ``each`` samples of the pixels ``edges`` to ``sums`` (n, 4): tamed light, and whether all show one surface.

    ``used`` samples are there then, of ``whole``. Finished pixels go to the picture, the others to the front of
    ``edges``; returns their number.
    """
    left = 0
    for p in range(len(edges)):
        k = edges[p]
        red, green, blue = sums[p, 0], sums[p, 1], sums[p, 2]
        plain = sums[p, 3] != 0.0 and records[0, k, UNSURE] == 0.0
        for i in range(p * each, (p + 1) * each):
            r, g, b = 0.0, 0.0, 0.0
            for layer in range(len(own)):
                if own[layer, i, OWNER] != 0.0:
                    dr, dg, db = shade(scene, own[layer, i], found[layer, i])
                    r, g, b = r + dr, g + dg, b + db
            r, g, b = gathered[i, 0] + r, gathered[i, 1] + g, gathered[i, 2] + b
            plain = (
                plain
                and gathered[i, 3] == 0.0
                and alike(records[0, k], own[0, i], SLACK)
                and contrast(radiance, k, r, g, b) < 0.5 * CONTRAST
            )
            r, g, b = tamed(r, g, b)
            red, green, blue = red + r, green + g, blue + b
        if used == whole or (used == TRIAL and plain):
            picture[k, 0], picture[k, 1], picture[k, 2] = untamed(red / used, green / used, blue / used)
        else:
            edges[left] = k
            sums[left, 0], sums[left, 1], sums[left, 2], sums[left, 3] = red, green, blue, 1.0 if plain else 0.0
            left += 1
    return left
