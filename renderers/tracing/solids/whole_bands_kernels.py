# mypy: ignore-errors
"""A band of a picture in one call, in scenes where rays end at what they meet first and all light is of lamps.

Packets, and lanes of plain items beside, are called by their addresses.
"""

from numba import types

from renderers.tracing import layout
from renderers.tracing.camera_kernels import TILE
from renderers.tracing.light.bounce_kernels import WAYS
from renderers.tracing.light.look_lanes_kernels import list_looks, tell_looks
from renderers.tracing.light.ways_kernels import meet_at, plain_at, skin_at
from renderers.tracing.scene_kernels import ASKED, SCENE, SCRATCH, part
from renderers.tracing.solids.bundles_kernels import SOLID
from renderers.tracing.solids.skins_kernels import MEMORY
from renderers.tracing.tiles_kernels import MARKS, fill_background
from renderers.tracing.waves_kernels import describe_hits, end_pixels, list_pixels, meet_first
from sceneql.compiled.kernels import lean

_i = types.int64
_many = types.int64[::1]
_line = types.float64[::1]
_rows = types.float64[:, ::1]
_stack = types.float32[:, :, ::1]


@part
def meet(scene, asked, lanes, plain, meet, of_solid):
    """Intersect all listed rays."""
    meet_at(meet)(*of_solid)
    if plain != 0:
        plain_at(plain)(scene, asked, lanes)


@part
def begin(scratch):
    """As ``scratch.begun``, for a band."""
    for row in range(scratch.shape[0]):
        scratch[row, layout.LOST] = 0.0


@part
def given_up(scratch, shapes):
    """As ``scratch.given_up``."""
    last, lost = scratch.shape[0] - 1, 0
    for row in range(last - shapes, last):
        lost += max(int(scratch[row, layout.LOST]) - layout.MOST_LOST, 0)
    return lost


@part
def wave_of(reached, row, first, tiles):
    """List the reached tiles of a row from the ``first`` on, as many as fit; (their number, the tile behind them)."""
    n, tile = 0, first
    while tile < reached.shape[1] and n < len(tiles):
        if reached[row, tile] != 0:
            tiles[n] = tile
            n += 1
        tile += 1
    return n, tile


@lean(
    types.UniTuple(_i, 2)(
        SCENE, SCRATCH, ASKED, _i, _i, MARKS, MARKS, MARKS, _stack, _stack, types.boolean, types.float32[:, ::1], _many,
        _many, _rows, _rows, _rows, _many, _many, _rows, _rows, WAYS, _line, _line, _i, _i, _i, types.Tuple(MEMORY),
        types.Tuple(SOLID),
    )
)  # fmt: skip
def gather_bands(
    scene, scratch, asked, start, stop, reached, busy, mirrored, records, visibility, final, radiance, tiles, at, cones,
    gathered, paths, of, hits, met, skins, ways, looks, lanes, plain, skin, meet_packets, of_skins, of_solid,
):  # fmt: skip
    """Fill rows start..stop, of one or more bands of TILE rows, as ``Waves.gather``, where no path begins.

    Returns the numbers of unsure pixels, and of rays given up. ``plain`` (or 0), ``skin``, ``meet_packets``: addresses
    of ``plain_lanes_kernels.meet_plain``, ``skins_kernels.skin_hits`` and ``bundles_kernels.meet_asked``; ``lanes``,
    ``of_skins`` and ``of_solid``: what these take. ``tiles``, as long as a wave has tiles, and all from ``at`` to
    ``looks`` are working memory.
    """
    doubted = lost = tile = 0
    band = start
    while band < stop:
        end = min(band + TILE, stop)
        if tile == 0:
            begin(scratch)
            fill_background(scene, band, end, reached, busy, mirrored, records, radiance)
        some, tile = wave_of(reached, band // TILE, tile, tiles)
        if some == 0:
            lost += given_up(scratch, scene.ints[layout.SHAPE_COUNT])
            band, tile = end, 0
            continue
        count = list_pixels(scene, band, end, tiles[:some], asked, cones, at)
        meet(scene, asked, lanes, plain, meet_packets, of_solid)
        _, found = meet_first(scene, scratch, asked, count, cones, at, records, gathered, paths, of, hits, met)
        if found > 0:
            skin_at(skin)(scene, hits[:found], met, skins, *of_skins)
            describe_hits(scene, asked, cones, at, records, gathered, hits[:found], met, skins)
        looked = 0
        while looked < count:
            asked[0, layout.MODE], asked[0, layout.NEXT] = layout.ASKING, 1
            last = list_looks(scene, asked, looked, count, at, records, visibility, looks)
            if asked[0, layout.NEXT] > 1:
                meet(scene, asked, lanes, plain, meet_packets, of_solid)
            asked[0, layout.MODE], asked[0, layout.NEXT] = layout.TELLING, 1
            looked = tell_looks(scene, scratch, asked, ways, looked, last, at, records, visibility)
        unsure, _ = end_pixels(scene, gathered[:count], at, records, visibility, final, radiance, busy, mirrored)
        doubted += unsure
    return doubted, lost
