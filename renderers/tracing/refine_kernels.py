# mypy: ignore-errors
"""Third stage: edges of shadows finer than the filter's window get samples of their own; then all is shaded."""

from numba import types

from renderers.tracing.filter_kernels import REACH, SLACK
from renderers.tracing.record_kernels import OWNER, RADIUS, alike
from renderers.tracing.sampling_kernels import COUNT, SIDE, sample_of
from renderers.tracing.scene_kernels import ASKED, ASKING, HEIGHT, LIGHT_COUNT, MODE, NEXT, SCENE, SCRATCH, WIDTH, part
from renderers.tracing.shade_kernels import shade
from renderers.tracing.visibility_kernels import FIRST_LIGHT, look_around, shadow_sample
from sceneql.kernels import kernel

_i = types.int64
_rows = types.float32[:, ::1]
_stack = types.float32[:, :, ::1]
CRISP = 1.5
FINE = 3.0
"""Widths [pixels] of half-shadows that are searched for in 3 x 3 and in 5 x 5 pixels."""
OWN = 16
"""Samples of a light for each pixel of a fine edge."""
FEW = 20.0
"""Pixels in the filter's window below which a pixel takes samples of the sky of its own: small things, thin things."""


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
def join(records, means, k, i, j, width, height, share, fine):
    """Add ``share`` times the sky's loss over 8 x 8 pixels about (i, j), if it is like pixel k; the weight of that."""
    if i < 0 or j < 0 or i >= width or j >= height:
        return 0.0
    m = j * width + i
    if m != k and not alike(records[k], records[m], SLACK):
        return 0.0
    weight = share * means[m, 0]
    for c in range(FIRST_LIGHT):
        fine[c] += weight * means[m, 1 + c]
    return weight


@part
def spread_sky(records, means, k, x, y, width, height, fine):
    """The sky's loss over 24 x 24 pixels, from nine means over 8 x 8 of weights 1 2 1, 2 4 2, 1 2 1.

    Each of its samples, one in 16 x 16 pixels, has the same weight in all, and those that come in and go out where the
    window moves have half of what they have in a plain window, so that stripes are fainter. Where other things are so
    near: a plain window of 16 x 16 pixels, from four means.
    """
    weight = 0.0
    for c in range(FIRST_LIGHT):
        fine[c] = 0.0
    for place in range(9):
        across, down = place % 3 - 1, place // 3 - 1
        share = float((2 - abs(across)) * (2 - abs(down)))
        weight += join(records, means, k, x + SIDE * across, y + SIDE * down, width, height, share, fine)
    if weight < 16.0 * SIDE * SIDE:
        weight = 0.0
        for c in range(FIRST_LIGHT):
            fine[c] = 0.0
        for corner in range(4):
            i, j = x + REACH * (2 * (corner & 1) - 1), y + REACH * ((corner & 2) - 1)
            weight += join(records, means, k, i, j, width, height, 1.0, fine)
        if weight < 4.0 * SIDE * SIDE:  # a window cut by an edge: its middle stands in
            weight += join(records, means, k, x, y, width, height, 1.0, fine)
    for c in range(FIRST_LIGHT):
        fine[c] /= weight


@kernel(_i(SCENE, SCRATCH, ASKED, _i, _i, _rows, _rows, _rows, _rows), _nrt=False)
def refine(scene, scratch, asked, start, stop, records, visibility, means, fine):
    """Rows of ``fine`` (n, V): the sky's loss; of each light its share, and whether that wants smoothing (0 or 1).

    Of pixels start..stop, or as many as ``asked`` has room for the rays of; returns where it ends.
    """
    width, height = int(scene.reals[WIDTH]), int(scene.reals[HEIGHT])
    room = asked.shape[0] - OWN * (1 + scene.ints[LIGHT_COUNT])
    for k in range(start, stop):
        if records[k, OWNER] == 0.0:
            continue
        if asked[0, MODE] == ASKING and asked[0, NEXT] > room:
            return k
        x, y = k % width, k // width
        if means[k, 0] < FEW:
            samples = OWN if means[k, 0] < 0.5 * FEW else OWN // 2
            look_around(scene, scratch, asked, records[k], sample_of(x, y), samples, 0, fine[k])
            for c in range(FIRST_LIGHT):
                joined = samples * fine[k, c] + means[k, 0] * means[k, 1 + c]
                fine[k, c] = joined / (samples + means[k, 0])
        else:
            spread_sky(records, means, k, x, y, width, height, fine[k])
        for l in range(int(scene.ints[LIGHT_COUNT])):
            column = FIRST_LIGHT + 2 * l
            share = means[k, 1 + column]
            fine[k, column + 1] = 0.0
            fine[k, column] = share
            if share > 0.9999 or share < 0.0001:
                continue
            pixels = means[k, 2 + column] / (1.0 - share) / (2.0 * records[k, RADIUS])
            if pixels >= SIDE:
                continue
            reach = 1 if pixels < CRISP else (2 if pixels < FINE else REACH)
            if reach < REACH and not mixed(records, visibility, k, x, y, width, height, column, reach):
                fine[k, column] = visibility[k, column]
                continue
            samples = OWN if reach < REACH else OWN // 2
            total = 0.0
            first = sample_of(x, y) * samples % COUNT
            for sample in range(first, first + samples):
                total += shadow_sample(scene, scratch, asked, records[k], l, sample, 1.0)[0]
            fine[k, column] = total / samples
            fine[k, column + 1] = 1.0 if reach == REACH else 0.0
    return stop


@part
def settle(records, fine, lights, k, x, y, width, height, visibility):
    """Final visibility of a record: as refined, edges of middling width averaged over 3 x 3 pixels."""
    for c in range(len(visibility)):
        visibility[c] = fine[k, c]
    for l in range(lights):
        column = FIRST_LIGHT + 2 * l
        if fine[k, column + 1] == 0.0:
            continue
        total = 0.0
        count = 0
        for j in range(max(y - 1, 0), min(y + 1, height - 1) + 1):
            for i in range(max(x - 1, 0), min(x + 1, width - 1) + 1):
                m = j * width + i
                if alike(records[k], records[m], SLACK):
                    total += fine[m, column]
                    count += 1
        visibility[column] = total / count


@kernel(types.void(SCENE, _i, _i, _stack, _stack, _stack, _rows), _nrt=False)
def shade_rows(scene, start, stop, records, fine, visibility, radiance):
    """Write the final visibility (2, n, V) and add both records' light to the radiance (n, 3)."""
    width, height = int(scene.reals[WIDTH]), int(scene.reals[HEIGHT])
    for y in range(start, stop):
        for x in range(width):
            k = y * width + x
            for layer in range(2):
                if records[layer, k, OWNER] == 0.0:
                    continue
                settle(
                    records[layer],
                    fine[layer],
                    int(scene.ints[LIGHT_COUNT]),
                    k,
                    x,
                    y,
                    width,
                    height,
                    visibility[layer, k],
                )
                r, g, b = shade(scene, records[layer, k], visibility[layer, k])
                radiance[k, 0] += r
                radiance[k, 1] += g
                radiance[k, 2] += b
