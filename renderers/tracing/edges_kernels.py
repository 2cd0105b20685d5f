# mypy: ignore-errors
"""Last stage: pixels in which things meet are drawn anew by several rays, lit by the visibility already found."""

from numba import types

from renderers.tracing.filter_kernels import SLACK
from renderers.tracing.gather_kernels import GATHERED, PLACES, gather
from renderers.tracing.record_kernels import OWNER, TRACED, alike
from renderers.tracing.sampling_kernels import sample_of
from renderers.tracing.scene_kernels import ASKED, HEIGHT, ROW, SCENE, SCRATCH, WIDTH, part
from renderers.tracing.shade_kernels import shade
from renderers.tracing.visibility_kernels import look_around
from sceneql.kernels import kernel

_i = types.int64
_rows = types.float32[:, ::1]
_stack = types.float32[:, :, ::1]
BRIGHTEST = 16.0
"""Radiance to which one of a pixel's rays is limited, so that a bright spot's edge does not flicker."""
CONTRAST = 0.08
"""Difference of brightness, relative to the sum, at which pixels with reflections count as an edge."""
TRIAL = 4
"""Rays after which a pixel is left that shows, after all, one smooth thing."""
ANEW = 8
"""Samples of light and sky for a ray that meets what no neighboring pixel has met."""


@part
def contrast(radiance, k, red, green, blue):
    """Largest relative difference of a pixel from a radiance over the channels."""
    r, g, b = min(radiance[k, 0], 4.0), min(radiance[k, 1], 4.0), min(radiance[k, 2], 4.0)
    red, green, blue = min(red, 4.0), min(green, 4.0), min(blue, 4.0)
    worst = max(abs(r - red) / (0.1 + r + red), abs(g - green) / (0.1 + g + green))
    return max(worst, abs(b - blue) / (0.1 + b + blue))


@part
def jagged(records, radiance, k, x, y, width, height):
    """Whether a pixel's neighbors show something else than it does."""
    glossy = records[0, k, TRACED] > 0.0
    for j in range(max(y - 1, 0), min(y + 1, height - 1) + 1):
        for i in range(max(x - 1, 0), min(x + 1, width - 1) + 1):
            m = j * width + i
            if m == k:
                continue
            if records[0, m, OWNER] != records[0, k, OWNER]:
                return True
            if records[0, k, OWNER] > 0.0 and not alike(records[0, k], records[0, m], SLACK):
                return True
            if glossy and contrast(radiance, k, radiance[m, 0], radiance[m, 1], radiance[m, 2]) > CONTRAST:
                return True
    return False


@part
def borrow(records, visibility, record, x, y, width, height, found):
    """Fill ``found`` with the mean visibility of pixels around (x, y) that are like a record; whether there is one."""
    count = 0
    for c in range(len(found)):
        found[c] = 0.0
    for j in range(max(y - 1, 0), min(y + 1, height - 1) + 1):
        for i in range(max(x - 1, 0), min(x + 1, width - 1) + 1):
            m = j * width + i
            if records[m, OWNER] > 0.0 and alike(record, records[m], SLACK):
                count += 1
                for c in range(len(found)):
                    found[c] += visibility[m, c]
    for c in range(len(found)):
        found[c] /= max(count, 1)
    return count > 0


@part
def finished(scene, scratch, asked, records, visibility, own, k, x, y, number, found):
    """Radiance (3) of the two records ``own`` (3, COLUMNS) of one ray through pixel (x, y)."""
    width, height = int(scene.reals[WIDTH]), int(scene.reals[HEIGHT])
    r, g, b = 0.0, 0.0, 0.0
    for layer in range(2):
        if own[layer, OWNER] == 0.0:
            continue
        if not borrow(records[layer], visibility[layer], own[layer], x, y, width, height, found):
            look_around(scene, scratch, asked, own[layer], number, ANEW, ANEW, found)
        red, green, blue = shade(scene, own[layer], found)
        r, g, b = r + red, g + green, b + blue
    return r, g, b


@kernel(
    _i(SCENE, SCRATCH, ASKED, _i, _i, types.float64[:, ::1], _stack, _rows, _stack, PLACES, _rows, ROW, _rows),
    _nrt=False,
)
def smooth_rows(scene, scratch, asked, start, stop, points, records, radiance, visibility, path, own, found, picture):
    """Fill rows start..stop of ``picture`` (n, 3): as ``radiance``, edges by one ray for each of ``points`` (s, 2).

    ``path`` (PATH,), ``own`` (3, COLUMNS) and ``found`` (V,) are working memory. Returns the number of pixels drawn
    anew.
    """
    width, height = int(scene.reals[WIDTH]), int(scene.reals[HEIGHT])
    anew = 0
    for y in range(start, stop):
        for x in range(width):
            k = y * width + x
            if not jagged(records, radiance, k, x, y, width, height):
                for c in range(3):
                    picture[k, c] = radiance[k, c]
                continue
            anew += 1
            number = sample_of(x, y)
            red, green, blue = 0.0, 0.0, 0.0
            used = 0
            plain = True
            for s in range(len(points)):
                if used == TRIAL and plain:
                    break
                px, py = x + points[s, 0], y + points[s, 1]
                gather(scene, scratch, asked, px, py, path, own[0], own[1], own[2], found)
                r, g, b = path[GATHERED], path[GATHERED + 1], path[GATHERED + 2]
                fr, fg, fb = finished(scene, scratch, asked, records, visibility, own, k, x, y, number, found)
                r, g, b = min(r + fr, BRIGHTEST), min(g + fg, BRIGHTEST), min(b + fb, BRIGHTEST)
                red, green, blue = red + r, green + g, blue + b
                used += 1
                plain = (
                    plain and alike(records[0, k], own[0], SLACK) and contrast(radiance, k, r, g, b) < 0.5 * CONTRAST
                )
            picture[k, 0] = red / used
            picture[k, 1] = green / used
            picture[k, 2] = blue / used
    return anew
