# mypy: ignore-errors
"""Tiles of the picture: which of them rays from the camera may meet something in; the others are background at once."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.camera_kernels import TILE, camera_ray
from renderers.tracing.light.light_kernels import backdrop
from renderers.tracing.light.visibility_kernels import FIRST_LIGHT, SKY
from renderers.tracing.record_kernels import OWNER, UNSURE, erase
from renderers.tracing.scene_kernels import SCENE, part
from sceneql.compiled.kernels import kernel

_i = types.int64
_rows = types.float32[:, ::1]
_stack = types.float32[:, :, ::1]
MARKS = types.int8[:, ::1]
"""Type of marks of tiles, (rows of tiles, tiles in a row)."""
SHOWN, LOSSY = 1, 2
"""Marks of busy tiles."""
BLANK, WIPE, LAY = range(3)
"""Of a chunk of pixels: nothing is there, and nothing was in the picture before; only that was; something is there."""
ACROSS = 4
"""Tiles of a chunk of pixels (planes_kernels.LANES)."""
RIM = 1.0
"""Pixels about the outline of a box that count as its own."""


@part
def outline(u, box):
    """(whether a box in the reals ``u`` may be seen, its bounds left, right, top and bottom [pixels]).

    A box that reaches behind the camera is seen everywhere.
    """
    at = layout.CAMERA
    width, height, half_height = u[layout.WIDTH], u[layout.HEIGHT], u[at + 12]
    left, right, top, bottom = np.inf, -np.inf, np.inf, -np.inf
    before = 0
    for corner in range(8):
        x = u[box + 3 * (corner & 1)] - u[at]
        y = u[box + 1 + 3 * ((corner >> 1) & 1)] - u[at + 1]
        z = u[box + 2 + 3 * (corner >> 2)] - u[at + 2]
        across = x * u[at + 3] + y * u[at + 4] + z * u[at + 5]
        up = x * u[at + 6] + y * u[at + 7] + z * u[at + 8]
        if u[at + 13] == 0.0:
            depth = -(x * u[at + 9] + y * u[at + 10] + z * u[at + 11])
            before += depth > 1e-9 * (abs(x) + abs(y) + abs(z))
            across, up = across / depth, up / depth
        column = 0.5 * (width + across / half_height * height)
        row = 0.5 * height * (1.0 - up / half_height)
        left, right = min(left, column), max(right, column)
        top, bottom = min(top, row), max(bottom, row)
    if u[at + 13] == 0.0 and before < 8:
        return before > 0, -np.inf, np.inf, -np.inf, np.inf
    return True, left - RIM, right + RIM, top - RIM, bottom + RIM


@part
def tile_at(pixels, count):
    """The tile at a place [pixels], one of ``count``."""
    return int(min(max(np.floor(pixels / TILE), -1.0), float(count)))


@part
def ball_of(scene, link):
    """Place in the reals of the ball of a leaf of one implicit object that has one; -1 for other nodes."""
    if scene.ints[link + 2] != 1:
        return -1
    item = layout.ITEMS + 4 * scene.ints[link + 1]
    at = scene.ints[item + layout.REALS_AT] + layout.BALL
    return at if scene.ints[item + layout.KIND] == layout.IMPLICIT and scene.reals[at + 3] < np.inf else -1


@part
def in_tile(u, ball, x, y):
    """Whether a camera's ray of tile (x, y) may meet a ball in the reals ``u``.

    All of the tile's rays are within a cone around the middle one; with rays through points some pixels off.
    """
    ox, oy, oz, dx, dy, dz, pixel, spread = camera_ray(u, (x + 0.5) * TILE, (y + 0.5) * TILE)
    px, py, pz, radius = u[ball] - ox, u[ball + 1] - oy, u[ball + 2] - oz, u[ball + 3]
    off = 2.0 * (RIM + np.sqrt(0.5) * TILE)
    square = px * px + py * py + pz * pz
    if spread > 0.0:  # of rays at least 1 - off spread as long before they were made unit vectors
        if off * spread > 0.5:
            return True
        radius += (np.sqrt(square) + radius) * off * spread / (1.0 - off * spread)
    radius += off * pixel
    along = max(px * dx + py * dy + pz * dz, 0.0)
    px, py, pz = px - along * dx, py - along * dy, pz - along * dz
    return px * px + py * py + pz * pz <= radius * radius * (1.0 + 1e-9)


@kernel(types.void(SCENE, MARKS), _nrt=False)
def reach(scene, reached):
    """Mark the tiles in which a ray of a pixel may meet an item: by outlines of boxes, of the hierarchy and mists, and
    of balls."""
    rows, columns = reached.shape
    everywhere = 1 if scene.ints[layout.ENDLESS_COUNT] > 0 else 0
    for y in range(rows):
        for x in range(columns):
            reached[y, x] = everywhere
    n = scene.ints[layout.NODE_COUNT] if everywhere else 1
    while n < scene.ints[layout.NODE_COUNT]:
        link = scene.ints[layout.LINKS_AT] + layout.LINK * n
        seen, left, right, top, bottom = outline(scene.reals, scene.ints[layout.NODES_AT] + 6 * n)
        first, last = max(tile_at(left, columns), 0), min(tile_at(right, columns), columns - 1)
        begin, end = max(tile_at(top, rows), 0), min(tile_at(bottom, rows), rows - 1)
        if not seen or first > last or begin > end:
            n = scene.ints[link]
        elif scene.ints[link + 2] == 0 and (last > first + 1 or end > begin + 1):
            n += 1
        else:
            ball = ball_of(scene, link)
            for y in range(begin, end + 1):
                for x in range(first, last + 1):
                    if ball < 0 or in_tile(scene.reals, ball, x, y):
                        reached[y, x] = 1
            # Behind a leaf the nodes of a mesh that has its own may follow: they are inside of the leaf's box.
            n = scene.ints[link]
    for m in range(scene.ints[layout.MISTS]):
        box = scene.ints[scene.ints[layout.MISTS_AT] + m] + layout.MIST_BOX
        seen, left, right, top, bottom = outline(scene.reals, box)
        for y in range(max(tile_at(top, rows), 0), (min(tile_at(bottom, rows), rows - 1) if seen else -1) + 1):
            for x in range(max(tile_at(left, columns), 0), min(tile_at(right, columns), columns - 1) + 1):
                reached[y, x] = 1


@part
def erase_tile(records, first, start, stop, tile, width):
    """Empty the records of a tile of rows start..stop, from the ``first`` layer on."""
    for y in range(start, stop):
        for k in range(y * width + tile * TILE, y * width + min((tile + 1) * TILE, width)):
            for layer in range(first, len(records)):
                erase(records[layer, k])


@kernel(types.void(SCENE, _i, _i, MARKS, MARKS, MARKS, _stack, _rows), _nrt=False)
def fill_background(scene, start, stop, reached, busy, mirrored, records, radiance):
    """Draw the tiles of rows start..stop, at most TILE, that are not ``reached``; erase their records if ``busy``.

    Second records are erased where tiles were ``mirrored``. None of the tiles is busy or mirrored then.
    """
    width = int(scene.reals[layout.WIDTH])
    u = scene.reals
    row = start // TILE
    even = True
    for c in range(3):
        if u[layout.HAS_VISIBLE] != 0.0:
            even = even and u[layout.BELOW + c] == u[layout.SKY + 9 + c]
        else:
            even = even and u[layout.SKY + c] == u[layout.SKY + 3 + c] == u[layout.SKY + 6 + c]
    for tile in range(reached.shape[1]):
        if mirrored[row, tile] != 0:
            erase_tile(records, 1, start, stop, tile, width)
            mirrored[row, tile] = 0
        if reached[row, tile] != 0:
            busy[row, tile] = 0
            continue
        last = min((tile + 1) * TILE, width)
        if busy[row, tile] != 0:
            erase_tile(records[:1], 0, start, stop, tile, width)
            busy[row, tile] = 0
        r, g, b = backdrop(u, 0.0)
        for y in range(start, stop):
            for x in range(tile * TILE, last):
                if not even:
                    _, _, _, _, dy, _, _, _ = camera_ray(u, x + 0.5, y + 0.5)
                    r, g, b = backdrop(u, dy)
                k = y * width + x
                radiance[k, 0], radiance[k, 1], radiance[k, 2] = r, g, b


@part
def mark_of(records, visibility, k, lights):
    """What pixel k makes its tile: SHOWN where it has a record or a thin capsule before it, and LOSSY where its
    ``visibility`` tells besides that light of the sky is missing, or of one of so many ``lights``; else 0."""
    shown = records[0, k, OWNER] != 0.0 or records[0, k, UNSURE] != 0.0
    for layer in range(len(records)):
        if records[layer, k, OWNER] != 0.0:
            row = visibility[layer, k]
            if row[SKY] != 0.0 or row[SKY + 1] != 0.0 or row[SKY + 2] != 0.0:
                return LOSSY
            for l in range(lights):
                if row[FIRST_LIGHT + 2 * l] != 1.0:
                    return LOSSY
    return SHOWN if shown else 0


@part
def busiest(busy, row, first, last):
    """The largest mark of the tiles from ``first`` to ``last`` of a row and their neighbors."""
    most = 0
    for y in range(max(row - 1, 0), min(row + 1, busy.shape[0] - 1) + 1):
        for x in range(max(first - 1, 0), min(last + 1, busy.shape[1] - 1) + 1):
            most = max(most, int(busy[y, x]))
    return most


@kernel(types.void(MARKS, MARKS, MARKS), _nrt=False)
def choose(busy, laid, chunks):
    """What is to be done for chunks of ACROSS tiles, (rows of tiles, chunks): BLANK, WIPE or LAY; ``laid`` tells for
    which of them it was LAY the last time."""
    for row in range(chunks.shape[0]):
        for chunk in range(chunks.shape[1]):
            lay = busiest(busy, row, ACROSS * chunk, ACROSS * chunk + ACROSS - 1) != 0
            chunks[row, chunk] = LAY if lay else (WIPE if laid[row, chunk] != 0 else BLANK)
            laid[row, chunk] = 1 if lay else 0
