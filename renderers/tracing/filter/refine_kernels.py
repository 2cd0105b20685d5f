# mypy: ignore-errors
"""Third stage: edges of shadows finer than the filter's window get samples of their own; then all is shaded."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.camera_kernels import TILE
from renderers.tracing.filter.filter_kernels import REACH
from renderers.tracing.filter.planes_kernels import HALO, LANES, SLACK, WIDE
from renderers.tracing.light.bounce_kernels import WAYS
from renderers.tracing.light.sampling_kernels import COUNT, SIDE, SKY_COUNT, sample_of
from renderers.tracing.light.shade_kernels import shade_under, sky_on
from renderers.tracing.light.visibility_kernels import FIRST_LIGHT, light_sample, look_around, shadow_sample
from renderers.tracing.record_kernels import NORMAL, OWNER, RADIUS, alike, enough
from renderers.tracing.scene_kernels import ASKED, SCENE, SCRATCH, part
from renderers.tracing.tiles_kernels import MARKS
from sceneql.compiled.kernels import kernel

_i = types.int64
_rows = types.float32[:, ::1]
_stack = types.float32[:, :, ::1]
CRISP = 1.5
FINE = 3.0
"""Widths [pixels] of penumbras that are searched in 3 x 3 and in 5 x 5 pixels."""
OWN = 16
"""Samples of a light for each pixel of a fine edge."""
ROUGH = 0.03
"""Difference of a light's share from the mean of those SIDE pixels away on both sides, from which on a wide penumbra
takes samples of its own: behind rows of thin things the one of each pixel in the filter's window is too few."""
LEAST, MOST = 0.0001, 0.9999
"""Shares of a light up to which it counts as hidden, and from which on as seen whole."""
FEW, THIN = 20.0, 32
"""Pixels joined by the filter below which a pixel takes samples of the sky of its own, on small or thin surfaces, and
how many it takes below half of FEW; above that half as many."""


@part
def mixed(records, visibility, k, x, y, width, height, column, reach):
    """Whether the one sample of a light differs within ``reach`` pixels on the same surface."""
    for j in range(max(y - reach, 0), min(y + reach, height - 1) + 1):
        for i in range(max(x - reach, 0), min(x + reach, width - 1) + 1):
            m = j * width + i
            if visibility[m, column] != visibility[k, column] and alike(records[k], records[m], SLACK):
                return True
    return False


@part
def mean_of(means, columns, x, y, plane):
    """A pixel's number in a plane of filter_kernels.deepen."""
    return means[y, (x // LANES * (1 + columns) + plane) * WIDE + HALO + x % LANES]


@part
def roughness(records, means, columns, x, y, column):
    """Largest difference, along x and y, of a column's mean from that of the means SIDE pixels away on both sides.

    Windows so far apart have no sample in common. Where one of them is off the surface it is 1.
    """
    height, width = means.shape[0], len(records) // means.shape[0]
    k, most = y * width + x, 0.0
    for axis in range(2):
        along, down = SIDE * (1 - axis), SIDE * axis
        total = 0.0
        for sign in range(-1, 2, 2):
            i, j = x + sign * along, y + sign * down
            if i < 0 or j < 0 or i >= width or j >= height or not alike(records[k], records[j * width + i], SLACK):
                return 1.0
            total += mean_of(means, columns, i, j, 1 + column)
        most = max(most, abs(mean_of(means, columns, x, y, 1 + column) - 0.5 * total))
    return most


@part
def share_of_light(scene, scratch, asked, record, l, number):
    """Visible share of light l by at most OWN / 2 samples of the net of the sky, those of pixel ``number``."""
    total, samples = 0.0, enough(record, OWN // 2)
    for k in range(samples):
        total += light_sample(scene, scratch, asked, record, l, (number * samples + k) % SKY_COUNT)
    return total / samples


@part
def is_even(scene, k, x, y, means, fine):
    """Whether all lights are seen whole or not at all by all that was joined with pixel k, which then is refined."""
    columns = fine.shape[1]
    lights = int(scene.ints[layout.LIGHT_COUNT])
    even = columns == FIRST_LIGHT + 2 * lights  # no mists
    for l in range(lights):
        share = mean_of(means, columns, x, y, 1 + FIRST_LIGHT + 2 * l)
        even = even and (share > MOST or share < LEAST)
        fine[k, FIRST_LIGHT + 2 * l], fine[k, FIRST_LIGHT + 2 * l + 1] = share, 0.0
    return even


@part
def few_for(record):
    """FEW for a record by what its samples are worth: see ``enough``."""
    return FEW * enough(record, THIN) / THIN


@part
def refine_pixel(scene, scratch, asked, ways, k, x, y, width, height, pixels, records, visibility, means, fine):
    """``refine`` for pixel k, at (x, y), of which the filter has joined so many ``pixels``."""
    columns = visibility.shape[1]
    if pixels < few_for(records[k]):
        samples = enough(records[k], THIN if pixels < 0.5 * few_for(records[k]) else THIN // 2)
        told = look_around(scene, scratch, asked, ways, records[k], sample_of(x, y), samples, 0, fine[k])
        for c in range(FIRST_LIGHT if told else 0):
            joined = samples * fine[k, c] + pixels * mean_of(means, columns, x, y, 1 + c)
            fine[k, c] = joined / (samples + pixels)
    for column in range(FIRST_LIGHT + 2 * scene.ints[layout.LIGHT_COUNT], columns):  # what mists leave
        fine[k, column] = mean_of(means, columns, x, y, 1 + column)
    for l in range(int(scene.ints[layout.LIGHT_COUNT]) if asked[0, layout.MODE] != layout.ENDING else 0):
        column = FIRST_LIGHT + 2 * l
        share = mean_of(means, columns, x, y, 1 + column)
        fine[k, column + 1] = 0.0
        fine[k, column] = share
        if share > MOST or share < LEAST:
            continue
        breadth = mean_of(means, columns, x, y, 2 + column)
        edge = breadth / (1.0 - share) / (2.0 * records[k, RADIUS])
        if edge >= SIDE:
            if roughness(records, means, columns, x, y, column) > ROUGH:
                fine[k, column] = share_of_light(scene, scratch, asked, records[k], l, sample_of(x, y))
                fine[k, column + 1] = 2.0
            continue
        reach = 1 if edge < CRISP else (2 if edge < FINE else REACH)
        if reach < REACH and not mixed(records, visibility, k, x, y, width, height, column, reach):
            fine[k, column] = visibility[k, column]
            continue
        samples = enough(records[k], OWN if reach < REACH else OWN // 2)
        total = 0.0
        first = sample_of(x, y) * samples % COUNT
        for sample in range(first, first + samples):
            total += shadow_sample(scene, scratch, asked, records[k], l, sample, 1.0)[0]
        fine[k, column] = total / samples
        fine[k, column + 1] = 1.0 if reach == REACH else 0.0


@kernel(_i(SCENE, SCRATCH, ASKED, WAYS, _i, _i, types.int64[::1], MARKS, _rows, _rows, _rows, _rows), _nrt=False)
def refine(scene, scratch, asked, ways, start, stop, waiting, busy, records, visibility, means, fine):
    """Fill rows of ``fine`` (n, V): for each light its share, and over how many pixels around that is to be smoothed.

    The sky's loss, already there, is resampled where few pixels were joined. For pixels start..stop, or until ``asked``
    has no room for more rays; returns where it ends. Pixels that have listed rays are noted in ``waiting`` (1 + n,),
    behind their number: when these have answers they alone are looked at.
    """
    width, height = int(scene.reals[layout.WIDTH]), int(scene.reals[layout.HEIGHT])
    columns = visibility.shape[1]
    room = asked.shape[0] - THIN - OWN * scene.ints[layout.LIGHT_COUNT]
    asking = asked[0, layout.MODE] == layout.ASKING
    first = asking or asked[0, layout.MODE] == layout.PLAIN
    following, last = (start, stop) if first else (1, int(waiting[0]) + 1)
    if first:
        waiting[0] = 0
    while following < last:
        k = following if first else waiting[following]
        x, y = k % width, k // width
        if first and busy[y // TILE, x // TILE] == 0:
            following += min(TILE - x % TILE, width - x)
            continue
        following += 1
        pixels = mean_of(means, columns, x, y, 0)
        if pixels == 0.0:
            continue
        begin = asked[0, layout.NEXT]
        if asking and begin > room:
            return k
        if first and (pixels >= FEW or pixels >= few_for(records[k])) and is_even(scene, k, x, y, means, fine):
            continue
        refine_pixel(scene, scratch, asked, ways, k, x, y, width, height, pixels, records, visibility, means, fine)
        if asking and asked[0, layout.NEXT] > begin:
            waiting[0] += 1
            waiting[waiting[0]] = k
    return stop


@part
def settle(records, fine, lights, k, x, y, width, height, visibility):
    """Final visibility of a record: as refined; wider penumbras are averaged over 3 x 3 or 5 x 5 pixels.

    Pixels at the rim of 5 x 5 have half of their weight, so that it holds the samples of 4 x 4, which are a net.
    """
    for c in range(len(visibility)):
        visibility[c] = fine[k, c]
    for l in range(lights):
        column = FIRST_LIGHT + 2 * l
        reach = int(fine[k, column + 1])
        if reach == 0:
            continue
        total = joined = 0.0
        for j in range(max(y - reach, 0), min(y + reach, height - 1) + 1):
            for i in range(max(x - reach, 0), min(x + reach, width - 1) + 1):
                m = j * width + i
                if alike(records[k], records[m], SLACK):
                    weight = (0.5 if abs(i - x) == 2 else 1.0) * (0.5 if abs(j - y) == 2 else 1.0)
                    total += weight * fine[m, column]
                    joined += weight
        visibility[column] = total / joined


@kernel(types.void(SCENE, _i, _i, MARKS, _stack, _stack, _stack, _rows), _nrt=False)
def shade_rows(scene, start, stop, busy, records, fine, visibility, radiance):
    """Write the final visibility (2, n, V) and add both records' light to the radiance (n, 3)."""
    width, height = int(scene.reals[layout.WIDTH]), int(scene.reals[layout.HEIGHT])
    rising, open_sky = np.float32(np.nan), (0.0, 0.0, 0.0)  # height of the normal at hand, and the sky's light on it
    for y in range(start, stop):
        for x in range(width):
            if busy[y // TILE, x // TILE] == 0:
                continue
            k = y * width + x
            for layer in range(len(records)):
                if records[layer, k, OWNER] == 0.0:
                    continue
                settle(
                    records[layer],
                    fine[layer],
                    int(scene.ints[layout.LIGHT_COUNT]),
                    k,
                    x,
                    y,
                    width,
                    height,
                    visibility[layer, k],
                )
                if records[layer, k, NORMAL + 1] != rising:
                    rising, open_sky = records[layer, k, NORMAL + 1], sky_on(scene.reals, records[layer, k], False)
                r, g, b = shade_under(scene, records[layer, k], visibility[layer, k], open_sky)
                radiance[k, 0] += r
                radiance[k, 1] += g
                radiance[k, 2] += b
