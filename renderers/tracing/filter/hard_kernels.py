# mypy: ignore-errors
"""Hard light, of lamps without size alone: nothing is filtered, only edges of shadows get samples of their own."""

from numba import types

from renderers.tracing import layout
from renderers.tracing.camera_kernels import TILE
from renderers.tracing.filter.planes_kernels import SLACK
from renderers.tracing.filter.refine_kernels import OWN
from renderers.tracing.light.sampling_kernels import COUNT, sample_of
from renderers.tracing.light.shade_kernels import add_light
from renderers.tracing.light.visibility_kernels import FIRST_LIGHT, shadow_sample
from renderers.tracing.record_kernels import OWNER, alike
from renderers.tracing.scene_kernels import ASKED, SCENE, SCRATCH, part
from renderers.tracing.tiles_kernels import LOSSY, MARKS, busiest
from sceneql.compiled.kernels import kernel

_i = types.int64
_many = types.int64[::1]
_rows = types.float32[:, ::1]


@kernel(types.boolean(SCENE), _nrt=False)
def is_hard(scene):
    """Whether all light is of lamps without size, and none comes from around or through mists."""
    hard = scene.reals[layout.HAS_LIGHT] == 0.0 and scene.mist == 0
    for l in range(scene.ints[layout.LIGHT_COUNT]):
        hard = hard and scene.reals[layout.LIGHTS + layout.LIGHT * l + 7] == 0.0
    return hard


@part
def may_be_cut(visibility, column, k, x, y, width, height):
    """Whether any pixel beside k, at (x, y), may see another share of a light: most are left out by this."""
    if x == 0 or y == 0 or x == width - 1 or y == height - 1:
        return True
    own, up, down = visibility[k, column], k - width, k + width
    across = (visibility[k - 1, column] != own) | (visibility[k + 1, column] != own)
    above = (visibility[up - 1, column] != own) | (visibility[up, column] != own) | (visibility[up + 1, column] != own)
    below = visibility[down - 1, column] != own
    below |= (visibility[down, column] != own) | (visibility[down + 1, column] != own)
    return across | above | below


@part
def is_cut(records, visibility, column, k, x, y, width, height):
    """Whether beside pixel k, at (x, y), another share of a light is seen on the same surface."""
    own = visibility[k, column]
    for j in range(max(y - 1, 0), min(y + 1, height - 1) + 1):
        for m in range(j * width + max(x - 1, 0), j * width + min(x + 1, width - 1) + 1):
            if visibility[m, column] != own and records[m, OWNER] > 0.0 and alike(records[k], records[m], SLACK):
                return True
    return False


@kernel(_i(_i, _i, _i, MARKS, _rows, _rows, _many), _nrt=False)
def list_cuts(start, stop, width, busy, records, visibility, cuts):
    """List the pixels of rows start..stop, from a multiple of TILE on, that edges of shadows run through.

    And of which lights: in ``cuts`` is pixel times number of lights plus light. Returns how many there are.
    """
    height, lights, n = len(records) // width, (visibility.shape[1] - FIRST_LIGHT) // 2, 0
    for row in range(start // TILE, -(-stop // TILE) if lights > 0 else 0):
        for tile in range(busy.shape[1]):
            # All of all lights is seen, around it too.
            if busy[row, tile] == 0 or busiest(busy, row, tile, tile) < LOSSY:
                continue
            for y in range(row * TILE, min((row + 1) * TILE, stop)):
                for x in range(tile * TILE, min((tile + 1) * TILE, width)):
                    k = y * width + x
                    for l in range(lights):
                        column = FIRST_LIGHT + 2 * l
                        if not may_be_cut(visibility, column, k, x, y, width, height) or records[k, OWNER] == 0.0:
                            continue
                        if is_cut(records, visibility, column, k, x, y, width, height):
                            cuts[n] = k * lights + l
                            n += 1
    return n


@kernel(_i(SCENE, SCRATCH, ASKED, _i, _i, _many, _rows, _rows, _rows), _nrt=False)
def soften(scene, scratch, asked, first, last, cuts, records, visibility, radiance):
    """Sample the lights of the pixels ``cuts[first:last]`` anew, over all of each pixel, and light it so.

    Stops where ``asked`` has no room for more rays; returns where it ends.
    """
    width, lights = int(scene.reals[layout.WIDTH]), int(scene.ints[layout.LIGHT_COUNT])
    for i in range(first, last):
        if asked[0, layout.MODE] == layout.ASKING and asked[0, layout.NEXT] > asked.shape[0] - OWN:
            return i
        k, l = cuts[i] // lights, cuts[i] % lights
        total = 0.0
        begin = sample_of(k % width, k // width) * OWN % COUNT
        for sample in range(begin, begin + OWN):
            total += shadow_sample(scene, scratch, asked, records[k], l, sample, 1.0)[0]
        if asked[0, layout.MODE] != layout.ASKING:
            add_light(scene, records[k], visibility[k], radiance[k], -1.0)
            visibility[k, FIRST_LIGHT + 2 * l] = total / OWN
            add_light(scene, records[k], visibility[k], radiance[k], 1.0)
    return last
