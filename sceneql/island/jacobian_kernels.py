# mypy: ignore-errors
"""An island's Jacobian, assembled from the slopes of its terms."""

from sceneql.compiled.kernels import lean
from sceneql.compiled.threads_kernels import TILE, over_threads
from sceneql.island import layout
from sceneql.system.signatures_kernels import TERM


@lean(TILE)
def block_tile(number, t, y, values, floats, ints):
    """Sum the entries, stored behind the values, to the 3x3 blocks of a tile and multiply by inverse masses."""
    at = ints[layout.SLOPES_AT]
    count, blocks, tiles = ints[at + layout.VALUES], ints[at + layout.BLOCKS], ints[at + layout.BLOCK_TILES]
    table, parts = ints[at + layout.BLOCKS_AT], ints[at + layout.BLOCK_PARTS_AT]
    for b in range(blocks * number // tiles, blocks * (number + 1) // tiles):
        s0 = s1 = s2 = s3 = s4 = s5 = s6 = s7 = s8 = 0.0
        for k in range(parts + ints[table + 2 * b], parts + ints[table + 2 * b + 2]):
            sign = 1.0 if ints[k] >= 0 else -1.0
            e = count + (ints[k] if ints[k] >= 0 else -1 - ints[k])
            s0 += sign * values[e]
            s1 += sign * values[e + 1]
            s2 += sign * values[e + 2]
            s3 += sign * values[e + 3]
            s4 += sign * values[e + 4]
            s5 += sign * values[e + 5]
            s6 += sign * values[e + 6]
            s7 += sign * values[e + 7]
            s8 += sign * values[e + 8]
        mass = ints[table + 2 * b + 1]
        inverse = floats[mass] if mass >= 0 else 1.0
        v = 9 * b
        values[v], values[v + 1], values[v + 2] = inverse * s0, inverse * s1, inverse * s2
        values[v + 3], values[v + 4], values[v + 5] = inverse * s3, inverse * s4, inverse * s5
        values[v + 6], values[v + 7], values[v + 8] = inverse * s6, inverse * s7, inverse * s8


@lean(TILE)
def single_tile(number, t, y, values, floats, ints):
    """Sum the entries to the single values of a tile likewise; single entries inside blocks are added to these."""
    at = ints[layout.SLOPES_AT]
    count, singles, tiles = ints[at + layout.VALUES], ints[at + layout.SINGLES], ints[at + layout.SINGLE_TILES]
    table, parts = ints[at + layout.SINGLES_AT], ints[at + layout.SINGLE_PARTS_AT]
    for s in range(singles * number // tiles, singles * (number + 1) // tiles):
        row = table + 3 * s
        total = 0.0
        for k in range(parts + ints[row + 2], parts + ints[row + 5]):
            if ints[k] >= 0:
                total += values[count + ints[k]]
            else:
                total -= values[count - 1 - ints[k]]
        if ints[row + 1] >= 0:
            total *= floats[ints[row + 1]]
        values[ints[row]] = total + (values[ints[row]] if ints[row] < 9 * ints[at + layout.BLOCKS] else 0.0)


@lean(TERM, inner=True)
def gather(t, y, values, floats, ints):
    """Sum the entries to values and multiply rows by inverse masses: the same bytes for any number of threads."""
    at = ints[layout.SLOPES_AT]
    entry, threads = ints[at + layout.ENTRY], ints[at + layout.THREADS]
    block_tiles, single_tiles = ints[at + layout.BLOCK_TILES], ints[at + layout.SINGLE_TILES]
    if block_tiles == 1:
        block_tile(0, t, y, values, floats, ints)
    else:
        over_threads(entry, threads, ints[at + layout.BLOCK_TILE_AT], block_tiles, t, y, values, floats, ints)
    if single_tiles == 1:
        single_tile(0, t, y, values, floats, ints)
    else:
        over_threads(entry, threads, ints[at + layout.SINGLE_TILE_AT], single_tiles, t, y, values, floats, ints)
